//! Step control: which size the next step gets.
//!
//! From a step of size h with error estimate e, which goes like h^{2s}, the size that would have met the
//! tolerance there is
//!
//! $$ \hat h = h\,(\mathrm{tol} / e)^{1/(2s)} . $$
//!
//! Where the motion is limited by a singularity at distance d from the middle of the step, sizes are
//! proportional to that distance: the next step h⁺, whose middle is (h + h⁺)/2 further on, should have h⁺/ĥ =
//! (d − (h + h⁺)/2)/d. With h/(2d) = 1/z, which the coefficients of the step tell
//! ([`crate::control::estimate`]), that is
//!
//! $$ h^+ = \hat h\, \frac{1 - 1/z}{1 + \hat h / (h z)} . $$
//!
//! A tolerance may allow steps that sweeps take long for: their contraction ρ goes like h (like h² where the
//! positions alone are unknown), and so does what a step costs, the more the larger it is. Such steps are
//! made as long as costs least for the time they cover,
//!
//! $$ h^+ \le h \min\Big(1, \frac{1 - 1/z}{1 + \hat h/(hz)}\Big) \Big(\frac{\rho_0}{\rho}\Big)^{1/p}, $$
//!
//! unless the tolerance allows so much more that Newton's method, which minds no size, pays. They are more
//! accurate than was asked for then, for less. Nothing is remembered of earlier steps, so there is nothing to
//! hunt with. What was measured of both, and of other rules, is in `docs/adr/0005`.
//!
//! Sizes are f64 in every float type: a step is a choice, not a result, and a size of 53 bits is exact.

use crate::control::estimate::Estimate;

/// Aim below the tolerance. // ratio; with 0.95 errors of a revolution (Kepler, 18 settings) go up to 7.1
/// tolerances from 5.4.
const SAFETY: f64 = 0.9;
/// Estimates up to this many tolerances are accepted: the size is within 19 % (s = 4), 9 % (s = 8) of what it
/// should be. // ratio; with 10 80 of 2480 steps are refused in place of 118 (Kepler, e = 0.9, s = 8, 1e-12),
/// and the error after 100 revolutions is 1.2e-11 in place of 3.8e-12.
const ACCEPTED: f64 = 4.0;
/// Bound of the ratio h⁺/ĥ, …
const MOST_PREDICTED: f64 = 2.0;
/// … of ĥ/h, …
const MOST_GROWTH: f64 = 4.0;
/// … and of how much a refused step is shortened.
const MOST_SHRINKAGE: f64 = 0.1;
/// Contraction, per power of the step size, at which sweeps cost least for the time they cover. Twice the
/// size takes three times the sweeps: the start is foretold worse, and the α's that remove a larger defect
/// disturb the stages more.
const BEST: f64 = 0.058;
/// A tolerance that allows steps this many times as long as sweeps are made for asks for Newton's method.
const NEWTON: f64 = 32.0;
/// What control remembers between steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Memory {
    /// Size proposed for the next step.
    pub(crate) next: f64,
}

#[derive(Debug)]
pub(crate) struct Control {
    /// tol^{1/(2s)}, to be had by the ϱ of the estimate.
    wanted: f64,
    /// Ratio (tol / e)^{1/(2s)} down to which a step is accepted.
    accepted: f64,
    /// Largest step.
    pub(crate) most: f64,
    pub(crate) memory: Memory,
}

/// What to do with a step that was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Judgement {
    Accept,
    /// Try again with this size.
    Refuse(f64),
}

impl Control {
    pub(crate) fn new(tolerance: f64, stages: usize, most: f64) -> Self {
        let root = |x: f64| x.powf(1.0 / (2 * stages) as f64);
        Control {
            wanted: root(tolerance),
            accepted: root(1.0 / ACCEPTED),
            most,
            memory: Memory { next: most },
        }
    }

    /// A run begins, with a step of the size `first` if that is allowed.
    pub(crate) fn begin(&mut self, first: f64) {
        self.memory = Memory {
            next: first.min(self.most),
        };
    }

    /// Judges a step of size `h` by its estimate, and if it is accepted proposes the next. `contraction` is
    /// that of its sweeps, if there were any, as a power that goes like h.
    pub(crate) fn judge(
        &mut self,
        h: f64,
        estimate: &Estimate,
        contraction: Option<f64>,
    ) -> Judgement {
        let ratio = self.ratio(estimate);
        if !(ratio >= self.accepted) {
            return Judgement::Refuse(h * (SAFETY * ratio).max(MOST_SHRINKAGE));
        }
        let growth = ratio.min(MOST_GROWTH);
        let near = estimate.nearness;
        let predicted = (1.0 - near) / (1.0 + growth * near).max(f64::MIN_POSITIVE);
        let predicted = predicted.clamp(1.0 / MOST_PREDICTED, MOST_PREDICTED);
        let mut share = SAFETY * growth * predicted;
        let cheapest = contraction.map_or(f64::INFINITY, |contraction| BEST / contraction);
        if ratio <= NEWTON * cheapest {
            share = share.min(cheapest * predicted.min(1.0));
        }
        self.memory.next = (h * share).min(self.most);
        Judgement::Accept
    }

    /// (tol / e)^{1/(2s)}.
    fn ratio(&self, estimate: &Estimate) -> f64 {
        self.wanted / estimate.decay
    }

    /// After a step of size `h` that could not be solved: the size to try.
    pub(crate) fn shorter(&self, h: f64) -> f64 {
        h / 2.0
    }

    /// Whether the first step is so much smaller than it could be, up to `longest`, that it is worth another
    /// try; with which size.
    pub(crate) fn first_is_timid(&self, h: f64, estimate: &Estimate, longest: f64) -> Option<f64> {
        let longer = SAFETY * self.ratio(estimate);
        let longer = (h * longer.min(1.0 / MOST_SHRINKAGE))
            .min(self.most)
            .min(longest);
        (longer > 2.0 * h).then_some(longer)
    }
}
