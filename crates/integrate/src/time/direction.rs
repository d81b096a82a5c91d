//! [`TimeDirection`]: the direction of a run in time.
//!
//! Only this type handles the sign. A step of the solver has a signed h. Sizes, their bounds and step control
//! use |h|. Before and after refer to the direction of the run. A run of H backward in time therefore agrees
//! bit for bit with a run of −H forward, with reflected times.

use equip_scalar::Float;

/// Forward or backward in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum TimeDirection {
    #[default]
    Forward,
    Backward,
}

impl TimeDirection {
    /// The direction from one time to another; `None` if they are equal.
    pub(crate) fn between<T: Float>(from: T, to: T) -> Option<Self> {
        if from < to {
            Some(TimeDirection::Forward)
        } else if to < from {
            Some(TimeDirection::Backward)
        } else {
            None
        }
    }

    /// The opposite direction.
    pub(crate) fn turned(self) -> Self {
        match self {
            TimeDirection::Forward => TimeDirection::Backward,
            TimeDirection::Backward => TimeDirection::Forward,
        }
    }

    /// The signed step of a size, or the size of a time difference that is positive in this direction.
    pub(crate) fn signed<T: Float>(self, x: T) -> T {
        match self {
            TimeDirection::Forward => x,
            TimeDirection::Backward => -x,
        }
    }

    /// Whether a run reaches `time` before `other`.
    pub(crate) fn is_before<T: Float>(self, time: T, other: T) -> bool {
        match self {
            TimeDirection::Forward => time < other,
            TimeDirection::Backward => time > other,
        }
    }
}
