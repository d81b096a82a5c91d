//! [`Made`]: what has become of a try to make a step.

use crate::control::estimate::Estimate;
use equip_solver::Outcome;

/// A size, without a sign, and where it leads.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<T> {
    pub(super) size: T,
    pub(super) time: T,
    pub(super) time_low: T,
    pub(super) cut: bool,
}

/// A step, or only its stages.
pub(super) enum Made<T> {
    Step(Outcome, Estimate, EndIs),
    /// It is over a switch of H, and to be made up to it, …
    OverSwitch(Place<T>),
    /// … or half as long, where many knots of a table may lie on its way.
    OverKnots,
}

/// Where a step ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EndIs {
    /// There was no switch on its way.
    Smooth,
    OnSwitch,
    /// Beyond one that the tolerance allows it to pass over, or at which no try has ended.
    BeyondSwitch,
}
