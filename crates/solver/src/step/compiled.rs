//! What is compiled once, with this crate: the step and its tangent map, in `f64` and double-double
//! ([`equip_scalar::ready!`]).

use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::outcome::parts::Part;
use crate::step::core::Core;
use crate::step_tangent::StepTangent;
use equip_iterate::State;
use equip_scalar::Float;

/// The functions, each as it is called.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
struct Ready<T: Float> {
    step: fn(&mut Core<T>, (&State<T>, T, T), &mut State<T>) -> Result<Outcome, Failure<T>>,
    complete: fn(&mut Core<T>, (&State<T>, T, T), &mut State<T>) -> Result<Outcome, Failure<T>>,
    linearise: fn(&mut StepTangent<T>, &Part<T>),
    propagate: fn(&mut StepTangent<T>, &mut [T]) -> Result<(), Failure<T>>,
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        step: Core::make,
        complete: Core::make_complete,
        linearise: StepTangent::make,
        propagate: StepTangent::propagate_part,
    };
}

equip_scalar::ready!(Ready);

impl<T: Float> StepTangent<T> {
    /// Takes the linearised stage equations of `part`. Costs s Hessians.
    pub fn linearise(&mut self, part: &Part<T>) {
        (ready::<T>().linearise)(self, part);
    }

    /// Propagates `deviation`, n components, over the part that has been linearised.
    ///
    /// # Errors
    /// [`Failure::NotFinite`] or [`Failure::Singular`] if the linearised stages cannot be solved for.
    pub fn propagate(&mut self, deviation: &mut [T]) -> Result<(), Failure<T>> {
        (ready::<T>().propagate)(self, deviation)
    }
}

impl<T: Float> Core<T> {
    /// One step of size `h` from `y` at time `t` into `next`. `y` is not changed, whatever happens.
    ///
    /// # Errors
    /// [`Failure`] when the stages do not converge, however often the step is halved, and when an energy
    /// error would be left that is refused.
    pub fn step(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        (ready::<T>().step)(self, (y, t, h), next)
    }

    /// Finds the α_k of the step of size `h` from `y` at time `t` to `next` that was made last, with α_k
    /// [deferred](Self::defer_alphas): the two together are the step as it is without, to rounding.
    ///
    /// # Errors
    /// [`Failure`] as of [`step`](Self::step).
    pub fn complete(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        (ready::<T>().complete)(self, (y, t, h), next)
    }
}
