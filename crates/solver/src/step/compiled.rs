//! What is compiled once, with this crate: the step of recorded energies and its tangent map, in `f64` and
//! double-double ([`equip_scalar::ready!`]). The step of an energy that is a type is compiled with that.

use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::outcome::parts::Part;
use crate::step::core::Core;
use crate::step_tangent::StepTangent;
use equip_autodiff::{Evaluate, Holds, RecordedEvaluator};
use equip_scalar::Float;
use equip_sweeps::State;
use std::marker::PhantomData;

/// A core with the evaluator of a recording.
type Recorded<T> = Core<T, RecordedEvaluator<T>>;

/// The function, as it is called.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
struct Ready<T: Float> {
    step: fn(&mut Recorded<T>, (&State<T>, T, T), &mut State<T>) -> Result<Outcome, Failure<T>>,
    complete: fn(&mut Recorded<T>, (&State<T>, T, T), &mut State<T>) -> Result<Outcome, Failure<T>>,
    linearise: fn(&mut StepTangent<T, RecordedEvaluator<T>>, &Part<T>),
    propagate: fn(&mut StepTangent<T, RecordedEvaluator<T>>, &mut [T]) -> Result<(), Failure<T>>,
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        step: Core::make,
        complete: Core::make_complete,
        linearise: StepTangent::make,
        propagate: StepTangent::propagate,
    };
}

equip_scalar::ready!(Ready);

/// A core with an evaluator of any type.
struct InCore<T>(PhantomData<T>);

impl<'a, T: Float> Holds<'a> for InCore<T> {
    type With<E: 'a> = &'a mut Core<T, E>;
}

/// A tangent map with an evaluator of any type.
struct InTangent<T>(PhantomData<T>);

impl<'a, T: Float> Holds<'a> for InTangent<T> {
    type With<E: 'a> = &'a mut StepTangent<T, E>;
}

impl<T: Float, E: Evaluate<T>> StepTangent<T, E> {
    /// Takes the linearised stage equations of `part`. Costs s Hessians.
    pub fn linearise(&mut self, part: &Part<T>) {
        if const { E::IS_RECORDED } {
            (ready::<T>().linearise)(E::recorded::<InTangent<T>>(self), part);
        } else {
            self.make(part);
        }
    }

    /// Carries `deviation`, n components, over the part that has been linearised.
    ///
    /// # Errors
    /// [`Failure::NotFinite`] or [`Failure::Singular`] if the linearised stages cannot be solved for.
    pub fn carry(&mut self, deviation: &mut [T]) -> Result<(), Failure<T>> {
        if const { E::IS_RECORDED } {
            (ready::<T>().propagate)(E::recorded::<InTangent<T>>(self), deviation)
        } else {
            self.propagate(deviation)
        }
    }
}

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// One step of size `h` from `y` at time `t` into `next`. `y` is not changed, whatever happens.
    ///
    /// # Errors
    /// [`Failure`] when the stages do not converge, however often the step is halved, and when a defect would
    /// be left that is refused.
    pub fn step(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        // Constant, so that nothing is compiled for recordings but the call.
        if const { E::IS_RECORDED } {
            (ready::<T>().step)(E::recorded::<InCore<T>>(self), (y, t, h), next)
        } else {
            self.make((y, t, h), next)
        }
    }

    /// Finds the α's of the step of size `h` from `y` at time `t` to `next` that was made last, with α's
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
        if const { E::IS_RECORDED } {
            (ready::<T>().complete)(E::recorded::<InCore<T>>(self), (y, t, h), next)
        } else {
            self.make_complete((y, t, h), next)
        }
    }
}
