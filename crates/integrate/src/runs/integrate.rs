//! Complete runs over an interval, with steps of any kind.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::options::integrator::Integrator;
use crate::runs::compiled::ready;
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::run::{Run, RunFailure};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use std::ops::RangeInclusive;

impl<T: Float> Integrator<T> {
    /// Integrates from (`q0`, `p0`), each of length m, over `interval`: forward in time, or backward if its
    /// end precedes its start.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::Equip;
    ///
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let options = Equip::stages(6).tolerance(1e-12);
    /// let there = options.integrate(&pendulum, &[1.0], &[0.5], 0.0..=10.0)?;
    /// let (t, q, p) = there.last();
    /// let back = options.integrate(&pendulum, q, p, t..=0.0)?;
    /// assert!((back.last().1[0] - 1.0).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Fixed steps are on the grid t0 + n h, with a shorter last step if h does not divide the interval.
    /// Variable steps meet the end; two equal steps replace a step that would leave a very short remainder.
    ///
    /// # Errors
    /// [`RunFailure`], which contains the part of the run up to the failure.
    pub fn integrate(
        &self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        self.integrate_observed(system, q0, p0, interval, &mut NoObserver)
    }

    /// The same with an observer, which sees every step and may end the run.
    ///
    /// # Errors
    /// [`RunFailure`], which contains the part of the run up to the failure.
    pub fn integrate_observed(
        &self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let (t0, t1) = interval.into_inner();
        self.options.check_times(t0, t1)?;
        let mut stepper = self.start_towards(system, (q0, p0), t0, Some(t1))?;
        (ready::<T>().run)(self, system, &mut stepper, (t1, None), observer)
    }

    /// Resumes the run of `checkpoint` to the time `end`. The returned run begins at the checkpoint; its
    /// certificate covers the complete run. The steps agree bit for bit with those of a run without
    /// interruption, except for the last two variable steps, which meet the end. A checkpoint made after
    /// those two continues with other steps.
    ///
    /// # Errors
    /// The errors of [`resume`](Self::resume), a checkpoint that is not on the grid of fixed steps, and
    /// [`RunFailure`].
    pub fn integrate_from(
        &self,
        system: &Hamiltonian,
        checkpoint: &Checkpoint,
        end: T,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let mut stepper = self.resume(system, checkpoint)?;
        (ready::<T>().run)(
            self,
            system,
            &mut stepper,
            (end, Some(checkpoint)),
            observer,
        )
    }
}
