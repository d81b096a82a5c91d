//! The integrator of a run, from its options.

use equip_integrate::{
    Checkpoint, Equip, Gauss, Integrator, Method, Observer, Record, Run, RunFailure,
};
use equip_scalar::Float;
use equip_scenes::Instance;

/// The method EQUIP or Gauss.
pub(crate) fn equip_or_gauss(is_equip: bool, stages: usize) -> Method {
    match is_equip {
        true => Equip::stages(stages),
        false => Gauss::stages(stages),
    }
}

/// Of `method`, with this tolerance or else this fixed step.
pub(crate) fn integrator<T: Float>(method: Method, tolerance: Option<T>, step: T) -> Integrator<T> {
    let made = match tolerance {
        Some(tolerance) => method.tolerance(tolerance),
        None => method.step(step),
    };
    made.record(Record::Ends)
}

/// A run from the scene's initial state at time 0, or from the checkpoint, to `end`.
pub(crate) fn integrate<T: Float>(
    integrator: &Integrator<T>,
    instance: &Instance,
    from: Option<&Checkpoint>,
    end: T,
    observer: &mut impl Observer<T>,
) -> Result<Run<T>, RunFailure<T>> {
    let h = instance.hamiltonian();
    let (q, p) = instance.initial::<T>();
    match from {
        None => integrator.integrate_observed(h, &q, &p, T::int(0)..=end, observer),
        Some(from) => {
            from.check_start(&q, &p, T::int(0))?;
            integrator.integrate_from(h, from, end, observer)
        }
    }
}
