//! The errors of an integration, each with a remedy.

use equip_scalar::{Float, plain};

/// The reason why steps became too small, and the remedy. It names a singularity if force or speed have
/// grown, and `min_step` if it is set.
fn below_minimum<T: Float>(step: T, min: T, growth: T) -> String {
    let is_bounded = step < min;
    let (bound, lower) = match is_bounded {
        true => (
            format!(", and `min_step` is {min:e}"),
            "lower `min_step` or ",
        ),
        false => (", and time resolves none".to_owned(), ""),
    };
    let remedy = format!("{lower}loosen the tolerance");
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

/// Why an integration could not start or continue. A failed step leaves the state unchanged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntegrateError<T: Float> {
    /// The number of stages is outside the range of the method or of the tableau.
    #[error(
        "{stages} stages requested; this method takes {min} to {max}: change the argument of `stages`"
    )]
    StagesOutOfRange {
        /// The number of stages requested.
        stages: usize,
        /// The smallest number of stages of the method.
        min: usize,
        /// The largest number of stages of the tableau.
        max: usize,
    },
    /// A tolerance was given for a method of degree 1.
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
    /// An option belongs to the other kind of steps.
    #[error(
        "`{option}` does not belong to {}; leave it out, or use `.{}`",
        if *option == "max_halvings" { "steps by a tolerance" } else { "fixed steps" },
        if *option == "max_halvings" { "step(h)" } else { "tolerance(tol)" }
    )]
    MisplacedOption {
        /// The name of the option.
        option: &'static str,
    },
    /// The steps lead away from the end of the run.
    #[error(
        "steps of {step} lead from {start} away from {end}; give a step without a sign, which takes the direction of the interval, or an end on the other side; a resumed run keeps its direction",
        step = plain(*step), start = plain(*start), end = plain(*end))]
    StepsLeadAway {
        /// A step, with its sign.
        step: T,
        /// The start of the run.
        start: T,
        /// The end of the run.
        end: T,
    },
    /// The step vanishes in the rounding of time.
    #[error(
        "the step {step} does not change the time {time}; take a larger step or let time start at 0",
        time = plain(*time), step = plain(*step))]
    StepBelowTimeResolution {
        /// The step given.
        step: T,
        /// A time of the interval at which the step vanishes.
        time: T,
    },
    /// The number of steps is too large.
    #[error(
        "the interval takes {steps:.1e} steps of this size; take a larger step or a shorter interval"
    )]
    TooManySteps {
        /// The interval divided by the step.
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
    /// Tangent vectors were not propagated over all steps of a run.
    #[error(
        "the run has made {steps} steps since deviations were last propagated; propagate them after every step, or go on with `advance_to` of the tangent map"
    )]
    StepsNotFollowed {
        /// The number of steps since the last propagation.
        steps: u64,
    },
    /// A state with an odd number of components has no bracket.
    #[error("a state of {components} components needs a bracket; give it by `with_bracket`")]
    NoBracket {
        /// The number of components of the state.
        components: usize,
    },
    /// A vector has the wrong length.
    #[error("{what} has length {found}, but this Hamiltonian needs {expected}")]
    WrongLength {
        /// The name of the vector.
        what: &'static str,
        /// The required length.
        expected: usize,
        /// The length given.
        found: usize,
    },
    /// An initial value is infinite or NaN.
    #[error("initial value {what}[{index}] is {value}; it must be finite")]
    InitialNotFinite {
        /// `q0` or `p0`.
        what: &'static str,
        /// The index of the component.
        index: usize,
        /// The value given.
        value: T,
    },
    /// H or its gradient is infinite or NaN at the initial state.
    #[error(
        "at the initial state H or its gradient is not finite (H = {energy}); start elsewhere or check H for a division by zero, a root or a logarithm of a negative number; a test particle is given a small mass in place of none, 1e-12 of the others' say, whose pull on them is as small"
    )]
    EnergyNotFinite {
        /// H at the initial state.
        energy: T,
    },
    /// A user-supplied gradient is not the gradient of H.
    #[error(
        "at t = {time} the gradient given by hand has {given:e} for ∂H/∂{what}[{index}], where H has {expected:e}; correct it, leave it out (H is differentiated then), or take it as it is with `check_gradient(false)`",
        time = plain(*time))]
    WrongGradient {
        /// The time of the state.
        time: T,
        /// `q` or `p`. If H depends on time, the last component of these is t or its momentum.
        what: &'static str,
        /// The index of the component.
        index: usize,
        /// The component of the user-supplied gradient.
        given: T,
        /// The component of ∇H.
        expected: T,
    },
    /// An option has a value outside its range.
    #[error("option `{option}` is {value}; it must be {expected}")]
    Option {
        /// The name of the option.
        option: &'static str,
        /// The value given.
        value: T,
        /// The accepted values.
        expected: &'static str,
    },
    /// There are more quantities to conserve than parameters α.
    #[error("{kept} quantities are to be conserved by {alphas} free parameters α; take at least {} stages with all α free, or conserve fewer", kept + 1)]
    TooFewAlphas {
        /// The number of equations: the energy unless H is quadratic, and the further invariants.
        kept: usize,
        /// The number of free parameters α of the method.
        alphas: usize,
    },
    /// An output time lies outside the interval, or precedes the one before it.
    #[error(
        "output time {time} (number {index}) must lie in {start} to {end} and not before the one ahead of it, in the order in which the run goes",
        time = plain(*time), start = plain(*start), end = plain(*end))]
    OutputTime {
        /// The time given.
        time: T,
        /// Its index in the list.
        index: usize,
        /// The start of the interval.
        start: T,
        /// The end of the interval.
        end: T,
    },
    /// A checkpoint was made under other conditions.
    #[error(
        "the checkpoint was made with {what} {stored}, this run has {now}; resume with what it was made with, or start anew"
    )]
    CheckpointMismatch {
        /// The item that differs.
        what: &'static str,
        /// Its value in the checkpoint.
        stored: String,
        /// Its value in this run.
        now: String,
    },
    /// A checkpoint was made with another H.
    #[error(
        "H is not what it was when the checkpoint was made at t = {time}: give the same Hamiltonian with the same parameters, or start anew",
        time = plain(*time))]
    CheckpointOtherEnergy {
        /// The time of the checkpoint.
        time: T,
    },
    /// A checkpoint cannot be read.
    #[error("the checkpoint is damaged: {what} cannot be read; take an earlier one or start anew")]
    CheckpointDamaged {
        /// The part that cannot be read.
        what: &'static str,
    },
    /// A checkpoint was made after the shorter last step of a run.
    #[error(
        "the checkpoint was made at t = {time}, which is not on the grid of its steps (the last step of a run may be shorter); resume from an earlier one, or start anew from there",
        time = plain(*time))]
    CheckpointOffGrid {
        /// The time of the checkpoint.
        time: T,
    },
    /// An event function, or its noise, changes sign too often.
    #[error(
        "the event `{event}` has more structure in the step at t = {time}, h = {step:e} than can be told from noise; give a smooth function whose rounding is small compared with its changes",
        time = plain(*time))]
    EventTooRough {
        /// The name of the event.
        event: String,
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
    },
    /// An event has made a state from which the run cannot continue.
    #[error(
        "the event `{event}` has changed the state at t = {time} to one from which the run cannot continue: {cause}",
        time = plain(*time))]
    ChangedState {
        /// Name of the event.
        event: String,
        /// Time of the root.
        time: T,
        /// What is wrong with the state.
        cause: String,
    },
    /// The error due to rounding exceeds the target of a suggested step.
    #[error(
        "the error stays at {reached:e} however small the step (that of {step:e} is no worse), and {target:e} is requested: take a larger target, a shorter interval or a number type of more digits"
    )]
    TargetBelowRoundOff {
        /// The target.
        target: T,
        /// The smallest error of a trial.
        reached: T,
        /// A step with this error.
        step: T,
    },
    /// No trial has reached the target of a suggested step.
    #[error(
        "no step down to {step:e} reaches the target {target:e} (the last trial had the error {error:e}); take more stages, a larger target or a shorter interval, or variable steps"
    )]
    TargetNotReached {
        /// The target.
        target: T,
        /// The error of the last trial.
        error: T,
        /// The smallest step tried.
        step: T,
    },
    /// The motion leaves a table of H that does not extrapolate.
    #[error(
        "at t = {time} the motion is at {argument:e}, outside of a table of H that begins at {first:e} and ends at {last:e}; end the run before, measure further, or extrapolate the table",
        time = plain(*time))]
    OutsideOfTable {
        /// The time of a stage or of the end of a step outside the table.
        time: T,
        /// The argument of the table at this time.
        argument: T,
        /// The first knot.
        first: T,
        /// The last knot.
        last: T,
    },
    /// Step control requires a step below the smallest allowed one, or below the resolution of time.
    #[error(
        "the tolerance {tolerance:e} asks for a step below {step:e} at t = {time}{}",
        below_minimum(*step, *min, *growth),
        time = plain(*time))]
    StepBelowMinimum {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// The smallest allowed step, `min_step`.
        min: T,
        /// The tolerance given.
        tolerance: T,
        /// The growth of the force or the speed, the largest component of ∂H/∂q or of ∂H/∂p, since the start
        /// of the run; zero if it is less than a thousandfold.
        growth: T,
    },
    /// The run has reached its maximum number of steps.
    #[error(
        "{steps} steps were made and t = {time} is reached; raise `max_steps`, loosen the tolerance or shorten the interval",
        time = plain(*time))]
    StepLimit {
        /// The maximum number of steps.
        steps: u64,
        /// The time reached.
        time: T,
    },
    /// H is infinite or NaN inside a step, even after all halvings.
    #[error(
        "H or its derivatives are not finite inside the step at t = {time}, h = {step}, also after halving it {halvings} times; the trajectory leaves the domain of H there, or the step is too large",
        time = plain(*time), step = plain(*step))]
    NotFinite {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// The number of halvings.
        halvings: u32,
    },
    /// The stage equations did not converge, even after all halvings.
    #[error(
        "the stage equations did not converge in the step at t = {time}, h = {step}, also after halving it {halvings} times ({iterations} iterations, last correction {correction:e} relative to the state); take a smaller step",
        time = plain(*time), step = plain(*step))]
    NoConvergence {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// The number of halvings.
        halvings: u32,
        /// The iterations of the last attempt, fixed-point or Newton.
        iterations: u32,
        /// The last change of the stages, relative to the state.
        correction: T,
    },
    /// The solution of the stage equations does not follow the motion.
    #[error(
        "in the step at t = {time}, h = {step} the stage equations lead to a state whose energy differs by {change:e}, where {exchanged:e} is exchanged between positions and momenta: the step is too large for them to have the solution that follows the motion; take a smaller step",
        time = plain(*time), step = plain(*step))]
    Astray {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// The change of H over the step.
        change: T,
        /// Σ_i h b_i Σ_c |q̇_c ṗ_c|, the energy exchanged between positions and momenta in the step.
        exchanged: T,
    },
    /// The motion escapes to infinity in finite time.
    #[error(
        "the motion runs away to infinity: at t = {time} the position has the size {size:e} and grows by a factor within h = {step}; end the run before that time, or start where the energy is too low to escape",
        time = plain(*time), step = plain(*step))]
    Escape {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// |q| at the start of the step.
        size: T,
    },
    /// The Newton matrix is singular, even after all halvings.
    #[error(
        "the Newton matrix is singular in the step at t = {time}, h = {step}, also after halving it {halvings} times; take a slightly different step",
        time = plain(*time), step = plain(*step))]
    Singular {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// The number of halvings.
        halvings: u32,
    },
    /// No admissible α conserves the energy, and uncorrected steps are to be rejected.
    #[error(
        "no admissible α conserves the energy in the step at t = {time}, h = {step} (energy error {energy_error:e}, round-off level {round_off:e}); take a smaller step, more stages, all α, or leave the energy error to a later step",
        time = plain(*time), step = plain(*step))]
    NoAdmissibleAlpha {
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
        /// H − H_ref of the step with α = 0.
        energy_error: T,
        /// The round-off level of H.
        round_off: T,
    },
}
