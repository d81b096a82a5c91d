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
//! A tolerance may allow steps that fixed-point iteration takes long for: their contraction ρ, in the mean of
//! those of a step, goes like h (like h² where the positions alone are unknown), and so does what a step
//! costs, the more the larger it is. Such steps are made as long as costs least for the time they cover,
//!
//! $$ h^+ \le h \min\Big(1, \frac{1 - 1/z}{1 + \hat h/(hz)}\Big) \Big(\frac{\rho_0}{\rho}\Big)^{1/p}, $$
//!
//! unless the tolerance allows so much more that Newton's method, which minds no size, pays. They are more
//! accurate than was asked for then, for less. Nothing is remembered of earlier steps, so there is nothing to
//! hunt with. What was measured of both, and of other rules, is in `docs/adr/0005`.
//!
//! Sizes are f64 in every float type: a step is a choice, not a result, and a size of 53 bits is exact.

use crate::control::estimate::Estimate;
use crate::control::policy::{ACCEPTED, CHEAPEST, MOST_CHANGE, NEWTON, SAFETY};
use equip_scalar::power::power;

#[derive(Debug)]
pub(crate) struct Control {
    /// tol^{1/(2s)}, to be had by the ϱ of the estimate.
    wanted: f64,
    /// Ratio (tol / e)^{1/(2s)} down to which a step is accepted.
    accepted: f64,
    /// Largest step.
    pub(crate) most: f64,
    /// Size proposed for the next step: all that is remembered between steps.
    pub(crate) next: f64,
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
        let root = |x: f64| power(x, 1.0 / (2 * stages) as f64);
        Control {
            wanted: root(tolerance),
            accepted: root(1.0 / ACCEPTED),
            most,
            next: most,
        }
    }

    /// A run begins, with a step of the size `first` if that is allowed.
    pub(crate) fn begin(&mut self, first: f64) {
        self.next = first.min(self.most);
    }

    /// Judges a step of size `h` by its estimate, and if it is accepted proposes the next. `contraction` is
    /// that of its iterations, if there were any, as a power that goes like h. Iterations from the stages of
    /// a try that was refused do not contract as others do: after one the next step is not shortened for
    /// them.
    pub(crate) fn judge(
        &mut self,
        h: f64,
        estimate: &Estimate,
        (contraction, is_retried): (Option<f64>, bool),
    ) -> Judgement {
        let ratio = self.ratio(estimate);
        if !(ratio >= self.accepted) {
            return Judgement::Refuse(h * (SAFETY * ratio).max(1.0 / MOST_CHANGE));
        }
        let growth = ratio.min(MOST_CHANGE);
        let near = estimate.nearness;
        let predicted = (1.0 - near) / (1.0 + growth * near).max(f64::MIN_POSITIVE);
        let predicted = predicted.clamp(1.0 / MOST_CHANGE, MOST_CHANGE);
        let mut share = SAFETY * growth * predicted;
        let cheapest = Self::cheapest(ratio, contraction);
        let least = if is_retried { 1.0 } else { 0.0 };
        share = share.min((cheapest * predicted.min(1.0)).max(least));
        self.next = (h * share).min(self.most);
        Judgement::Accept
    }

    /// Whether a step with this estimate is longer than the tolerance allows.
    pub(crate) fn is_too_long(&self, estimate: &Estimate) -> bool {
        self.ratio(estimate) < 1.0
    }

    /// Whether a step that was accepted with an estimate of this `decay` gets the next size whatever it is.
    pub(crate) fn has_room(&self, decay: f64, contraction: f64) -> bool {
        let enough = (CHEAPEST / contraction / SAFETY).clamp(1.0, MOST_CHANGE);
        self.wanted >= decay * enough
    }

    /// The step that iterations cost least for, in units of the one that was made; infinite for Newton's
    /// method.
    fn cheapest(ratio: f64, contraction: Option<f64>) -> f64 {
        let cheapest = contraction.map_or(f64::INFINITY, |contraction| CHEAPEST / contraction);
        if ratio <= NEWTON * cheapest {
            cheapest
        } else {
            f64::INFINITY
        }
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
    pub(crate) fn first_is_timid(
        &self,
        h: f64,
        estimate: &Estimate,
        (contraction, longest): (Option<f64>, f64),
    ) -> Option<f64> {
        let ratio = self.ratio(estimate);
        let longer = (SAFETY * ratio).min(Self::cheapest(ratio, contraction));
        let longer = (h * longer.min(MOST_CHANGE)).min(self.most).min(longest);
        (longer > 2.0 * h).then_some(longer)
    }
}
