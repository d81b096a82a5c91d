//! Step control: the size of the next step.
//!
//! A step of size h has the error estimate e, which is proportional to h^{2s}. The size that would have met
//! the tolerance is
//!
//! $$ \hat h = h\,(\mathrm{tol} / e)^{1/(2s)} . $$
//!
//! If a singularity at distance d from the middle of the step limits the motion, step sizes are proportional
//! to that distance. The middle of the next step h⁺ is (h + h⁺)/2 further, so h⁺/ĥ = (d − (h + h⁺)/2)/d. With
//! h/(2d) = 1/z, which follows from the coefficients of the step ([`crate::control::estimate`]), this gives
//!
//! $$ h^+ = \hat h\, \frac{1 - 1/z}{1 + \hat h / (h z)} . $$
//!
//! A tolerance may allow steps for which the fixed-point iteration converges slowly. The mean contraction ρ
//! of a step is proportional to h (to h² if the positions alone are unknown), and the work of a step grows
//! faster than its size. Such steps have the size with the least work per unit of time,
//!
//! $$ h^+ \le h \min\Big(1, \frac{1 - 1/z}{1 + \hat h/(hz)}\Big) \Big(\frac{\rho_0}{\rho}\Big)^{1/p}, $$
//!
//! unless the tolerance allows steps so much longer that Newton's method, whose convergence does not depend
//! on the size, needs less work. These steps are more accurate than requested, at less cost. The controller
//! has no memory of earlier steps that could make the sizes oscillate. `docs/adr/0005` compares both rules
//! with others.
//!
//! Sizes are `f64` in every float type: a step size is a choice, not a result, and a size of 53 bits is
//! exact.

use crate::control::estimate::Estimate;
use crate::control::policy::{ACCEPTED, CHEAPEST, MOST_CHANGE, NEWTON, SAFETY};
use equip_scalar::power::power;

#[derive(Debug)]
pub(crate) struct Control {
    /// tol^{1/(2s)}, the bound on ϱ of the estimate.
    wanted: f64,
    /// The smallest ratio (tol / e)^{1/(2s)} with which a step is accepted.
    accepted: f64,
    /// The largest step.
    pub(crate) most: f64,
    /// The size proposed for the next step: the only state between steps.
    pub(crate) next: f64,
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

    /// Begins a run with a step of size `first`, or of the largest allowed size.
    pub(crate) fn begin(&mut self, first: f64) {
        self.next = first.min(self.most);
    }

    /// Accepts or rejects a step of size `h` by its estimate. If it is accepted, proposes the next size;
    /// otherwise returns the size to try instead.
    /// `contraction` is the contraction of its iterations, if there were any, scaled to be proportional to h.
    /// If the initial guess came from a rejected attempt (`is_retried`), the contraction is not typical, and
    /// does not shorten the next step.
    pub(crate) fn judge(
        &mut self,
        h: f64,
        estimate: &Estimate,
        (contraction, is_retried): (Option<f64>, bool),
    ) -> Option<f64> {
        let ratio = self.ratio(estimate);
        if !(ratio >= self.accepted) {
            return Some(h * (SAFETY * ratio).max(1.0 / MOST_CHANGE));
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
        None
    }

    /// Whether the estimate of a step exceeds the tolerance.
    pub(crate) fn is_too_long(&self, estimate: &Estimate) -> bool {
        self.ratio(estimate) < 1.0
    }

    /// Whether an accepted step with an estimate of this `decay` leaves so much room that the contraction
    /// alone limits the next size.
    pub(crate) fn has_room(&self, decay: f64, contraction: f64) -> bool {
        let enough = (CHEAPEST / contraction / SAFETY).clamp(1.0, MOST_CHANGE);
        self.wanted >= decay * enough
    }

    /// The size with the least work per unit of time, relative to the size of the last step; infinite if
    /// Newton's method needs less work.
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

    /// A longer size for the first step, at most `longest`, if it is more than twice the present size `h`.
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
