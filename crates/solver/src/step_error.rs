//! What a step that was not found is called outside.

use crate::error::IntegrateError;
use crate::escape::escapes;
use crate::newton::Failure;
use crate::state::State;
use crate::step::Core;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// The error of a step of size `step` from `y`.
    pub(crate) fn error(
        &mut self,
        failure: Failure<T>,
        y: &State<T>,
        time: T,
        step: T,
    ) -> IntegrateError<T> {
        let halvings = self.settings.max_halvings;
        let unsolved = matches!(
            failure,
            Failure::NotFinite | Failure::NoConvergence { .. } | Failure::Astray { .. }
        );
        if unsolved && let Some(size) = escapes(&mut self.energy, &y.hi, step) {
            return IntegrateError::Escape { time, step, size };
        }
        match failure {
            Failure::NotFinite => IntegrateError::NotFinite {
                time,
                step,
                halvings,
            },
            Failure::Singular => IntegrateError::Singular {
                time,
                step,
                halvings,
            },
            Failure::Astray { defect, scale } => IntegrateError::Astray {
                time,
                step,
                defect,
                scale,
            },
            Failure::NoConvergence {
                iterations,
                correction,
            } => IntegrateError::NoConvergence {
                time,
                step,
                halvings,
                iterations,
                correction,
            },
            Failure::NoAlpha | Failure::Unresolved => {
                let mut worst = (T::int(0), T::int(0));
                for c in &self.constraints {
                    if c.in_floors() > T::int(1) {
                        worst = (c.defect, c.floor);
                    }
                }
                IntegrateError::NoAdmissibleAlpha {
                    time,
                    step,
                    defect: worst.0,
                    floor: worst.1,
                }
            }
        }
    }
}
