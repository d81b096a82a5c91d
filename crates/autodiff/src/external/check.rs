//! Checks of user-supplied gradients against the energy.

use crate::BuildError;
use equip_scalar::Float;

/// A component of a user-supplied gradient that differs from the derivative of the energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrongGradient<T> {
    /// The component of (∂H/∂q, ∂H/∂p), counted from 0.
    pub component: usize,
    /// The component of the user-supplied gradient.
    pub given: T,
    /// The derivative of the energy.
    pub expected: T,
}

impl<T: Float> From<WrongGradient<T>> for BuildError {
    fn from(wrong: WrongGradient<T>) -> Self {
        BuildError::WrongGradient {
            component: wrong.component,
            given: wrong.given.to_f64(),
            expected: wrong.expected.to_f64(),
        }
    }
}

/// Compares two gradients. Components may differ by √ε of the largest one: more than rounding, less than a
/// wrong term.
pub(crate) fn compare<T: Float>(given: &[T], expected: &[T]) -> Result<(), WrongGradient<T>> {
    let allowed = largest(expected) * T::EPSILON.sqrt();
    for (component, (&given, &expected)) in given.iter().zip(expected).enumerate() {
        let agrees = given == expected || (given - expected).abs() <= allowed;
        if !agrees {
            return Err(WrongGradient {
                component,
                given,
                expected,
            });
        }
    }
    Ok(())
}

/// `check` at `y`, and if it fails there, at a nearby point: at a discontinuity of a derivative of H the
/// derivative of either side is correct, and differences are those of neither.
pub(crate) fn at_or_near<T: Float>(
    y: &[T],
    mut check: impl FnMut(&[T]) -> Result<(), WrongGradient<T>>,
) -> Result<(), WrongGradient<T>> {
    let Err(wrong) = check(y) else {
        return Ok(());
    };
    check(&near(y)).map_err(|_| wrong)
}

/// A point near `y`. Each component changes by about ⁴√ε of itself, or of the largest component of its half
/// if it is 0. No two components change by the same share, so that equal ones become different.
fn near<T: Float>(y: &[T]) -> Vec<T> {
    let share = T::EPSILON.sqrt().sqrt();
    let moved = y.chunks_exact(y.len() / 2).flat_map(|half| {
        let of = largest(half);
        let of = if of > T::int(0) { of } else { T::int(1) };
        half.iter().enumerate().map(move |(i, &y)| {
            let size = if y == T::int(0) { of } else { y };
            let golden = (0.618_033_988_75 * (i + 1) as f64).fract();
            y + share * T::exact(0.5 + golden) * size
        })
    });
    moved.collect()
}

/// The number of step sizes of the differences, each a 16th of the previous one.
const LEVELS: u32 = 4;

/// Compares a user-supplied gradient at `y`, with the running error bound of H, with differences of `value`,
/// whose relative error is `accuracy`.
///
/// Two central differences with steps δ and 2δ give the derivative and a bound of its error: 16 times their
/// difference, 16 times the rounding of H over δ, and ⁴√ε of the largest component. A component is wrong if
/// it differs by more than this bound for every δ from ⁴√accuracy of the component down to a 4096th of that,
/// as far as rounding permits. It is also wrong if it is not finite although H is. The check is coarser than
/// a comparison with the exact derivative. It allocates.
pub(crate) fn by_differences<T: Float>(
    y: &[T],
    (given, bound): (&[T], T),
    accuracy: f64,
    mut value: impl FnMut(&[T]) -> T,
) -> Result<(), WrongGradient<T>> {
    let (m, two, many) = (y.len() / 2, T::int(2), T::int(16));
    let share = T::EPSILON.sqrt().sqrt();
    let largest_derivative = largest(given);
    let mut point = y.to_vec();
    for (component, &given) in given.iter().enumerate() {
        let half = if component < m { &y[..m] } else { &y[m..] };
        let of = [y[component].abs(), largest(half), T::int(1)];
        let size = of.into_iter().find(|&x| x > T::int(0));
        let mut difference = |delta: T| {
            point[component] = y[component] + delta;
            let ahead = value(&point);
            point[component] = y[component] - delta;
            let behind = value(&point);
            point[component] = y[component];
            (ahead - behind) / (two * delta)
        };
        let mut delta = T::exact(accuracy).sqrt().sqrt() * size.unwrap_or(T::int(1));
        let mut wrong = None;
        for _ in 0..LEVELS {
            let rounding = many * (T::EPSILON * bound / delta);
            let tells = |fine: T| (given - fine).abs() > rounding;
            if wrong.is_some_and(|fine| !tells(fine)) {
                break;
            }
            let (fine, coarse) = (difference(delta), difference(two * delta));
            if !given.is_finite() && fine.is_finite() {
                wrong = Some(fine);
                break;
            }
            let trusted = many * (fine - coarse).abs() + rounding + share * largest_derivative;
            if !((given - fine).abs() > trusted) {
                wrong = None;
                break;
            }
            wrong = Some(fine);
            delta /= many;
        }
        if let Some(expected) = wrong {
            return Err(WrongGradient {
                component,
                given,
                expected,
            });
        }
    }
    Ok(())
}

/// The largest absolute value.
pub(crate) fn largest<T: Float>(values: &[T]) -> T {
    let sizes = values.iter().map(|x| x.abs());
    sizes.fold(T::int(0), |a, b| if b > a { b } else { a })
}
