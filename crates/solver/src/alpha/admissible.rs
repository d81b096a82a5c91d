//! How far the parameters α may change y1.
//!
//! *Admissible* (docs/adr/0013). A change of y1 caused by α is admissible up to [`FARTHEST`]
//! times the larger of the local error of the step and the change that the step's own energy error is
//! equivalent to, *plus the largest bound of the uncorrected steps just before*, which fades by 1/[`FADING`]
//! a step: the error that such steps have left may be removed by a later one (docs/adr/0026). If there are
//! no more parameters than constraints, corrected steps hand on their bound as well: the constraints are what
//! such a method is chosen for.
//!
//! Each component counts in units of its change over the step, and so does the component of its group
//! (positions, momenta) that changes most. At most 1/[`SMALL`] of these units.

use crate::policy::{FADING, FARTHEST, SMALL};
use equip_scalar::Float;

/// Bounds on the change of y1, in both units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds<T> {
    /// The change that removes the energy error, at least.
    pub(crate) needed: [T; 2],
    /// The bound of this step.
    own: [T; 2],
    /// The bound that earlier steps hand on.
    handed_on: [T; 2],
    /// Every α is admissible.
    is_free: bool,
    /// The local error has been estimated, or is not needed.
    pub(crate) has_error: bool,
}

impl<T: Float> Bounds<T> {
    /// Of a step whose constraints need a change of `needed`, of which its own errors are `own`.
    pub(crate) fn new(needed: [T; 2], own: [T; 2], handed_on: [T; 2], is_free: bool) -> Self {
        Bounds {
            needed,
            own: own.map(|own| T::int(FARTHEST) * own),
            handed_on,
            is_free,
            has_error: is_free,
        }
    }

    /// The local error of the step is this.
    pub(crate) fn extend(&mut self, error: [T; 2]) {
        for (own, error) in self.own.iter_mut().zip(error) {
            *own = own.max(T::int(FARTHEST) * error);
        }
    }

    /// Whether a change is small compared with that over the step.
    pub(crate) fn is_small(&self, change: [T; 2]) -> bool {
        self.is_free || change.iter().all(|&change| change <= T::ratio(1, SMALL))
    }

    /// Whether a change is admissible.
    pub(crate) fn holds(&self, change: [T; 2]) -> bool {
        let bounds = self.own.iter().zip(&self.handed_on);
        self.is_free
            || self.is_small(change)
                && bounds
                    .zip(change)
                    .all(|((&own, &more), change)| change <= own + more)
    }

    /// The bound that is handed on to the next step.
    pub(crate) fn hands_on(self, has_choice: bool, is_corrected: bool) -> [T; 2] {
        if has_choice && is_corrected {
            return [T::int(0); 2];
        }
        let fading = |k: usize| self.handed_on[k] * T::ratio(FADING - 1, FADING);
        [0, 1].map(|k| self.own[k].max(fading(k)))
    }
}
