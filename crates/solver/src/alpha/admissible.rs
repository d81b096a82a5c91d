//! Bounds on the change of y1 caused by the parameters α.
//!
//! *Admissible* (docs/adr/0013). Let a be the larger of the local error of the step and of the change of y1
//! that the energy error of this step requires. A change of y1 caused by α is admissible up to [`FARTHEST`] ·
//! a, *plus the largest bound of the uncorrected steps just before*. That bound fades by 1/[`FADING`] a step,
//! so that a later step may remove the errors of uncorrected steps (docs/adr/0026). If there are no more
//! parameters than constraints, corrected steps hand on their bound as well, because such a method is chosen
//! for its constraints.
//!
//! A change of a component is measured in two units: the change of this component over the step, and the
//! largest change of a component in its group (positions, momenta). In both units it must be at most
//! 1/[`SMALL`]. Time and its momentum do not count.

use crate::policy::{FADING, FARTHEST, SMALL};
use equip_scalar::Float;

/// Bounds on the change of y1, in both units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds<T> {
    /// A lower bound of the change that removes the energy error.
    pub(crate) needed: [T; 2],
    /// The bound of this step.
    own: [T; 2],
    /// The bound handed on by earlier steps.
    handed_on: [T; 2],
    /// Whether every α is admissible.
    is_free: bool,
    /// Whether the local error has been estimated, or is not needed.
    pub(crate) has_error: bool,
}

impl<T: Float> Bounds<T> {
    /// For a step whose constraints require the change `needed`. The errors of this step alone require `own`.
    pub(crate) fn new(needed: [T; 2], own: [T; 2], handed_on: [T; 2], is_free: bool) -> Self {
        Bounds {
            needed,
            own: own.map(|own| T::int(FARTHEST) * own),
            handed_on,
            is_free,
            has_error: is_free,
        }
    }

    /// Extends the bound by the local error of the step.
    pub(crate) fn extend(&mut self, error: [T; 2]) {
        for (own, error) in self.own.iter_mut().zip(error) {
            *own = own.max(T::int(FARTHEST) * error);
        }
    }

    /// Whether a change is small compared with the change over the step.
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

    /// The bound handed on to the next step.
    pub(crate) fn hands_on(self, has_choice: bool, is_corrected: bool) -> [T; 2] {
        if has_choice && is_corrected {
            return [T::int(0); 2];
        }
        let fading = |k: usize| self.handed_on[k] * T::ratio(FADING - 1, FADING);
        [0, 1].map(|k| self.own[k].max(fading(k)))
    }
}
