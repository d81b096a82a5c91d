//! [`Prepared`]: everything of a run but its start, made once for many.

use crate::error::IntegrateError;
use crate::options::integrator::Integrator;
use crate::runs::compiled::ready;
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use std::ops::RangeInclusive;

/// A method with its options, ready for one Hamiltonian: tables, workspace and machine code are made, and
/// runs can be started from any number of states.
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
///     assert!(run.certificate().energy_kept_on_every_step());
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
    /// Makes everything ready that does not depend on where a run starts.
    ///
    /// # Errors
    /// Every fault of options and steps.
    pub fn prepare(&self, system: &Hamiltonian) -> Result<Prepared<T>, IntegrateError<T>> {
        Ok(Prepared {
            stepper: (ready::<T>().make)(self, system)?,
            integrator: self.clone(),
            system: system.clone(),
        })
    }
}

impl<T: Float> Prepared<T> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, and lends what makes its steps: those of
    /// [`Integrator::start`] bit for bit. Costs less than two steps and allocates nothing.
    ///
    /// # Errors
    /// Faults of the initial values, and an H that is not finite there.
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
    /// [`RunFailure`], which carries the part that was made.
    pub fn integrate(
        &mut self,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        self.integrate_observed(q0, p0, interval, &mut NoObserver)
    }

    /// The same, with an observer that sees every step and may end the run.
    ///
    /// # Errors
    /// [`RunFailure`], which carries the part that was made.
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
