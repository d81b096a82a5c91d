//! The functions compiled once with this crate for `f64` and double-double: the step and its tangent map
//! ([`equip_scalar::ready!`]).

use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::outcome::parts::Part;
use crate::step::core::Core;
use crate::step_tangent::StepTangent;
use equip_iterate::State;
use equip_scalar::Float;

/// The functions by name.
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
    /// Linearises the stage equations of `part`. Costs s Hessians.
    pub fn linearise(&mut self, part: &Part<T>) {
        (ready::<T>().linearise)(self, part);
    }

    /// Propagates `tangent_vector`, n components, over the linearised part.
    ///
    /// # Errors
    /// [`Failure::NotFinite`] or [`Failure::Singular`] if the linearised stage equations cannot be solved.
    pub fn propagate(&mut self, tangent_vector: &mut [T]) -> Result<(), Failure<T>> {
        (ready::<T>().propagate)(self, tangent_vector)
    }
}

impl<T: Float> Core<T> {
    /// One step of size `h` from `y` at time `t` to `next`. `y` does not change, even on failure.
    ///
    /// # Errors
    /// [`Failure`] if the stages do not converge although the step was halved, or if an uncorrected step is
    /// rejected.
    pub fn step(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        (ready::<T>().step)(self, (y, t, h), next)
    }

    /// Computes the α_k of the last step, of size `h` from `y` at time `t` to `next`, if they were
    /// [deferred](Self::defer_alphas). Up to rounding, the two calls together are one step without deferral.
    ///
    /// # Errors
    /// [`Failure`] as for [`step`](Self::step).
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
