//! The errors of an integration, each with a remedy.

use equip_scalar::{Float, plain};

/// The reason why steps became too small, and the remedy. It names a singularity if force or speed have
/// grown, and `min_step` if it is set.
fn below_minimum<T: Float>(step: T, min: T, growth: T) -> String {
    let (bound, lower) = match step < min {
        true => (format!("`min_step` is {min:e}"), "lower `min_step` or "),
        false => ("the resolution of time".to_owned(), ""),
    };
    let cause = if growth > T::int(0) {
        format!(
            "; the motion approaches a singularity, where force or speed has grown by a factor of {growth:.1e} since the start: end the run before that time, or"
        )
    } else if lower.is_empty() {
        "; H has a discontinuity or a large rounding error there (`accuracy` of an external energy):".to_owned()
    } else {
        ":".to_owned()
    };
    format!(", {bound}{cause} {lower}loosen the tolerance")
}

/// Why an integration could not start or continue. A failed step leaves the state unchanged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntegrateError<T: Float> {
    /// The number of stages is outside the range of the method or of the tableau.
    #[error(
        "{stages} stages requested; this method accepts {min} to {max}: change the argument of `stages`"
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
        "a method of order 2 has no error estimate: give a step, or use HBVM of degree 2 or more"
    )]
    NoErrorEstimate,
    /// The step is zero, infinite or NaN.
    #[error(
        "the step is {step}; it must be finite and not zero (a negative step goes back in time)",
        step = plain(*step))]
    StepOutOfRange {
        /// The step given.
        step: T,
    },
    /// An option belongs to the other kind of steps.
    #[error(
        "`{option}` is not an option of {}; omit it, or use `.{}`",
        if *option == "max_halvings" { "steps by a tolerance" } else { "fixed steps" },
        if *option == "max_halvings" { "step(h)" } else { "tolerance(tol)" }
    )]
    MisplacedOption {
        /// The name of the option.
        option: &'static str,
    },
    /// The steps lead away from the end of the run.
    #[error(
        "steps of {step} from {start} lead away from {end}; give a step without a sign (the interval then determines the direction), or an end on the other side; a resumed run keeps its direction",
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
        "the step {step} does not change the time {time}; use a larger step, or begin at time 0",
        time = plain(*time), step = plain(*step))]
    StepBelowTimeResolution {
        /// The step given.
        step: T,
        /// A time of the interval at which the step vanishes.
        time: T,
    },
    /// The number of steps is too large.
    #[error("{steps:.1e} steps are too many; use a larger step or a shorter interval")]
    TooManySteps {
        /// The interval divided by the step.
        steps: f64,
    },
    /// The interval or its length is not finite.
    #[error("the interval {start} to {end} and its length must be finite; give two finite times, in either order",
        start = plain(*start), end = plain(*end))]
    Interval {
        /// Start of the interval.
        start: T,
        /// End of the interval.
        end: T,
    },
    /// Tangent vectors were not propagated over all steps of a run.
    #[error(
        "the run has made {steps} steps since the tangent vectors were last propagated; propagate them after every step, or continue with `advance_to` of the tangent map"
    )]
    StepsNotFollowed {
        /// The number of steps since the last propagation.
        steps: u64,
    },
    /// A state with an odd number of components has no bracket.
    #[error("a state of {components} components needs a bracket; add it with `with_bracket`")]
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
        "at the initial state H or its gradient is not finite (H = {energy}); change the initial state, or check H for a division by zero, or a root or logarithm of a negative number; for a test particle use a small mass, for example 1e-12 of the other masses, not mass 0"
    )]
    EnergyNotFinite {
        /// H at the initial state.
        energy: T,
    },
    /// A user-supplied gradient is not the gradient of H.
    #[error(
        "at t = {time} the given gradient has ∂H/∂{what}[{index}] = {given:e}, but H has {expected:e}; correct the gradient, or give the `accuracy` of an external energy of lower precision; an H given by a closure needs no gradient",
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
    /// A tangent vector is requested, and an event changes the state.
    #[error("the derivative of the change by the event `{event}` is not known: omit it or `chaos`")]
    ChaosWithChange {
        /// Name of the event.
        event: String,
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
    #[error("{kept} quantities to conserve, but only {alphas} free parameters α; use at least {} stages with several α_k (default), or conserve fewer quantities", kept + 1)]
    TooFewAlphas {
        /// The number of equations: the energy unless H is quadratic, and the further invariants.
        kept: usize,
        /// The number of free parameters α of the method.
        alphas: usize,
    },
    /// An output time lies outside the interval, or precedes the one before it.
    #[error(
        "output time {time} (number {index}) must lie between {start} and {end}, and output times must be sorted in the direction of the run",
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
        "the checkpoint was made with {what} {stored}, this run has {now}; resume with the settings of the checkpoint, or start again"
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
        "H differs from the H of the checkpoint, which was made at t = {time}: give the same Hamiltonian with the same parameters, or start again",
        time = plain(*time))]
    CheckpointOtherEnergy {
        /// The time of the checkpoint.
        time: T,
    },
    /// A checkpoint cannot be read.
    #[error("the checkpoint is damaged: {what} cannot be read; use an earlier one, or start again")]
    CheckpointDamaged {
        /// The part that cannot be read.
        what: &'static str,
    },
    /// A checkpoint was made after the shorter last step of a run.
    #[error(
        "the checkpoint was made at t = {time}, which is not on its time grid (the last step of a run may be shorter); resume from an earlier checkpoint, or start a new run from this state",
        time = plain(*time))]
    CheckpointOffGrid {
        /// The time of the checkpoint.
        time: T,
    },
    /// An event function, or its noise, changes sign too often.
    #[error(
        "the event function `{event}` changes sign more often in the step at t = {time}, h = {step:e} than a polynomial of the step resolves; take shorter steps (`step`, or `max_step`), a few for each root, or give a smooth function whose rounding errors are small compared with its changes",
        time = plain(*time))]
    EventTooRough {
        /// The name of the event.
        event: String,
        /// The start of the step.
        time: T,
        /// The size of the step.
        step: T,
    },
    /// An event has changed the state to one from which the run cannot continue.
    #[error(
        "the run cannot continue from the state to which the event `{event}` changed it at t = {time}: {cause}",
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
        "rounding limits the error to {reached:e} (step {step:e}), above the target {target:e}: use a larger target, a shorter interval, or a floating-point type with more digits"
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
        "no step size down to {step:e} reaches the target {target:e} (the last trial had an error of {error:e}); use more stages, a larger target, a shorter interval, or variable steps"
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
        "at t = {time} the argument of a table in H is {argument:e}, outside its range {first:e} to {last:e}; end the run earlier (by a `terminal` event), extend the data, or extrapolate the table",
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
    /// The step size control requires a step below the smallest allowed one, or below the resolution of time.
    #[error(
        "the tolerance {tolerance:e} requires a step below {step:e} at t = {time}{}",
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
        "the limit of {steps} steps is reached at t = {time}; raise `max_steps`, loosen the tolerance, shorten the interval, or increase the `accuracy` of an external energy to its rounding error",
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
        "the iteration for the stages did not converge in the step at t = {time}, h = {step}, also after halving it {halvings} times ({iterations} iterations, last correction {correction:e} relative to the state); use a smaller step",
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
    /// The iteration converged to a spurious solution of the stage equations.
    #[error(
        "the step at t = {time}, h = {step} is too large: the iteration converged to a spurious solution of the stage equations (H changes by {change:e}, while positions and momenta exchange {exchanged:e}); use a smaller step",
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
        "the motion escapes to infinity: at t = {time} |q| is {size:e} and still multiplies within h = {step}; end the run before that time, or start with an energy below the escape energy",
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
        "the Newton matrix is singular in the step at t = {time}, h = {step}, also after halving it {halvings} times; use a slightly different step",
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
        "no admissible α conserves the energy in the step at t = {time}, h = {step} (energy error {energy_error:e}, round-off level {round_off:e}); use a smaller step, more stages or several α_k (default), or accept uncorrected steps",
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
