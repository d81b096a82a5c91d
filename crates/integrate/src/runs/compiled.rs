//! The functions compiled once with this crate for `f64` and double-double ([`equip_scalar::ready!`]):
//! starting, stepping, resuming and completing a run take one call each.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::integrator::Integrator;
use crate::runs::observer::Observer;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use crate::steppers::view::{Step, StepView};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// The functions by name.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
pub(crate) struct Ready<T: Float> {
    pub(crate) make: fn(&Integrator<T>, &Hamiltonian) -> Result<Stepper<T>, IntegrateError<T>>,
    pub(crate) begin: fn(&mut Stepper<T>, (&[T], &[T]), T, Option<T>) -> Result<(), IntegrateError<T>>,
    resume: fn(&Integrator<T>, &Hamiltonian, &Checkpoint) -> Result<Stepper<T>, IntegrateError<T>>,
    pub(crate) run: fn(&Integrator<T>, &Hamiltonian, &mut Stepper<T>, (T, Option<&Checkpoint>), &mut dyn Observer<T>) -> Result<Run<T>, RunFailure<T>>,
    advance: fn(&mut Stepper<T>) -> Result<(), IntegrateError<T>>,
    advance_to: fn(&mut Stepper<T>, T) -> Result<(), IntegrateError<T>>,
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        make: Stepper::prepare,
        begin: Stepper::begin,
        resume: Stepper::resume,
        run: Integrator::run,
        advance: |steps| steps.control.step(&mut steps.inner, false),
        advance_to,
    };
}

equip_scalar::ready!(Ready);

fn advance_to<T: Float>(steps: &mut Stepper<T>, t: T) -> Result<(), IntegrateError<T>> {
    while steps.advance_towards(t)? {}
    Ok(())
}

impl<T: Float> Integrator<T> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, without a step. The run goes forward in
    /// time, or backward if its step is negative. `advance_to` and `turn_back` of the stepper change the
    /// direction.
    ///
    /// # Errors
    /// Invalid options, steps or initial values, or H not finite at the start.
    pub fn start(
        &self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<Stepper<T>, IntegrateError<T>> {
        self.start_towards(system, (q0, p0), t0, None)
    }

    /// The same in the direction of the time `towards`, if it is known.
    pub(crate) fn start_towards(
        &self,
        system: &Hamiltonian,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<Stepper<T>, IntegrateError<T>> {
        let mut stepper = (ready::<T>().make)(self, system)?;
        (ready::<T>().begin)(&mut stepper, start, t0, towards)?;
        Ok(stepper)
    }

    /// Resumes the run of `checkpoint` at the step of the checkpoint. The run continues bit for bit as if it
    /// had not been interrupted.
    ///
    /// # Errors
    /// The checkpoint was made in another floating-point type, with another method, other options or another
    /// H, or is damaged; also the errors of [`start`](Self::start).
    pub fn resume(
        &self,
        system: &Hamiltonian,
        checkpoint: &Checkpoint,
    ) -> Result<Stepper<T>, IntegrateError<T>> {
        (ready::<T>().resume)(self, system, checkpoint)
    }
}

impl<T: Float> Stepper<T> {
    /// Makes the next step in the direction of the run: forward in time, or backward if its fixed step is
    /// negative or it was [turned back](Self::turn_back).
    ///
    /// # Errors
    /// If the step fails. The state is then the one before the step; it may be read, and the step may be
    /// tried again.
    pub fn advance(&mut self) -> Result<StepView<'_, T>, IntegrateError<T>> {
        (ready::<T>().advance)(self)?;
        Ok(self.view())
    }

    /// Advances to the time `t`, forward or backward; the last step ends exactly at `t`. Fixed steps are on
    /// the grid, with a shorter one if `t` is not a point of the grid; the grid then begins anew at `t`. If
    /// the run is at `t` already, no step is made.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::Equip;
    ///
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let mut run = Equip::stages(6).step(0.1).start(&pendulum, &[1.0], &[0.5], 0.0)?;
    /// assert_eq!(run.advance_to(2.345)?.time, 2.345);
    /// let back = run.advance_to(0.0)?;
    /// assert!((back.q[0] - 1.0).abs() < 1e-13 && (back.p[0] - 0.5).abs() < 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A time that is not finite, or a step that fails. The run is then at the end of the last successful
    /// step.
    pub fn advance_to(&mut self, t: T) -> Result<StepView<'_, T>, IntegrateError<T>> {
        (ready::<T>().advance_to)(self, t)?;
        Ok(self.view())
    }
}

impl<T: Float> Iterator for Stepper<T> {
    type Item = Result<Step<T>, IntegrateError<T>>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.advance().map(|view| view.to_step()))
    }
}
