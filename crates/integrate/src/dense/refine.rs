//! Dense output: polynomials over a step.
//!
//! *The stage polynomial.* The stages define u(τ) = y0 + Σ_{k<s} h γ_k ∫₀^τ P_k at no cost. Its order is s
//! only: between the ends 2s coefficients are needed for order 2s.
//!
//! *The refined polynomial* is the stage polynomial of the Gauss method with min(2s, 32) stages on the same
//! step. Its stages are solved in a separate workspace with the stage polynomial as initial guess. Its linear
//! term is then changed such that it ends at y1. Its error is that of the step, of order 2s throughout the
//! step (local error h^{2s+1}). It does not affect the steps.
//!
//! The step has already been accepted, and dense output never ends a run. If the stages of the refined
//! polynomial do not converge, the stage polynomial replaces it, with its linear term changed in the same
//! way. The certificate counts these steps.
//!
//! Cost: one solve of 2s stages without α per refined step, and s n multiplications per value.

use crate::dense::piece::Piece;
use crate::error::IntegrateError;
use crate::options::common::coefficients;
use crate::options::method::Gauss;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Core, Family, MAX_STAGES, Part, State, StepOptions};
use equip_tableau::{Coefficients, legendre_at};

/// Computes refined polynomials.
#[derive(Debug)]
pub(crate) struct Refiner<T: Float> {
    core: Core<T>,
    /// M × s: the map from L of the step to the initial guess for M stages.
    prolongation: Vec<T>,
    guess: Vec<T>,
    end: State<T>,
}

impl<T: Float> Refiner<T> {
    pub(crate) fn new(
        system: &Hamiltonian,
        method: &Coefficients<T>,
    ) -> Result<Self, IntegrateError<T>> {
        let (s, n) = (method.stages(), 2 * system.degrees_of_freedom());
        let degree = method.degree();
        let fine = (2 * degree).min(MAX_STAGES);
        let rule = coefficients::<T>(Gauss::stages(fine))?;
        let mut prolongation = Vec::with_capacity(fine * s);
        let mut values = vec![T::int(0); degree];
        for (&c, &b) in rule.nodes().iter().zip(rule.weights()) {
            legendre_at(c, &mut values);
            prolongation.extend((0..s).map(|i| {
                b * (0..degree).fold(T::int(0), |sum, k| sum + values[k] * method.legendre(k)[i])
            }));
        }
        let options = StepOptions {
            max_halvings: 0,
            ..StepOptions::new(fine, Family::Gauss)
        };
        let zero = State::new(&vec![T::int(0); n], &[]);
        Ok(Refiner {
            core: Core::new(system, system.evaluator::<T>(), options, rule, Vec::new()),
            prolongation,
            guess: vec![T::int(0); fine * n],
            end: zero,
        })
    }

    /// The refined polynomial of `part`, a part of a step that ends at `end`, or the stage polynomial if the
    /// refined stages do not converge. Returns whether it is refined.
    pub(crate) fn refine(
        &mut self,
        (method, part): (&Coefficients<T>, &Part<T>),
        time_low: T,
        end: &State<T>,
    ) -> (Piece<T>, bool) {
        let n = part.start.hi.len();
        let s = part.l.len() / n;
        let rows = self.prolongation.chunks_exact(s);
        for (row, out) in rows.zip(self.guess.chunks_exact_mut(n)) {
            out.fill(T::int(0));
            for (&e, l) in row.iter().zip(part.l.chunks_exact(n)) {
                out.iter_mut().zip(l).for_each(|(sum, &l)| *sum += e * l);
            }
        }
        let core = &mut self.core;
        core.guess_from(&self.guess, part.h);
        let found = core.step(&part.start, part.time, part.h, &mut self.end);
        if found.is_err() {
            return (Piece::of_stages(method, part, time_low, end), false);
        }
        let fine = core.method().stages();
        let mut coefficients = vec![T::int(0); fine * n];
        core.legendre_coefficients(&mut coefficients);
        (Piece::new(part, time_low, coefficients, end), true)
    }
}
