//! What a step asks of the sweeps ([`crate::sweeps`]), and what they answer if they do not solve it.

use crate::state::State;

/// Why sweeps do not solve a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trouble {
    /// The sweeps contract slowly or not at all, or left the domain of H, or slopes would move the end point too far.
    Slow,
    /// No α within the bound, or no slope.
    NoAlpha,
    /// The stages are there; g is above its floor, and the α's are for Newton to move.
    StagesOnly,
}

/// What is fixed while a step is swept.
#[derive(Debug)]
pub(crate) struct SweepTask<'a, T> {
    pub(crate) y: &'a State<T>,
    pub(crate) h: T,
    pub(crate) alphas: &'a [T],
    pub(crate) alpha_bound: T,
    /// Where this step starts in the one whose L is in the iterate, its size over that of it, and that, if there is one.
    pub(crate) last: Option<[T; 3]>,
    /// ∇H(y), if it is known.
    pub(crate) known: Option<&'a [T]>,
    /// Who moves the α's, if there is a constraint.
    pub(crate) rule: Rule,
    /// Local errors that slopes may move the end point by, if that is limited.
    pub(crate) most_errors: Option<f64>,
    /// Whether α's by responses are to be the same in the step made backwards, to round-off.
    pub(crate) is_to_return: bool,
}

/// Who moves the α's of a step whose stages sweeps have found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rule {
    /// Sweeps, by [`crate::slopes`], as soon as g stands out.
    Slopes,
    /// Sweeps, by [`crate::response`], when the stages have converged.
    Response,
    /// Newton.
    Newton,
}
