//! [`Roughness`]: the effect of discontinuities within a step on its result.
//!
//! The polynomial u of a step has u' = Σ_{k<s} γ_k P_k, with γ_k from the quadrature rule of s nodes. J∇H(u)
//! along u has the coefficients γ̃_k. The residual J∇H(u) − u' causes an error of the end point: γ̃_0 − γ_0,
//! and a share of about ϱ^k of γ̃_k − γ_k if the coefficients decay by ϱ. For smooth motion this is of the
//! order 2s of the step. If a derivative of H jumps within the step, it is the error of the rule of s nodes
//! at the jump. The γ̃_k are computed by separate rules on both sides of the first root of a switch, and
//! between it and another root close behind: with 2s nodes on the longest piece, where there may be more
//! roots, and with s nodes on the others.
//!
//! Neighbouring roots without a stage between them, or an end of the step and a root, may enclose an obstacle
//! that neither the stages nor these rules see. J∇H(u) − u' is then evaluated at two positions between them.
//!
//! Cost: ∇H at 3s points, 4s with two roots, and at two more for each such pair.

use crate::control::estimate::Decay;
use crate::events::path::Path;
use equip_scalar::Float;
use equip_solver::{Core, MAX_STAGES};
use equip_tableau::{Coefficients, legendre_at};

/// The number of coefficients that are compared.
const COMPARED: usize = 3;

/// Workspace.
#[derive(Debug)]
pub(crate) struct Roughness<T: Float> {
    /// The rules of s and of 2s nodes.
    rules: [Coefficients<T>; 2],
    field: Vec<T>,
    /// P_k at a position.
    values: Vec<T>,
    /// h γ̃_k of component c at c·COMPARED + k.
    coefficients: Vec<T>,
}

impl<T: Float> Roughness<T> {
    /// For steps of this method and states with n components. `None` if there is no rule with 2s nodes.
    pub(crate) fn new(method: &Coefficients<T>, n: usize) -> Option<Self> {
        let fine = Coefficients::gauss((2 * method.stages()).min(MAX_STAGES)).ok()?;
        Some(Roughness {
            rules: [method.clone(), fine],
            field: vec![T::int(0); n],
            values: vec![T::int(0); method.stages()],
            coefficients: vec![T::int(0); n * COMPARED],
        })
    }

    /// The largest ϱ^k (γ̃_k − γ_k) for a step of size `h` along `path`, with discontinuities at two roots
    /// and ϱ = `rho`, relative to the admissible errors of `decay`. Differences within the `rounding` of ∇H
    /// do not count.
    pub(crate) fn of_step(
        &mut self,
        core: &mut Core<T>,
        path: &mut Path<T>,
        (h, [first, second]): (T, [T; 2]),
        (decay, rho, rounding): (&Decay<T>, f64, &[T]),
    ) -> f64 {
        self.coefficients.fill(T::int(0));
        let pieces = [
            (T::int(0), first),
            (first, second - first),
            (second, T::int(1) - second),
        ];
        let longest = pieces.iter().fold(T::int(0), |a, piece| a.max(piece.1));
        for (start, length) in pieces {
            if length > T::int(0) {
                let is_longest = length == longest;
                self.add(core, path, h, (usize::from(is_longest), start, length));
            }
        }
        let compared = path.stages().min(COMPARED);
        let mut most = 0.0_f64;
        for (c, sums) in self.coefficients.chunks_exact(COMPARED).enumerate() {
            let mut share = 1.0;
            for (k, &sum) in sums.iter().enumerate().take(compared) {
                let error = sum - path.coefficient(k, c);
                let defect = decay.in_tolerances(c, error, (h, rounding));
                most = most.max(share * defect);
                share *= rho.min(1.0);
            }
        }
        most
    }

    /// The largest effect of J∇H(u) − u' on a step of size `h` between neighbouring roots without a stage
    /// between them: its value at two positions times their distance, relative to the admissible errors of
    /// `decay`. There are two positions because the force vanishes in the middle of a smooth obstacle.
    pub(crate) fn between_pairs(
        &mut self,
        core: &mut Core<T>,
        path: &mut Path<T>,
        h: T,
        (decay, rounding): (&Decay<T>, &[T]),
    ) -> f64 {
        let mut most = 0.0_f64;
        for pair in 0..path.pairs.len() {
            let [first, second] = path.pairs[pair];
            core.counts_mut().gradients += 2;
            for place in [1, 4].map(|fifths| first + (second - first) * T::ratio(fifths, 5)) {
                let y = path.state_at(place);
                core.energy_mut().vector_field(y, &mut self.field);
                legendre_at(place, &mut self.values);
                for (c, &f) in self.field.iter().enumerate() {
                    let terms = self.values.iter().enumerate();
                    let known =
                        terms.fold(T::int(0), |sum, (k, &p)| sum + p * path.coefficient(k, c));
                    let length = second - first;
                    let error = length * (h * f - known);
                    let defect = decay.in_tolerances(c, error, (length * h, rounding));
                    most = if defect <= most { most } else { defect };
                }
            }
        }
        most
    }

    /// Adds ∫ h J∇H(u) P_k over `length` from `start`, by one of the rules.
    fn add(
        &mut self,
        core: &mut Core<T>,
        path: &mut Path<T>,
        h: T,
        (rule, start, length): (usize, T, T),
    ) {
        let rule = &self.rules[rule];
        core.counts_mut().gradients += rule.stages() as u64;
        for (&node, &weight) in rule.nodes().iter().zip(rule.weights()) {
            let place = start + length * node;
            let mut values = [T::int(0); COMPARED];
            legendre_at(place, &mut values);
            let y = path.state_at(place);
            core.energy_mut().vector_field(y, &mut self.field);
            let weight = weight * length * h;
            let coefficients = self.coefficients.chunks_exact_mut(COMPARED);
            for (sums, &f) in coefficients.zip(&self.field) {
                let rate = weight * f;
                for (sum, &value) in sums.iter_mut().zip(&values) {
                    *sum += value * rate;
                }
            }
        }
    }
}
