//! Failures of a step in the form that a run returns.

use crate::control::escape::escapes;
use crate::error::IntegrateError;
use equip_autodiff::Evaluator;
use equip_scalar::Float;
use equip_solver::{Constraint, Core, Failure};

/// Checks a user-supplied gradient against H at `y` and time `t`.
pub(crate) fn check_gradient<T: Float>(
    energy: &mut Evaluator<T>,
    t: T,
    y: &[T],
) -> Result<(), IntegrateError<T>> {
    let m = y.len() / 2;
    energy.check_gradient(y).map_err(|wrong| {
        let is_force = wrong.component < m;
        IntegrateError::WrongGradient {
            time: t,
            what: if is_force { "q" } else { "p" },
            index: wrong.component % m,
            given: wrong.given,
            expected: wrong.expected,
        }
    })
}

/// The error of the step that has just failed.
pub(crate) fn error_of<T: Float>(core: &mut Core<T>, failure: Failure<T>) -> IntegrateError<T> {
    let part = core.failed_part();
    let (time, step, halvings) = (part.time, part.step, part.max_halvings);
    let unsolved = matches!(
        failure,
        Failure::NotFinite | Failure::NoConvergence { .. } | Failure::Astray { .. }
    );
    if unsolved {
        let start = part.start.clone();
        if let Some(size) = escapes(core.energy_mut(), &start, step) {
            return IntegrateError::Escape { time, step, size };
        }
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
        Failure::Astray { change, exchanged } => IntegrateError::Astray {
            time,
            step,
            change,
            exchanged,
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
        Failure::NoAlpha => {
            let beyond = |c: &&Constraint<T>| c.in_late_levels() > T::int(1);
            let last = core.constraints().iter().rfind(beyond);
            let (energy_error, round_off) = match last {
                Some(constraint) => (constraint.residual(), constraint.round_off()),
                None => (T::int(0), T::int(0)),
            };
            IntegrateError::NoAdmissibleAlpha {
                time,
                step,
                energy_error,
                round_off,
            }
        }
    }
}
