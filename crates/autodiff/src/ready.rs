//! What is compiled once, with this crate, by [`equip_scalar::ready!`]: all that replays recordings.

use crate::Kinetic;
use crate::recorded::{Recorded, RecordedEvaluator};
use equip_scalar::Float;

/// The functions: those of [`Evaluate`](crate::Evaluate), by their names there, and the bound alone.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
pub(crate) struct Ready<T: Float> {
    pub(crate) evaluator: fn(&Recorded) -> RecordedEvaluator<T>,
    pub(crate) value: fn(&mut RecordedEvaluator<T>, &[T]) -> T,
    pub(crate) compensated_value: fn(&mut RecordedEvaluator<T>, &[T]) -> T,
    pub(crate) gradient_with_bound: fn(&mut RecordedEvaluator<T>, &[T], &mut [T]) -> (T, T),
    pub(crate) bound: fn(&mut RecordedEvaluator<T>, &[T]) -> T,
    pub(crate) gradients: fn(&mut RecordedEvaluator<T>, &[T], &mut [T], usize),
    pub(crate) gradients_by_component: fn(&mut RecordedEvaluator<T>, &[T], &mut [T], usize, usize),
    pub(crate) forces_by_component: fn(&mut RecordedEvaluator<T>, &[T], &mut [T], usize, usize),
    pub(crate) kinetic: fn(&mut RecordedEvaluator<T>) -> Option<Kinetic<T>>,
    pub(crate) hessian_vector: fn(&mut RecordedEvaluator<T>, &[T], &[T], &mut [T]),
    pub(crate) hessian: fn(&mut RecordedEvaluator<T>, &[T], &mut [T]),
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        evaluator: RecordedEvaluator::new,
        value: RecordedEvaluator::value_at,
        compensated_value: RecordedEvaluator::compensated_value_at,
        gradient_with_bound: RecordedEvaluator::gradient_with_bound_at,
        bound: RecordedEvaluator::bound_at,
        gradients: RecordedEvaluator::gradients_at,
        gradients_by_component: RecordedEvaluator::gradients_of,
        forces_by_component: RecordedEvaluator::forces_of,
        kinetic: RecordedEvaluator::kinetic_energy,
        hessian_vector: RecordedEvaluator::hessian_times,
        hessian: RecordedEvaluator::hessian_at,
    };
}

equip_scalar::ready!(Ready);
