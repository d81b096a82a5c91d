//! Hand-written gradients, held against automatic differentiation.

use crate::BuildError;
use equip_scalar::Float;

/// Components may differ by √ε of the largest one: enough for any rounding, too little for a wrong term.
pub(crate) fn compare<T: Float>(given: &[T], expected: &[T]) -> Result<(), BuildError> {
    let size = |x: &T| x.abs();
    let largest = expected
        .iter()
        .map(size)
        .fold(T::int(0), |a, b| if b > a { b } else { a });
    let allowed = largest * T::EPSILON.sqrt();
    for (component, (&given, &expected)) in given.iter().zip(expected).enumerate() {
        let agrees = given == expected || size(&(given - expected)) <= allowed;
        if !agrees {
            return Err(BuildError::WrongGradient {
                component,
                given: given.to_f64(),
                expected: expected.to_f64(),
            });
        }
    }
    Ok(())
}
