//! The local error of the step with α = 0, from one linearised step of the method with two more stages:
//!
//! $$ e = \sum_j \tilde L_j - \sum_i L_i + \sum_i \delta L_i(X), \qquad X = K\,\delta L + R, \qquad
//!    R_i = \sum_j E_{ij} \tilde L_j - \sum_j K_{ij} L_j . $$
//!
//! L̃_j = h b̃_j J∇H(u(c̃_j)) is evaluated at the nodes c̃ of s + 2 stages along the collocation polynomial u
//! of the step, and E_ij = Σ_{k<s+2} (∫_0^{c_i} P_k) P_k(c̃_j). Thus R is the integral of the residual J∇H(u)
//! − u' up to c_i. X is the response of the stages to R, by the same linearised equations as D.
//!
//! The number of additional stages is even because the stability function of s stages tends to (−1)^s at
//! infinity. With an odd number, motion that the step does not resolve would count as an error of the slow
//! motion.
//!
//! Cost: s + 2 gradients, and linearised iterations for one right-hand side. No stage equation is solved.

use crate::alpha::direction::Direction;
use crate::outcome::outcome::Counts;
use crate::policy::FARTHEST;
use equip_autodiff::{Evaluator, turned};
use equip_iterate::{Held, Iterate, Preconditioner, State, stride_for};
use equip_scalar::{Float, mix_stages};
use equip_tableau::{Coefficients, legendre_integrals_at};

/// The number of additional stages.
const MORE: usize = 2;

/// The method with s + [`MORE`] stages, and workspace. All rows have the length for s + [`MORE`] stages.
#[derive(Debug)]
pub(crate) struct LocalError<T: Float> {
    finer: Coefficients<T>,
    stride: usize,
    /// The maps from L to u(c̃_j) − y0 and from L̃ to its integrals (E), and K(0): column by column.
    prolongation: Vec<T>,
    integration: Vec<T>,
    k: Vec<T>,
    /// L; the points u(c̃_j), later E L̃; ∇H at these points; L̃; K L.
    coarse: Vec<T>,
    points: Vec<T>,
    gradients: Vec<T>,
    fine: Vec<T>,
    mixed: Vec<T>,
    /// R and X, in the layout of the stages.
    r: Vec<T>,
    x: Vec<T>,
}

impl<T: Float> LocalError<T> {
    /// `None` if there is no method with s + 2 stages.
    pub(crate) fn new(method: &Coefficients<T>, iterate: &Iterate<T>) -> Option<Self> {
        let s = method.stages();
        if s + MORE > equip_iterate::MAX_STAGES {
            return None;
        }
        let finer = Coefficients::gauss(s + MORE).ok()?;
        let (n, stride) = (iterate.components(), stride_for::<T>(s + MORE));
        let zeros = |len: usize| vec![T::int(0); len];
        let rows = || zeros(n * stride);
        Some(LocalError {
            prolongation: integrals(finer.nodes(), method, stride),
            integration: integrals(method.nodes(), &finer, stride),
            k: integrals(method.nodes(), method, stride),
            finer,
            stride,
            coarse: rows(),
            points: rows(),
            gradients: rows(),
            fine: rows(),
            mixed: rows(),
            r: zeros(n * iterate.stride()),
            x: zeros(n * iterate.stride()),
        })
    }

    /// The largest component of e in each of the units of [`Direction::motion`], for a step of size `h` from
    /// `y` with these L at α = 0, component by component. `direction` must be linearised at this step. `None`
    /// if e is not finite.
    pub(crate) fn estimate(
        &mut self,
        energy: &mut Evaluator<T>,
        (y, h): (&State<T>, T),
        (iterate, l): (&Iterate<T>, &[T]),
        (direction, m): (&mut Direction<T>, Option<&mut (dyn Preconditioner<T> + '_)>),
        counts: &mut Counts,
    ) -> Option<[T; 2]> {
        let (n, s, stride) = (iterate.components(), iterate.stages(), self.stride);
        let (set, finer) = (iterate.instruction_set(), s + MORE);
        for (to, from) in rows(&mut self.coarse, stride).zip(l.chunks_exact(iterate.stride())) {
            to[..s].copy_from_slice(&from[..s]);
        }
        mix_stages(
            set,
            &self.prolongation,
            &self.coarse,
            &mut self.points,
            s,
            stride,
        );
        for ((row, &hi), &lo) in rows(&mut self.points, stride).zip(&y.hi).zip(&y.lo) {
            row.iter_mut().for_each(|x| *x = hi + (*x + lo));
        }
        energy.gradients_by_component(&self.points, &mut self.gradients, stride, finer);
        counts.gradients += finer as u64;
        for (c, gradient) in self.gradients.chunks_exact(stride).enumerate() {
            let (row, sign) = turned::<T>(c, n);
            let l = self.fine[row * stride..][..finer].iter_mut();
            for ((l, &b), &g) in l.zip(self.finer.weights()).zip(gradient) {
                *l = sign * (h * b) * g;
            }
        }
        mix_stages(
            set,
            &self.integration,
            &self.fine,
            &mut self.points,
            finer,
            stride,
        );
        mix_stages(set, &self.k, &self.coarse, &mut self.mixed, s, stride);
        let both = self
            .points
            .chunks_exact(stride)
            .zip(self.mixed.chunks_exact(stride));
        for (r, (fine, coarse)) in rows(&mut self.r, iterate.stride()).zip(both) {
            for (r, (&fine, &coarse)) in r[..s].iter_mut().zip(fine.iter().zip(coarse)) {
                *r = fine - coarse;
            }
        }
        let sides = (self.r.as_slice(), self.x.as_mut_slice());
        let to = (direction.weights.as_slice(), T::ratio(1, FARTHEST));
        if !direction.linear.solve(Held::Start, sides, to, iterate, m) {
            return None;
        }
        let sum = |l: &[T]| l.iter().fold(T::int(0), |sum, &l| sum + l);
        let both = self
            .fine
            .chunks_exact(stride)
            .zip(self.coarse.chunks_exact(stride));
        let sums = both.zip(direction.linear.sums());
        let errors = sums.map(|((fine, coarse), &response)| {
            (sum(&fine[..finer]) - sum(&coarse[..s]) + response).abs()
        });
        let largest = direction.in_units(errors);
        largest.iter().all(|x| x.is_finite()).then_some(largest)
    }
}

fn rows<T>(x: &mut [T], stride: usize) -> impl Iterator<Item = &mut [T]> {
    x.chunks_exact_mut(stride)
}

/// Σ_k (∫_0^c P_k) P_k(c_j) for c in `at` and the nodes c_j of `method`, column by column.
fn integrals<T: Float>(at: &[T], method: &Coefficients<T>, stride: usize) -> Vec<T> {
    let s = method.stages();
    let mut matrix = vec![T::int(0); stride * stride];
    let mut integrals = vec![T::int(0); s];
    for (i, &c) in at.iter().enumerate() {
        legendre_integrals_at(c, &mut integrals);
        for (k, &integral) in integrals.iter().enumerate() {
            for (j, &p) in method.legendre(k).iter().enumerate() {
                matrix[j * stride + i] += integral * p;
            }
        }
    }
    matrix
}
