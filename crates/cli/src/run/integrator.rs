//! [`Integrator`]: fixed or variable steps, as the user asked, behind one set of verbs.

use equip_integrate::{
    Adaptive, Checkpoint, FixedStep, Invariant, Method, Observer, Reach, Record, Run, RunFailure,
};
use equip_scalar::Float;
use equip_scenes::Instance;

#[derive(Debug)]
pub(crate) enum Integrator<T: Float> {
    Fixed(FixedStep<T>),
    Variable(Adaptive<T>),
}

impl<T: Float> Integrator<T> {
    /// Of `method`, with this tolerance or else this fixed step.
    pub(crate) fn new(method: Method, tolerance: Option<T>, step: T) -> Self {
        match tolerance {
            Some(tolerance) => {
                Integrator::Variable(method.tolerance(tolerance).record(Record::Ends))
            }
            None => Integrator::Fixed(method.step(step).record(Record::Ends)),
        }
    }

    pub(crate) fn reach(self, choice: Reach) -> Self {
        match self {
            Integrator::Fixed(x) => Integrator::Fixed(x.reach(choice)),
            Integrator::Variable(x) => Integrator::Variable(x.reach(choice)),
        }
    }

    pub(crate) fn invariant(self, invariant: Invariant) -> Self {
        match self {
            Integrator::Fixed(x) => Integrator::Fixed(x.invariant(invariant)),
            Integrator::Variable(x) => Integrator::Variable(x.invariant(invariant)),
        }
    }

    pub(crate) fn chaos(self) -> Self {
        match self {
            Integrator::Fixed(x) => Integrator::Fixed(x.chaos()),
            Integrator::Variable(x) => Integrator::Variable(x.chaos()),
        }
    }

    /// The same, with dense output and all steps kept.
    pub(crate) fn dense(self) -> Self {
        match self {
            Integrator::Fixed(x) => Integrator::Fixed(x.dense().record(Record::All)),
            Integrator::Variable(x) => Integrator::Variable(x.dense().record(Record::All)),
        }
    }

    /// From the scene's start at time 0, or from the checkpoint, to `end`.
    pub(crate) fn integrate(
        &self,
        instance: &Instance,
        from: Option<&Checkpoint>,
        end: T,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let h = instance.hamiltonian();
        let (q, p) = instance.initial::<T>();
        let interval = T::int(0)..=end;
        if let Some(from) = from {
            from.check_start(&q, &p, T::int(0))?;
        }
        match (self, from) {
            (Integrator::Fixed(x), None) => x.integrate_observed(h, &q, &p, interval, observer),
            (Integrator::Fixed(x), Some(from)) => x.integrate_from(h, from, end, observer),
            (Integrator::Variable(x), None) => x.integrate_observed(h, &q, &p, interval, observer),
            (Integrator::Variable(x), Some(from)) => x.integrate_from(h, from, end, observer),
        }
    }
}
