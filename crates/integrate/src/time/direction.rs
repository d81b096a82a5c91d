//! [`TimeDirection`]: which way a run goes in time.
//!
//! The one place of its sign. A step of the solver has a signed h; sizes, their bounds and step control are
//! of |h|; before and after are meant in the order of travel. A run of H back in time is then that of −H
//! forward, bit for bit, with its times mirrored.

use equip_scalar::Float;

/// Forward or back in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum TimeDirection {
    #[default]
    Forward,
    Backward,
}

impl TimeDirection {
    /// From one time to another; `None` if they are the same.
    pub(crate) fn between<T: Float>(from: T, to: T) -> Option<Self> {
        if from < to {
            Some(TimeDirection::Forward)
        } else if to < from {
            Some(TimeDirection::Backward)
        } else {
            None
        }
    }

    /// The other one.
    pub(crate) fn turned(self) -> Self {
        match self {
            TimeDirection::Forward => TimeDirection::Backward,
            TimeDirection::Backward => TimeDirection::Forward,
        }
    }

    /// A size as a step this way, or a difference of times as a size that is positive this way.
    pub(crate) fn signed<T: Float>(self, x: T) -> T {
        match self {
            TimeDirection::Forward => x,
            TimeDirection::Backward => -x,
        }
    }

    /// Whether a run comes through `time` earlier than through `other`.
    pub(crate) fn is_before<T: Float>(self, time: T, other: T) -> bool {
        match self {
            TimeDirection::Forward => time < other,
            TimeDirection::Backward => time > other,
        }
    }
}
