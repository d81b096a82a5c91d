//! Dense output: what a step passed through.
//!
//! *The stage polynomial.* u(τ) = y0 + Σ_{k<s} h γ_k ∫₀^τ P_k, which the stages define for free, has order s only: one
//! needs 2s coefficients where the end point needs the first.
//!
//! *The refined polynomial*, which is what users get: the stage polynomial of the Gauss method with min(2s, 32) stages on the same step, solved from the
//! stage polynomial as guess by a workspace of its own, with the linear term changed so that it ends in y1. Its error is that
//! of the step, order 2s, throughout the step (local error h^{2s+1}); the steps do not know of it.
//!
//! Cost: one solve of 2s stages without α per refined step; s n multiplications per value.

use crate::error::IntegrateError;
use crate::options::{Settings, StageSolver};
use crate::stages::Stages;
use crate::state::State;
use crate::step::Core;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_tableau::{Gauss, legendre_at, legendre_integrals_at};

/// What a step, or a part of a halved step, leaves for dense output.
#[derive(Debug, Clone)]
pub(crate) struct Part<T> {
    pub(crate) start: State<T>,
    pub(crate) time: T,
    pub(crate) h: T,
    /// L_i.
    pub(crate) l: Vec<T>,
    pub(crate) alphas: Vec<T>,
}

/// The parts of the step made last, in the order of time. Buffers are reused.
#[derive(Debug)]
pub(crate) struct Parts<T> {
    pub(crate) wanted: bool,
    parts: Vec<Part<T>>,
    count: usize,
}

impl<T: Float> Parts<T> {
    pub(crate) fn new() -> Self {
        Parts {
            wanted: false,
            parts: Vec::new(),
            count: 0,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    pub(crate) fn add(&mut self, start: &State<T>, time: T, h: T, stages: &Stages<T>) {
        if !self.wanted {
            return;
        }
        if self.count == self.parts.len() {
            let (l, alphas) = (stages.l.clone(), stages.alphas.clone());
            let start = start.clone();
            self.parts.push(Part {
                start,
                time,
                h,
                l,
                alphas,
            });
        } else {
            let part = &mut self.parts[self.count];
            part.start.copy_from(start);
            part.l.copy_from_slice(&stages.l);
            part.alphas.copy_from_slice(&stages.alphas);
            (part.time, part.h) = (time, h);
        }
        self.count += 1;
    }

    pub(crate) fn all(&self) -> &[Part<T>] {
        &self.parts[..self.count]
    }
}

/// The refined polynomial of one step (or part of a halved one).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece<T> {
    pub(crate) time: T,
    pub(crate) time_low: T,
    pub(crate) h: T,
    start: State<T>,
    /// y1, which the polynomial meets but for rounding.
    end: Vec<T>,
    /// h γ_k, k < M, one after the other.
    coefficients: Vec<T>,
}

impl<T: Float> Piece<T> {
    /// Where in the piece time `t` is: 0 at its start, 1 at its end.
    pub(crate) fn place_of(&self, t: T) -> T {
        let place = ((t - self.time) - self.time_low) / self.h;
        place.max(T::int(0)).min(T::int(1))
    }

    /// The time at `place`.
    pub(crate) fn time_at(&self, place: T) -> T {
        self.time + (self.time_low + place * self.h)
    }

    /// u at `place` into `y`.
    pub(crate) fn state_at(&self, place: T, y: &mut [T]) {
        if place == T::int(1) {
            y.copy_from_slice(&self.end);
            return;
        }
        let n = y.len();
        let mut integrals = [T::int(0); crate::MAX_STAGES];
        let integrals = &mut integrals[..self.coefficients.len() / n];
        legendre_integrals_at(place, integrals);
        for (j, y) in y.iter_mut().enumerate() {
            let terms = self.coefficients[j..].iter().step_by(n);
            // From the smallest to the largest.
            let sum = terms.zip(&*integrals).rev();
            let sum = sum.fold(self.start.lo[j], |sum, (&g, &i)| sum + g * i);
            *y = self.start.hi[j] + sum;
        }
    }
}

/// Makes refined polynomials.
#[derive(Debug)]
pub(crate) struct Refiner<T: Float, E> {
    core: Core<T, E>,
    /// M × s: from the L of the step to those of the guess.
    prolongation: Vec<T>,
    guess: Vec<T>,
    end: State<T>,
}

impl<T: Float, E: Evaluate<T>> Refiner<T, E> {
    pub(crate) fn new<H: System<Evaluator<T> = E>>(
        system: &H,
        gauss: &Gauss<T>,
        max_iterations: u32,
        stage_solver: StageSolver,
    ) -> Result<Self, IntegrateError<T>> {
        let (s, n) = (gauss.stages(), 2 * system.degrees_of_freedom());
        let fine = (2 * s).min(crate::MAX_STAGES);
        let rule = Gauss::<T>::new(fine).map_err(|_| IntegrateError::StagesOutOfRange {
            stages: fine,
            min: 1,
            max: crate::MAX_STAGES,
        })?;
        let mut prolongation = Vec::with_capacity(fine * s);
        let mut values = vec![T::int(0); s];
        for (&c, &b) in rule.nodes().iter().zip(rule.weights()) {
            legendre_at(c, &mut values);
            prolongation.extend((0..s).map(|i| {
                b * (0..s).fold(T::int(0), |sum, k| sum + values[k] * gauss.legendre(k)[i])
            }));
        }
        let settings = Settings::plain(fine, max_iterations, stage_solver);
        let zero = State::new(&vec![T::int(0); n], &[]);
        Ok(Refiner {
            core: Core::new(system, system.evaluator::<T>(), settings, rule, Vec::new()),
            prolongation,
            guess: vec![T::int(0); fine * n],
            end: zero,
        })
    }

    /// The refined polynomial of `part`, which ends in `end`.
    pub(crate) fn refine(
        &mut self,
        part: &Part<T>,
        time_low: T,
        end: &State<T>,
    ) -> Result<Piece<T>, IntegrateError<T>> {
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
        core.forget();
        core.guess.remember(&self.guess, part.h);
        core.guess.refuse();
        core.step(&part.start, part.time, part.h, &mut self.end)?;
        core.fetch_l();
        let fine = core.stages.count();
        let mut coefficients = vec![T::int(0); fine * n];
        for (k, out) in coefficients.chunks_exact_mut(n).enumerate() {
            if k == 0 {
                for (j, out) in out.iter_mut().enumerate() {
                    *out = (end.hi[j] - part.start.hi[j]) + (end.lo[j] - part.start.lo[j]);
                }
                continue;
            }
            let values = core.stages.gauss.legendre(k).iter();
            for (&p, l) in values.zip(core.stages.l.chunks_exact(n)) {
                out.iter_mut().zip(l).for_each(|(sum, &l)| *sum += p * l);
            }
        }
        Ok(Piece {
            time: part.time,
            time_low,
            h: part.h,
            start: part.start.clone(),
            end: end.hi.clone(),
            coefficients,
        })
    }
}
