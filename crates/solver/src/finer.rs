//! The local error of a step whose stages sweeps have found: how far the method with one stage more comes from the same start,
//!
//! $$ e = y_1^{(s+1)} - y_1^{(s)} . $$
//!
//! In `f64` by sweeps from the polynomial of these stages, until they are there. In wide numbers by one linearised correction of that polynomial's stages, as
//! [`crate::local_error`] has it: it is up to a relative O(h²) only, but e and e' = −Ψ⁻¹e, of the same linear equations, are those of the step made backwards to
//! round-off, where e by itself would be to its square.
//!
//! Cost: about s/2 + 2 sweeps of s + 1 stages; or a sweep, ∇²H at the stages, and twice as many linear sweeps of one side as it takes to round-off.

use crate::ahead::Once;
use crate::linear_sweeps::{Held, LinearSweeps};
use crate::one_more::OneMore;
use crate::outcome::Counts;
use crate::ready::ready;
use crate::state::State;
use crate::sweep::Iterate;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;

/// Sweeps allowed to the local error.
const MAX_FINER: usize = 40;

/// The step with one stage more, for the local error.
#[derive(Debug)]
pub(crate) struct Finer<T: Float> {
    method: OneMore<T>,
    pub(crate) iterate: Iterate<T>,
    before: Vec<T>,
    /// In wide numbers, with a residual and what answers to it.
    linear: Option<(LinearSweeps<T>, [Vec<T>; 2])>,
    /// Evaluations of ∇H at one point, of the estimate made last.
    pub(crate) evaluations: u64,
}

impl<T: Float> Finer<T> {
    pub(crate) fn new(method: OneMore<T>, coarse: &Iterate<T>, pattern: &Pattern) -> Self {
        let (n, kinetic) = (coarse.n, coarse.kinetic.clone());
        let iterate = Iterate::unperturbed(&method.gauss, n, kinetic);
        let linear = (!T::IS_DOUBLE).then(|| {
            let room = [(); 2].map(|()| vec![T::int(0); n * iterate.stride]);
            let pattern = pattern.clone();
            (LinearSweeps::new(&method.gauss, &iterate, pattern, 1), room)
        });
        Finer {
            iterate,
            linear,
            method,
            before: vec![T::int(0); n],
            evaluations: 0,
        }
    }

    /// Z of the polynomial through the coarse stages.
    fn prolong(&mut self, coarse: &Iterate<T>, (y, h): (&State<T>, T)) {
        let (s, stride) = (coarse.s, coarse.stride);
        let (own, rows) = (self.iterate.stride, &self.method.prolongation);
        if let Some(own) = &mut self.iterate.springs {
            own.is_active = false;
        }
        (ready::<T>().begin_from_nothing)(&mut self.iterate, &self.method.gauss, (y, h));
        self.iterate.displace(y, |c, z| {
            let l = &coarse.l[c * stride..][..s];
            for (z, row) in z[..own].iter_mut().zip(rows.chunks_exact(s)) {
                *z = row
                    .iter()
                    .zip(l)
                    .fold(T::int(0), |sum, (&e, &l)| sum + e * l);
            }
        });
    }

    /// e and e' by one linearised correction of the prolonged stages, up to a relative O(h²): from the end of the step the same, to round-off. Returns
    /// whether they were found.
    pub(crate) fn estimate_both<E: Evaluate<T>>(
        &mut self,
        coarse: &Iterate<T>,
        energy: &mut E,
        (y, h): (&State<T>, T),
        weights: &[T],
        [end, start]: [&mut Vec<T>; 2],
        counts: &mut Counts,
    ) -> bool {
        self.prolong(coarse, (y, h));
        let (iterate, Some((linear, [r, x]))) = (&mut self.iterate, &mut self.linear) else {
            return false;
        };
        if !linear.take(iterate, energy, false, counts) {
            return false;
        }
        let stride = iterate.stride;
        let len = iterate.unknowns() * stride;
        r.fill(T::int(0));
        r[..len].copy_from_slice(&iterate.z[..len]);
        let change = iterate.sweep(energy, y, false, &mut Once);
        counts.gradients += iterate.s as u64;
        if !change.is_finite() {
            return false;
        }
        for (r, &z) in r[..len].iter_mut().zip(&*iterate.z) {
            *r = z - *r;
        }
        let tolerance = T::int(16) * T::EPSILON;
        if !linear.solve(Held::Start, (r, x), weights, tolerance, iterate) {
            return false;
        }
        let sum = |l: &[T]| l.iter().fold(T::int(0), |sum, &l| sum + l);
        for (c, e) in end.iter_mut().enumerate() {
            let finer = sum(&iterate.l[c * stride..][..iterate.s]) + linear.sums[c];
            *e = finer - sum(&coarse.l[c * coarse.stride..][..coarse.s]);
        }
        for (r, &e) in r.chunks_exact_mut(stride).zip(&*end) {
            r.fill(e);
        }
        if !linear.solve(Held::End, (r, x), weights, tolerance, iterate) {
            return false;
        }
        for (c, (start, &e)) in start.iter_mut().zip(&*end).enumerate() {
            *start = linear.sums[c] - e;
        }
        true
    }

    /// e into `error`, to round-off of the state. Returns whether it was found.
    pub(crate) fn estimate<E: Evaluate<T>>(
        &mut self,
        coarse: &Iterate<T>,
        energy: &mut E,
        (y, h): (&State<T>, T),
        weights: &[T],
        error: &mut [T],
    ) -> bool {
        let (s, stride, own) = (coarse.s, coarse.stride, self.iterate.stride);
        self.evaluations = 0;
        self.prolong(coarse, (y, h));
        for made in 0..MAX_FINER {
            // The first sweep makes an L that Z was made with.
            if let (Some(own), Some(springs)) = (&mut self.iterate.springs, coarse.active_springs())
                && made > 0
            {
                own.activate_as(&self.method.gauss, springs);
            }
            let change = self.iterate.sweep(energy, y, false, &mut Once);
            self.evaluations += (s + 1) as u64;
            if !change.is_finite() {
                return false;
            }
            self.before.copy_from_slice(error);
            let (mut moved, mut size) = (T::int(0), T::int(0));
            for (c, e) in error.iter_mut().enumerate() {
                let sum = |l: &[T]| l.iter().fold(T::int(0), |sum, &l| sum + l);
                *e = sum(&self.iterate.l[c * own..][..s + 1]) - sum(&coarse.l[c * stride..][..s]);
                moved += ((*e - self.before[c]) * weights[c]).abs();
                size += (*e * weights[c]).abs();
            }
            let noise = T::int(4) * T::EPSILON;
            if made > 0 && moved <= noise.max(T::int(1 << 14) * T::EPSILON * size) {
                return true;
            }
        }
        false
    }
}
