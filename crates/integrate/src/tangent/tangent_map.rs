//! [`TangentMap`]: how a small deviation moves along a run.
//!
//! The variational equations solved by the step itself ([`StepTangent`]): the derivative of the step at fixed
//! α, a symplectic map to rounding. What the solved α adds, ∂α/∂y0, is of the size of the step's error and is
//! left out.

use crate::error::IntegrateError;
use crate::tangent::steps::Steps;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_solver::StepTangent;

/// The tangent map along a run.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::{Equip, TangentMap};
///
/// let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0]))?;
/// let mut run = Equip::stages(4).step(0.1).start(&oscillator, &[1.0], &[0.0], 0.0)?;
/// let mut tangent = TangentMap::new(&oscillator, &mut run);
/// let mut deviation = vec![1.0, 0.0];
/// for _ in 0..10 {
///     run.advance()?;
///     tangent.carry(&run, &mut deviation)?;
/// }
/// assert!((deviation[0] - 1f64.cos()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TangentMap<T: Float, E> {
    step: StepTangent<T, E>,
}

impl<T: Float, E: Evaluate<T>> TangentMap<T, E> {
    /// Follows `run`, made of the same `system`, from its next step on.
    pub fn new<H: System<Evaluator<T> = E>>(system: &H, run: &mut impl Steps<T, E>) -> Self {
        run.core_mut().keep_parts();
        TangentMap {
            step: StepTangent::new(system, run.core().gauss().clone()),
        }
    }

    /// Carries `deviations`, one after the other, each of length 2m, over the step that `run` made last.
    ///
    /// # Errors
    /// [`IntegrateError::Singular`] if the linearised stages cannot be solved for; the step could then not
    /// have been made by Newton's method either.
    ///
    /// # Panics
    /// When the length of `deviations` is no multiple of 2m.
    pub fn carry(
        &mut self,
        run: &impl Steps<T, E>,
        deviations: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        let n = self.step.components();
        assert_eq!(deviations.len() % n, 0, "a deviation has 2m components");
        for part in run.core().parts() {
            self.step.linearise(part);
            for deviation in deviations.chunks_exact_mut(n) {
                let carried = self.step.carry(deviation);
                carried.map_err(|_| IntegrateError::Singular {
                    time: part.time,
                    step: part.h,
                    halvings: 0,
                })?;
            }
        }
        Ok(())
    }
}
