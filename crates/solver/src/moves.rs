//! How the α's of a step that is swept move: α = α_start + t d, t by the slope dg/dt.
//!
//! The direction d is taken once in a step, by [`crate::slopes`] or by [`crate::response`]; later moves use the slope observed. Of steps that are to
//! return it is taken again at the solution, until that stays where it is: the step made backwards has the same.

use crate::constraint::Constraint;
use crate::outcome::Counts;
use crate::ready::ready;
use crate::sweep_task::{Rule, SweepTask, Trouble};
use crate::sweeps::Sweeps;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// Moves of the α's allowed in a step.
const MAX_MOVES: u32 = 24;

/// Directions that are taken again, at most: each leaves of the last move a share that goes with the local error, mostly 1e-3 and less.
const MAX_REPEATS: u32 = 16;
/// What is more than 1 over this of the move before would not be rounding after as many.
const CONTRACTS: i64 = 8;
/// Moves of the end point, in ε of the state, that may be rounding.
const ROUNDING: i64 = 64;

/// Progress of the α's in a step.
pub(crate) struct Moves<T> {
    /// By the response, or by slopes.
    pub(crate) by_response: bool,
    t: T,
    /// dg/dt.
    slope: T,
    /// t, g and the uncertainty of g before the last move.
    last: Option<(T, T, T)>,
    pub(crate) moves: u32,
    /// How often the directions were taken again, and how far the last have moved the end point.
    pub(crate) repeats: u32,
    moved: T,
}

impl<T: Float> Moves<T> {
    pub(crate) fn new(rule: Rule) -> Self {
        Moves {
            by_response: rule == Rule::Response,
            slope: T::int(0),
            last: None,
            t: T::int(0),
            moves: 0,
            repeats: 0,
            moved: T::INFINITY,
        }
    }
}

impl<T: Float> Sweeps<T> {
    /// Takes the directions again at the solution that they have led to, and moves the α's by what that changes. Returns whether it is more than rounding, and
    /// the step is to be swept on.
    pub(crate) fn repeat_directions<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        constraint: &Constraint<T>,
        alphas: &mut Moves<T>,
        task: &SweepTask<'_, T>,
        counts: &mut Counts,
    ) -> Result<bool, Trouble> {
        let Some(response) = self.response.as_mut().filter(|_| alphas.by_response) else {
            return Ok(false);
        };
        (ready::<T>().keep_momenta)(&mut self.iterate, task.y);
        let (at, step) = (
            (&self.iterate, &*self.alphas, task.alphas),
            (task.y, task.h),
        );
        if !response.take_again(at, energy, step, constraint, counts) {
            return Err(Trouble::StagesOnly);
        }
        let (g, eps) = (constraint.defect, T::EPSILON);
        let moved = response.still_moves(g);
        let contracts = T::int(CONTRACTS) * moved <= alphas.moved && alphas.repeats < MAX_REPEATS;
        (alphas.moved, alphas.repeats) = (moved, alphas.repeats + 1);
        if moved <= T::int(2) * eps || (!contracts && moved <= T::int(ROUNDING) * eps) {
            return Ok(false);
        }
        if !contracts {
            return Err(Trouble::StagesOnly);
        }
        (alphas.t, alphas.last, alphas.moves) = (T::int(0), None, 1);
        self.origin.copy_from_slice(&self.alphas);
        if !self.move_alphas((g, constraint.floor), alphas, task) {
            return Err(Trouble::NoAlpha);
        }
        self.contraction.disturb();
        Ok(true)
    }

    /// Moves the α's to where g vanishes by the slope known. Returns whether they stay within their bound.
    pub(crate) fn move_alphas(
        &mut self,
        (g, noise): (T, T),
        alphas: &mut Moves<T>,
        task: &SweepTask<'_, T>,
    ) -> bool {
        if alphas.moves == MAX_MOVES {
            return false;
        }
        let by_response = self.response.as_ref().filter(|_| alphas.by_response);
        let start = alphas.t;
        let mut by_base = T::int(0);
        match alphas.last {
            None => match by_response {
                Some(response) => {
                    alphas.slope = response.slope;
                    by_base = response.by_base;
                }
                None if task.rule == Rule::Response || self.slopes.take(&self.iterate, task.h) => {
                    alphas.slope = self.slopes.slope();
                }
                None => return false,
            },
            Some((t, g_last, noise_last)) => {
                let ratio = (g - g_last) / (alphas.t - t) / alphas.slope;
                let margin = if by_response.is_some() { 2 } else { 8 };
                let clear = (g - g_last).abs() > T::int(margin) * (noise + noise_last);
                if clear && ratio > T::ratio(1, 4) && ratio < T::int(4) {
                    alphas.slope *= ratio;
                }
            }
        }
        // What α⁰ has done to g is no response to t.
        alphas.last = Some((alphas.t, g + by_base, noise));
        alphas.t -= (g + by_base) / alphas.slope;
        alphas.moves += 1;
        let d = by_response.map_or(&self.slopes.d, |response| &response.d);
        for (k, alpha) in self.alphas.iter_mut().enumerate() {
            let base = by_response.map_or(T::int(0), |response| response.base[k]);
            if d[k] == T::int(0) && base == T::int(0) {
                self.delta[k] = T::int(0);
                continue;
            }
            let moved = self.origin[k] + base + alphas.t * d[k];
            self.delta[k] = moved - *alpha;
            *alpha = moved;
        }
        let bound = task.alpha_bound;
        if !(alphas.t.is_finite() && self.alphas.iter().all(|a| a.abs() <= bound)) {
            return false;
        }
        self.iterate.set_alphas(&self.alphas);
        match by_response {
            Some(response) => response.follow(&mut self.iterate, task.y, &self.delta),
            None if start == T::int(0) => self.iterate.mix_anew(task.y),
            None => (self.iterate).extrapolate(task.y, (alphas.t - start) / start),
        }
        true
    }
}
