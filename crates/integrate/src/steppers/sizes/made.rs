//! [`Made`]: the result of an attempt to make a step.

use crate::control::estimate::Estimate;
use equip_solver::Outcome;

/// A size, without sign, and the time at the end of the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<T> {
    pub(super) size: T,
    pub(super) time: T,
    pub(super) time_low: T,
    pub(super) cut: bool,
}

/// A complete step, or its stages only.
pub(super) enum Made<T> {
    Step(Outcome, Estimate, EndIs),
    /// The step crosses a switch of H, and must be repeated up to the switch.
    OverSwitch(Place<T>),
    /// Many knots of a table may be in the step; it must be repeated with half the size.
    OverKnots,
}

/// The end of a step with respect to switches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EndIs {
    /// The step met no switch.
    Smooth,
    OnSwitch,
    /// The step crossed a switch whose effect is below the tolerance, or on which no attempt has ended.
    BeyondSwitch,
}
