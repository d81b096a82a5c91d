//! Everything that can go wrong, each with what to change.

use equip_scalar::{Float, plain};

/// What stopped the steps and what helps: a singularity is named where something has grown, and `min_step`
/// where it was given.
fn below_minimum<T: Float>(step: T, min: T, growth: T) -> String {
    let is_bounded = step < min;
    let bound = if is_bounded {
        format!(", and `min_step` is {min:e}")
    } else {
        ", and time resolves none".to_owned()
    };
    let remedy = if is_bounded {
        "lower `min_step` or loosen the tolerance"
    } else {
        "loosen the tolerance"
    };
    if growth > T::int(0) {
        format!(
            "{bound}; the motion nears a singularity, force or speed are {growth:.1e} times what they were at the start: end the run before that time, or {remedy}"
        )
    } else if is_bounded {
        format!("{bound}: {remedy}")
    } else {
        format!("{bound}; H has a kink, a jump or much rounding there: {remedy}")
    }
}

/// Why an integration could not start or go on. A failed step leaves the state as it was before it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntegrateError<T: Float> {
    /// The number of stages is outside what the method and the tableau allow.
    #[error(
        "{stages} stages requested; this method takes {min} to {max}: change the argument of `stages`"
    )]
    StagesOutOfRange {
        /// Stages requested.
        stages: usize,
        /// Fewest stages the method has.
        min: usize,
        /// Most stages the tableau is made for.
        max: usize,
    },
    /// A tolerance for a method of degree 1.
    #[error(
        "a method of order 2 has no estimate of its error: give a step, or take HBVM of degree 2 or more"
    )]
    NoErrorEstimate,
    /// The step is zero, infinite or NaN.
    #[error(
        "the step is {step}; it must be finite and not zero (a negative one goes back in time)",
        step = plain(*step))]
    StepOutOfRange {
        /// The step given.
        step: T,
    },
    /// An option of the other kind of steps.
    #[error(
        "`{option}` does not belong to {}; leave it out, or use `.{}`",
        if *option == "max_halvings" { "steps by a tolerance" } else { "fixed steps" },
        if *option == "max_halvings" { "step(h)" } else { "tolerance(tol)" }
    )]
    MisplacedOption {
        /// Its name.
        option: &'static str,
    },
    /// The steps lead away from where the run is to end.
    #[error(
        "steps of {step} lead from {start} away from {end}; give a step without a sign, which takes the direction of the interval, or an end on the other side; a resumed run keeps its direction",
        step = plain(*step), start = plain(*start), end = plain(*end))]
    StepsLeadAway {
        /// A step, with its sign.
        step: T,
        /// Start of the run.
        start: T,
        /// Where it is to end.
        end: T,
    },
    /// The step is lost in the rounding of the time.
    #[error(
        "the step {step} does not change the time {time}; take a larger step or let time start at 0",
        time = plain(*time), step = plain(*step))]
    StepBelowTimeResolution {
        /// The step given.
        step: T,
        /// A time of the interval at which the step vanishes.
        time: T,
    },
    /// More steps than can be counted.
    #[error(
        "the interval takes {steps:.1e} steps of this size; take a larger step or a shorter interval"
    )]
    TooManySteps {
        /// Interval divided by step.
        steps: f64,
    },
    /// The interval is not finite.
    #[error("the interval {start} to {end} must be finite; give two finite times, in either order",
        start = plain(*start), end = plain(*end))]
    Interval {
        /// Start of the interval.
        start: T,
        /// End of the interval.
        end: T,
    },
    /// Deviations were not propagated over all steps of a run.
    #[error(
        "the run has made {steps} steps since deviations were last propagated; propagate them after every step, or go on with `advance_to` of the tangent map"
    )]
    StepsNotFollowed {
        /// Steps made since.
        steps: u64,
    },
    /// An odd number of components.
    #[error("a state of {components} components needs a bracket; give it by `with_bracket`")]
    NoBracket {
        /// Components of the state.
        components: usize,
    },
    /// A vector has the wrong length.
    #[error("{what} has length {found}, but this Hamiltonian needs {expected}")]
    WrongLength {
        /// Which vector.
        what: &'static str,
        /// Degrees of freedom of the Hamiltonian.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// An initial value is infinite or NaN.
    #[error("initial value {what}[{index}] is {value}; it must be finite")]
    InitialNotFinite {
        /// `q0` or `p0`.
        what: &'static str,
        /// Component.
        index: usize,
        /// The value given.
        value: T,
    },
    /// H or its gradient is infinite or NaN where the run starts.
    #[error(
        "at the initial state H or its gradient is not finite (H = {energy}); start elsewhere or check H for a division by zero, a root or a logarithm of a negative number; a test particle is given a small mass in place of none, 1e-12 of the others' say, whose pull on them is as small"
    )]
    EnergyNotFinite {
        /// H at the start.
        energy: T,
    },
    /// A gradient written by hand is not that of H.
    #[error(
        "at t = {time} the gradient given by hand has {given:e} for ∂H/∂{what}[{index}], where H has {expected:e}; correct it, leave it out (H is differentiated then), or take it as it is with `check_gradient(false)`",
        time = plain(*time))]
    WrongGradient {
        /// Time of the state.
        time: T,
        /// `q` or `p`. Where H depends on time the last of these are t and its momentum.
        what: &'static str,
        /// Component.
        index: usize,
        /// What the gradient says.
        given: T,
        /// What H says.
        expected: T,
    },
    /// An option has a value outside its range.
    #[error("option `{option}` is {value}; it must be {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: T,
        /// What is accepted.
        expected: &'static str,
    },
    /// More quantities to conserve than parameters α.
    #[error("{kept} quantities are to be conserved by {alphas} free parameters α; take at least {} stages with all α free, or conserve fewer", kept + 1)]
    TooFewAlphas {
        /// Equations: the energy unless H is quadratic, and the invariants to be kept.
        kept: usize,
        /// Free parameters α of the method.
        alphas: usize,
    },
    /// An output time lies outside the interval or before the one ahead of it.
    #[error(
        "output time {time} (number {index}) must lie in {start} to {end} and not before the one ahead of it, in the order in which the run goes",
        time = plain(*time), start = plain(*start), end = plain(*end))]
    OutputTime {
        /// The time given.
        time: T,
        /// Its place in the list.
        index: usize,
        /// Start of the interval.
        start: T,
        /// End of the interval.
        end: T,
    },
    /// A checkpoint was made under other conditions.
    #[error(
        "the checkpoint was made with {what} {stored}, this run has {now}; resume with what it was made with, or start anew"
    )]
    CheckpointMismatch {
        /// What differs.
        what: &'static str,
        /// What the checkpoint says.
        stored: String,
        /// What this run says.
        now: String,
    },
    /// A checkpoint was made with another H.
    #[error(
        "H is not what it was when the checkpoint was made at t = {time}: give the same Hamiltonian with the same parameters, or start anew",
        time = plain(*time))]
    CheckpointOtherEnergy {
        /// Time of the checkpoint.
        time: T,
    },
    /// A checkpoint cannot be read.
    #[error("the checkpoint is damaged: {what} cannot be read; take an earlier one or start anew")]
    CheckpointDamaged {
        /// Which part.
        what: &'static str,
    },
    /// A checkpoint was made after the shorter last step of a run.
    #[error(
        "the checkpoint was made at t = {time}, which is not on the grid of its steps (the last step of a run may be shorter); resume from an earlier one, or start anew from there",
        time = plain(*time))]
    CheckpointOffGrid {
        /// Time of the checkpoint.
        time: T,
    },
    /// An event function changes sign too often, or its noise does.
    #[error(
        "the event `{event}` has more structure in the step at t = {time}, h = {step:e} than can be told from noise; give a smooth function whose rounding is small compared with its changes",
        time = plain(*time))]
    EventTooRough {
        /// Name of the event.
        event: String,
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
    },
    /// Rounding leaves more of an error than the target that a step is asked for.
    #[error(
        "the error stays at {reached:e} however small the step (that of {step:e} is no worse), and {target:e} is requested: take a larger target, a shorter interval or a number type of more digits"
    )]
    TargetBelowRoundOff {
        /// The target.
        target: T,
        /// The smallest error of a trial.
        reached: T,
        /// A step that reaches it.
        step: T,
    },
    /// No trial has reached the target that a step is asked for.
    #[error(
        "no step down to {step:e} reaches the target {target:e} (the last trial had the error {error:e}); take more stages, a larger target or a shorter interval, or variable steps"
    )]
    TargetNotReached {
        /// The target.
        target: T,
        /// Error of the last trial.
        error: T,
        /// The smallest step tried.
        step: T,
    },
    /// The motion leaves a table of H that does not extrapolate.
    #[error(
        "at t = {time} the motion is at {argument:e}, outside of a table of H that begins at {first:e} and ends at {last:e}; end the run before, measure further, or extrapolate the table",
        time = plain(*time))]
    OutsideOfTable {
        /// Time of a stage or of the end of a step that is outside.
        time: T,
        /// The argument of the table there.
        argument: T,
        /// First knot.
        first: T,
        /// Last knot.
        last: T,
    },
    /// Step control wants a step below the smallest one allowed, or below the resolution of time.
    #[error(
        "the tolerance {tolerance:e} asks for a step below {step:e} at t = {time}{}",
        below_minimum(*step, *min, *growth),
        time = plain(*time))]
    StepBelowMinimum {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// Smallest step allowed, `min_step`.
        min: T,
        /// The tolerance given.
        tolerance: T,
        /// How many times as large the force or the speed is there as where the run began, the largest
        /// component of ∂H/∂q or of ∂H/∂p; zero if it has not grown a thousandfold.
        growth: T,
    },
    /// The run has made all the steps it may.
    #[error(
        "{steps} steps were made and t = {time} is reached; raise `max_steps`, loosen the tolerance or shorten the interval",
        time = plain(*time))]
    StepLimit {
        /// Steps allowed.
        steps: u64,
        /// Time reached.
        time: T,
    },
    /// H became infinite or NaN inside a step, also after all halvings.
    #[error(
        "H or its derivatives are not finite inside the step at t = {time}, h = {step}, also after halving it {halvings} times; the trajectory leaves the domain of H there, or the step is too large",
        time = plain(*time), step = plain(*step))]
    NotFinite {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// Halvings tried.
        halvings: u32,
    },
    /// The stage equations were not solved, also after all halvings.
    #[error(
        "the stage equations did not converge in the step at t = {time}, h = {step}, also after halving it {halvings} times ({iterations} iterations, last correction {correction:e} relative to the state); take a smaller step",
        time = plain(*time), step = plain(*step))]
    NoConvergence {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// Halvings tried.
        halvings: u32,
        /// Iterations of the last attempt, fixed-point or Newton's.
        iterations: u32,
        /// Last correction, relative to the state.
        correction: T,
    },
    /// The step has a solution, which has nothing to do with the motion.
    #[error(
        "in the step at t = {time}, h = {step} the stage equations lead to a state whose energy differs by {change:e}, where {exchanged:e} is exchanged between positions and momenta: the step is too large for them to have the solution that follows the motion; take a smaller step",
        time = plain(*time), step = plain(*step))]
    Astray {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// What H changes by over the step.
        change: T,
        /// Σ_i h b_i Σ_c |q̇_c ṗ_c|, the energy exchanged in it.
        exchanged: T,
    },
    /// The motion runs away to infinity, which it reaches in finite time.
    #[error(
        "the motion runs away to infinity: at t = {time} the position has the size {size:e} and grows by a factor within h = {step}; end the run before that time, or start where the energy is too low to escape",
        time = plain(*time), step = plain(*step))]
    Escape {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// |q| there.
        size: T,
    },
    /// The Newton matrix is singular, also after all halvings.
    #[error(
        "the Newton matrix is singular in the step at t = {time}, h = {step}, also after halving it {halvings} times; take a slightly different step",
        time = plain(*time), step = plain(*step))]
    Singular {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// Halvings tried.
        halvings: u32,
    },
    /// No admissible α keeps the energy, and the user asked to refuse such steps.
    #[error(
        "no admissible α conserves the energy in the step at t = {time}, h = {step} (energy error {energy_error:e}, round-off level {round_off:e}); take a smaller step, more stages, all α, or leave the energy error to a later step",
        time = plain(*time), step = plain(*step))]
    NoAdmissibleAlpha {
        /// Start of the step.
        time: T,
        /// Its size.
        step: T,
        /// H − H_ref of the step with α = 0.
        energy_error: T,
        /// What of it would be round-off.
        round_off: T,
    },
}

impl<T: Float> IntegrateError<T> {
    /// Whether a step that fails so fails also if it is shorter.
    pub(crate) fn stays_in_shorter_steps(&self) -> bool {
        matches!(
            self,
            Self::NoAdmissibleAlpha { .. } | Self::WrongGradient { .. }
        )
    }
}
