//! [`TangentMap`]: the derivative of a run with respect to its initial state.
//!
//! The step itself solves the variational equation ([`StepTangent`]). With α = 0 the derivative of the step
//! is symplectic up to rounding. If α conserves the energy, tangent vectors conserve ∇H·δ, as those of the
//! exact flow do. If α conserves further invariants, the derivative is that at fixed α.

use crate::error::IntegrateError;
use crate::steppers::integration::Integration;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Failure, StepTangent};

/// The tangent map along a run.
///
/// A tangent vector has 2m components, those of (q, p). If H depends on time, it has 2m + 2 components, those
/// of (q, t, p, p_t); the component of t belongs to the initial time.
///
/// Steps by a tolerance follow the orbit alone. A tangent vector may contain faster motions: across a plane
/// of symmetry, or at an equilibrium. If
/// [`Certificate::motion_is_resolved`](crate::Certificate::motion_is_resolved) is false, tangent vectors are
/// wrong: limit the steps (`max_step`).
///
/// An event that changes the state changes tangent vectors too: multiply them by the derivative of the
/// change.
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
    /// The number of the step up to which tangent vectors have been propagated.
    propagated: u64,
}

impl<T: Float> TangentMap<T> {
    /// Follows `run` from its next step on.
    pub(crate) fn of(system: &Hamiltonian, run: &mut Integration<T>) -> Self {
        run.core.keep_parts();
        run.measured.has_tangent = true;
        TangentMap {
            step: StepTangent::new(system, &run.core),
            propagated: run.index,
        }
    }

    /// Propagates `tangent_vectors`, concatenated, over the last step of `run`.
    pub(crate) fn propagate_over(
        &mut self,
        run: &Integration<T>,
        tangent_vectors: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        let n = self.step.components();
        assert_eq!(
            tangent_vectors.len() % n,
            0,
            "a tangent vector has 2m components"
        );
        self.check_followed(run, 1)?;
        self.propagated = run.index;
        for part in run.parts() {
            self.step.linearise(part);
            for tangent_vector in tangent_vectors.chunks_exact_mut(n) {
                let propagated = self.step.propagate(tangent_vector);
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

    /// Checks that the run has made at most `most` steps since the last propagation or since it was
    /// restarted.
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
