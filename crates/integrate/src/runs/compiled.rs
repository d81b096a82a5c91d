//! What is compiled once, with this crate, for `f64` and double-double ([`equip_scalar::ready!`]): a run is
//! started, stepped, resumed and made as a whole by one call each.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::adaptive::Tolerance;
use crate::options::fixed_step::Fixed;
use crate::options::integrator::Integrator;
use crate::runs::observer::Observer;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::adaptive::adaptive_stepper::AdaptiveStepper;
use crate::steppers::sizes::{Advance, Sizes};
use crate::steppers::stepper::Stepper;
use crate::steppers::view::StepView;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// The functions of runs whose steps are sized by `S`, each as it is called.
#[doc(hidden)]
#[rustfmt::skip]
#[allow(clippy::type_complexity, missing_debug_implementations)] // Signatures are what they are.
pub struct Entries<T: Float, S: Sizes<T>> {
    pub(crate) make: fn(&Integrator<T, S>, &Hamiltonian) -> Result<S::Stepper, IntegrateError<T>>,
    pub(crate) begin: fn(&mut S::Stepper, (&[T], &[T]), T, Option<T>) -> Result<(), IntegrateError<T>>,
    resume: fn(&Integrator<T, S>, &Hamiltonian, &Checkpoint) -> Result<S::Stepper, IntegrateError<T>>,
    pub(crate) run: fn(&Integrator<T, S>, &Hamiltonian, &mut S::Stepper, (T, Option<&Checkpoint>), &mut dyn Observer<T>) -> Result<Run<T>, RunFailure<T>>,
    advance: fn(&mut S::Stepper) -> Result<(), IntegrateError<T>>,
    advance_to: fn(&mut S::Stepper, T) -> Result<(), IntegrateError<T>>,
}

impl<T: Float, S: Sizes<T>> Entries<T, S> {
    const HERE: Self = Entries {
        make: S::stepper,
        begin: S::Stepper::begin,
        resume: Integrator::resumed,
        run: Integrator::run,
        advance: S::Stepper::go_on,
        advance_to,
    };
}

fn advance_to<T: Float>(steps: &mut impl Advance<T>, t: T) -> Result<(), IntegrateError<T>> {
    while steps.step_towards(t)? {}
    Ok(())
}

struct Ready<T: Float> {
    fixed: Entries<T, Fixed<T>>,
    tolerance: Entries<T, Tolerance<T>>,
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        fixed: Entries::HERE,
        tolerance: Entries::HERE,
    };
}

equip_scalar::ready!(Ready);

/// How an [`Integrator`] sizes its steps: [`Fixed`] or [`Tolerance`].
pub trait StepSizes<T: Float>: Sizes<T> {
    /// The functions of its runs.
    #[doc(hidden)]
    fn entries() -> &'static Entries<T, Self>;
}

impl<T: Float> StepSizes<T> for Fixed<T> {
    fn entries() -> &'static Entries<T, Self> {
        &ready::<T>().fixed
    }
}

impl<T: Float> StepSizes<T> for Tolerance<T> {
    fn entries() -> &'static Entries<T, Self> {
        &ready::<T>().tolerance
    }
}

impl<T: Float, S: StepSizes<T>> Integrator<T, S> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, without making a step. It goes forward
    /// in time, back if its step is negative, and either way by `advance_to` and `turn_back` of what makes
    /// its steps.
    ///
    /// # Errors
    /// Every fault of options, steps and initial values, and an H that is not finite at the start.
    pub fn start(
        &self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<S::Stepper, IntegrateError<T>> {
        self.start_towards(system, (q0, p0), t0, None)
    }

    /// The same, to go `towards` a time if that is known.
    pub(crate) fn start_towards(
        &self,
        system: &Hamiltonian,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<S::Stepper, IntegrateError<T>> {
        let mut stepper = (S::entries().make)(self, system)?;
        (S::entries().begin)(&mut stepper, start, t0, towards)?;
        Ok(stepper)
    }

    /// The run that `checkpoint` was made of, at the step where it was made. Bit for bit the same as if it
    /// had not stopped.
    ///
    /// # Errors
    /// When the checkpoint was made in another float type, with another method, other options or another H,
    /// or is damaged; every fault of [`start`](Self::start).
    pub fn resume(
        &self,
        system: &Hamiltonian,
        checkpoint: &Checkpoint,
    ) -> Result<S::Stepper, IntegrateError<T>> {
        (S::entries().resume)(self, system, checkpoint)
    }
}

impl<T: Float> Stepper<T> {
    /// Makes the next step.
    ///
    /// # Errors
    /// When the step cannot be made; the state then is that before the step, and may be read or stepped
    /// again.
    pub fn advance(&mut self) -> Result<StepView<'_, T>, IntegrateError<T>> {
        (Fixed::entries().advance)(self)?;
        Ok(self.view())
    }

    /// Goes to the time `t`, forward or back: steps of the grid, and a shorter one that ends at `t` if that
    /// is none of its points. The grid then begins anew there. At `t` already, no step is made.
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
    /// A time that is not finite, and a step that cannot be made; the run then is where the last good one
    /// ended.
    pub fn advance_to(&mut self, t: T) -> Result<StepView<'_, T>, IntegrateError<T>> {
        (Fixed::entries().advance_to)(self, t)?;
        Ok(self.view())
    }
}

impl<T: Float> AdaptiveStepper<T> {
    /// Makes the next step, of the size that control proposes, the way the run goes: forward in time, unless
    /// it was [turned back](Self::turn_back).
    ///
    /// # Errors
    /// When no step above the smallest size can be made; the state then is that before the step.
    pub fn advance(&mut self) -> Result<StepView<'_, T>, IntegrateError<T>> {
        (Tolerance::entries().advance)(self)?;
        Ok(self.view())
    }

    /// Goes to the time `t`, forward or back, which the last step meets exactly. At `t` already, no step is
    /// made.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::Equip;
    ///
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let mut run = Equip::stages(6).tolerance(1e-12).start(&pendulum, &[1.0], &[0.5], 0.0)?;
    /// for t in [1.0, 2.5, -4.0, 0.0] {
    ///     assert_eq!(run.advance_to(t)?.time, t);
    /// }
    /// assert!((run.view().q[0] - 1.0).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A time that is not finite, and those of [`advance`](Self::advance); the run then is where the last
    /// good step ended.
    pub fn advance_to(&mut self, t: T) -> Result<StepView<'_, T>, IntegrateError<T>> {
        (Tolerance::entries().advance_to)(self, t)?;
        Ok(self.view())
    }
}
