//! The local error of a Gauss step: how far Gauss with one stage more would have come from the same start.
//!
//! The stage polynomial of the s stages, at the nodes of s + 1, misses the stages of that method by what the truncation
//! of the first is worth. One correction of Newton's method finds them to second order, and
//!
//! $$ e = y_1^{(s+1)} - y_1^{(s)} $$
//!
//! is the local error of the step up to a relative O(h²).
//!
//! Cost: s + 1 gradients and Hessians; a factorisation of size (s + 1) n and one solve, or their simplified counterparts.

use crate::linearised::Linearised;
use crate::one_more::OneMore;
use crate::options::StageSolver;
use crate::outcome::Counts;
use crate::stages::Stages;
use crate::state::State;
use equip_autodiff::{Evaluate, Structure};
use equip_scalar::Float;
use nalgebra::DVector;

#[derive(Debug)]
pub(crate) struct LocalError<T: Float> {
    /// Of the method with one stage more.
    stages: Stages<T>,
    linearised: Linearised<T>,
    /// That of [`OneMore`].
    prolongation: Vec<T>,
    correction: DVector<T>,
    /// e, and −Ψ⁻¹e.
    error: Vec<T>,
    back: Vec<T>,
}

impl<T: Float> LocalError<T> {
    /// With one stage more than the steps have.
    pub(crate) fn new(finer: OneMore<T>, structure: &Structure, simplified: bool) -> Self {
        let (stages, n) = (finer.gauss.stages(), structure.hessian.dimension());
        let solver = if simplified {
            StageSolver::SimplifiedNewton
        } else {
            StageSolver::FullNewton
        };
        LocalError {
            prolongation: finer.prolongation,
            stages: Stages::new(finer.gauss, n),
            linearised: Linearised::new(stages, structure, solver, true),
            correction: DVector::zeros(stages * n),
            error: vec![T::int(0); n],
            back: vec![T::int(0); n],
        }
    }

    /// Estimates e of the step of size `h` from `y` whose `coarse` stages, with α = 0, are known up to a correction that
    /// moves their end point by `moved_end`: as a displacement of the end and as that of the start which amounts to the same.
    /// `None` if it cannot be had.
    pub(crate) fn estimate<E: Evaluate<T>>(
        &mut self,
        coarse: &Stages<T>,
        moved_end: &[T],
        energy: &mut E,
        (y, h): (&State<T>, T),
        counts: &mut Counts,
    ) -> Option<(&[T], &[T])> {
        let (s, n) = (coarse.count(), coarse.n);
        let rows = self.prolongation.chunks_exact(s);
        for (z, row) in self.stages.z.chunks_exact_mut(n).zip(rows) {
            z.fill(T::int(0));
            for (&x, l) in row.iter().zip(coarse.l.chunks_exact(n)) {
                z.iter_mut().zip(l).for_each(|(sum, &l)| *sum += x * l);
            }
        }
        self.stages.scale.copy_from_slice(&coarse.scale);
        let mut own = Counts::default();
        let found =
            self.stages.evaluate(energy, y, h, &mut own) && self.correct(energy, h, &mut own);
        counts.local_errors += 1;
        counts.gradients += own.gradients;
        counts.hessians += own.hessians;
        if !found {
            return None;
        }
        let x = &self.correction;
        (self.linearised).column_end(&self.stages, x, &mut self.error);
        let finer = self.stages.l.chunks_exact(n);
        finer.for_each(|l| add(&mut self.error, T::int(1), l));
        let coarse = coarse.l.chunks_exact(n);
        coarse.for_each(|l| add(&mut self.error, -T::int(1), l));
        add(&mut self.error, -T::int(1), moved_end);
        let finer = &mut self.linearised;
        let found = finer.column_start(&self.stages, &self.error, &mut self.back);
        let finite = self.error.iter().chain(&self.back).all(|e| e.is_finite());
        (found && finite).then_some((self.error.as_slice(), self.back.as_slice()))
    }

    /// The correction of the stages, from the stages alone: nothing is kept from earlier steps.
    fn correct<E: Evaluate<T>>(&mut self, energy: &mut E, h: T, counts: &mut Counts) -> bool {
        self.linearised.forget();
        for _ in 0..2 {
            self.linearised.begin(h, false);
            let refreshed = (h, T::INFINITY, false);
            if (self
                .linearised
                .refresh(&self.stages, energy, refreshed, counts))
            .is_err()
            {
                return false;
            }
            (self.linearised).prepare_columns(&self.stages, energy, (h, false), counts);
            self.stages.residual(self.correction.as_mut_slice());
            // To round-off: a component that hardly moves may be far off, relative to its size, and hide the others.
            let (noise, x) = (T::int(4) * T::EPSILON, &mut self.correction);
            if (self.linearised).solve_to(noise, &self.stages, x) {
                return true;
            }
            self.linearised.forget();
        }
        false
    }
}

fn add<T: Float>(y: &mut [T], a: T, x: &[T]) {
    y.iter_mut().zip(x).for_each(|(y, &x)| *y += a * x);
}
