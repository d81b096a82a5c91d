//! [`Prepared`]: everything about a run that does not depend on its initial state, computed once for many
//! runs.

use crate::error::IntegrateError;
use crate::options::integrator::Integrator;
use crate::runs::compiled::ready;
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use std::ops::RangeInclusive;

/// A method with its options, prepared for one Hamiltonian: tables, workspace and machine code exist, and
/// runs can be started from any number of initial states.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::Equip;
///
/// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
/// let mut prepared = Equip::stages(4).step(0.1).prepare(&pendulum)?;
/// for momentum in [0.5, 1.0, 1.5] {
///     let run = prepared.start(&[0.0], &[momentum], 0.0)?;
///     for _ in 0..100 {
///         run.advance()?;
///     }
///     assert!(run.certificate().energy_conserved_on_every_step());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Prepared<T: Float> {
    integrator: Integrator<T>,
    system: Hamiltonian,
    stepper: Stepper<T>,
}

impl<T: Float> Integrator<T> {
    /// Prepares everything that does not depend on the initial state.
    ///
    /// # Errors
    /// Invalid options and steps.
    pub fn prepare(&self, system: &Hamiltonian) -> Result<Prepared<T>, IntegrateError<T>> {
        Ok(Prepared {
            stepper: (ready::<T>().make)(self, system)?,
            integrator: self.clone(),
            system: system.clone(),
        })
    }
}

impl<T: Float> Prepared<T> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, and returns its stepper. The steps agree
    /// bit for bit with those of [`Integrator::start`]. Costs less than two steps, and allocates nothing.
    ///
    /// # Errors
    /// Invalid initial values, or H not finite at the initial state.
    pub fn start(
        &mut self,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<&mut Stepper<T>, IntegrateError<T>> {
        (ready::<T>().begin)(&mut self.stepper, (q0, p0), t0, None)?;
        Ok(&mut self.stepper)
    }

    /// Integrates from (`q0`, `p0`), each of length m, over `interval`; see [`Integrator::integrate`].
    ///
    /// # Errors
    /// [`RunFailure`], which contains the part of the run up to the failure.
    pub fn integrate(
        &mut self,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        self.integrate_observed(q0, p0, interval, &mut NoObserver)
    }

    /// The same with an observer, which sees every step and may end the run.
    ///
    /// # Errors
    /// [`RunFailure`], which contains the part of the run up to the failure.
    pub fn integrate_observed(
        &mut self,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let (t0, t1) = interval.into_inner();
        self.integrator.options.check_times(t0, t1)?;
        (ready::<T>().begin)(&mut self.stepper, (q0, p0), t0, Some(t1))?;
        let (system, stepper) = (&self.system, &mut self.stepper);
        (ready::<T>().run)(&self.integrator, system, stepper, (t1, None), observer)
    }
}
