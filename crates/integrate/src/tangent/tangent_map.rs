//! [`TangentMap`]: how a small deviation moves along a run.
//!
//! The variational equations solved by the step itself ([`StepTangent`]): the derivative of the step, a
//! symplectic map to rounding where α = 0. Where α conserves the energy, deviations conserve ∇H·δ, as exact
//! ones do; where it conserves further invariants too, the derivative is that at fixed α.

use crate::error::IntegrateError;
use crate::steppers::integration::Integration;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Failure, StepTangent};

/// The tangent map along a run.
///
/// A deviation has 2m components, those of (q, p). Where H depends on time it has 2m + 2, those of
/// (q, t, p, p_t): that of t is one of the time at which the run starts.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::{Equip, TangentMap};
///
/// let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0]))?;
/// let mut run = Equip::stages(4).step(0.1).start(&oscillator, &[1.0], &[0.0], 0.0)?;
/// let mut tangent = TangentMap::new(&oscillator, &mut run);
/// // The columns of the identity: (∂q, ∂p)/∂q0, then (∂q, ∂p)/∂p0.
/// let mut columns = vec![1.0, 0.0, 0.0, 1.0];
/// tangent.advance_to(&mut run, 1.0, &mut columns)?;
/// assert!((columns[0] - 1f64.cos()).abs() < 1e-14 && (columns[1] + 1f64.sin()).abs() < 1e-14);
///
/// // The same step by step.
/// run.advance()?;
/// tangent.propagate(&run, &mut columns)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TangentMap<T: Float> {
    step: StepTangent<T>,
    /// Number of the step up to which deviations were propagated.
    propagated: u64,
}

impl<T: Float> TangentMap<T> {
    /// Follows `run` from its next step on.
    pub(crate) fn of(system: &Hamiltonian, run: &mut Integration<T>) -> Self {
        run.core.keep_parts();
        TangentMap {
            step: StepTangent::new(system, &run.core),
            propagated: run.index,
        }
    }

    /// Propagates `deviations`, one after the other, over the step that `run` made last.
    pub(crate) fn propagate_over(
        &mut self,
        run: &Integration<T>,
        deviations: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        let n = self.step.components();
        assert_eq!(deviations.len() % n, 0, "a deviation has 2m components");
        self.check_followed(run, 1)?;
        self.propagated = run.index;
        for part in run.parts() {
            self.step.linearise(part);
            for deviation in deviations.chunks_exact_mut(n) {
                let propagated = self.step.propagate(deviation);
                let (time, step, halvings) = (part.time, part.h, 0);
                propagated.map_err(|failure| match failure {
                    Failure::NotFinite => IntegrateError::NotFinite {
                        time,
                        step,
                        halvings,
                    },
                    _ => IntegrateError::Singular {
                        time,
                        step,
                        halvings,
                    },
                })?;
            }
        }
        Ok(())
    }

    /// Whether the run has made no more than so many steps since deviations were last propagated, or since it
    /// was begun anew.
    pub(crate) fn check_followed(
        &self,
        run: &Integration<T>,
        most: u64,
    ) -> Result<(), IntegrateError<T>> {
        let made = run.index;
        let steps = made.checked_sub(self.propagated).unwrap_or(made);
        if steps > most {
            return Err(IntegrateError::StepsNotFollowed { steps });
        }
        Ok(())
    }
}
