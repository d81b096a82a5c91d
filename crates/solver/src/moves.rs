//! How the α's of a step that is swept move: α = α_start + t d, t by the slope dg/dt.
//!
//! The direction d is taken once in a step, by [`crate::slopes`] or by [`crate::response`]; later moves use the slope observed.

use crate::sweep_task::{Rule, SweepTask};
use crate::sweeps::Sweeps;
use equip_scalar::Float;

/// Moves of the α's allowed in a step.
const MAX_MOVES: u32 = 24;

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
}

impl<T: Float> Moves<T> {
    pub(crate) fn new(rule: Rule) -> Self {
        Moves {
            by_response: rule == Rule::Response,
            slope: T::int(0),
            last: None,
            t: T::int(0),
            moves: 0,
        }
    }
}

impl<T: Float> Sweeps<T> {
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
            let moved = task.alphas[k] + base + alphas.t * d[k];
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
