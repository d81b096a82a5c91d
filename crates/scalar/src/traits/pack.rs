//! [`Pack`]: N numbers of a float type that undergo the same operations.

use super::scalar::Scalar;
use crate::constant::Constant;

/// N numbers side by side, as operands of vector instructions, for generic code that applies the same
/// operations to many numbers.
///
/// Each number has the bits of a computation with that number alone. In memory the numbers are stored as `[T;
/// N]`.
///
/// ```
/// use equip_scalar::{DoubleDouble, Float, Pack, Scalar};
/// fn roots<T: Float>(x: &mut [T; 4]) {
///     T::Pack::<4>::sqrt(Pack::of(x)).store(x);
/// }
/// let mut x = [1, 4, 9, 16].map(DoubleDouble::int);
/// roots(&mut x);
/// assert_eq!(x, [1, 2, 3, 4].map(DoubleDouble::int));
/// ```
pub trait Pack<T: Scalar, const N: usize>: Scalar {
    /// The same number in every place.
    fn splat(x: T) -> Self;
    /// The numbers of an array.
    fn of(from: &[T; N]) -> Self;
    /// The numbers one by one.
    fn numbers(self) -> [T; N];
    /// The numbers as the nearest `f64`.
    fn heads(self) -> [f64; N];

    /// The first N numbers of a slice. Of a shorter one, which must not be empty, the last number fills the
    /// rest.
    #[inline(always)]
    fn load(from: &[T]) -> Self {
        match from.first_chunk::<N>() {
            Some(chunk) => Self::of(chunk),
            None => {
                let mut numbers = [from[from.len() - 1]; N];
                for (place, &x) in numbers.iter_mut().zip(from) {
                    *place = x;
                }
                Self::of(&numbers)
            }
        }
    }

    /// Writes the numbers to a slice; one shorter than N receives as many as it can hold.
    #[inline(always)]
    fn store(self, to: &mut [T]) {
        let numbers = self.numbers();
        match to.first_chunk_mut::<N>() {
            Some(chunk) => *chunk = numbers,
            None => {
                for (place, &x) in to.iter_mut().zip(&numbers) {
                    *place = x;
                }
            }
        }
    }

    /// The sum of all numbers of these packs, and what rounding it to one number has lost, so that both
    /// together are about as exact as sums with twice the digits. Half is added to half, so that the chain of
    /// additions is short.
    fn total(packs: &[[T; N]]) -> (T, T);

    /// Σ_j a(j)·b_j, in the order of j. Floats whose operations are cheap round every product and every sum;
    /// others compute the sum as accurately as that.
    #[inline(always)]
    fn dot(a: impl Fn(usize) -> Self, b: &[T]) -> Self {
        let mut terms = b.iter().enumerate();
        let Some((j, &b)) = terms.next() else {
            return zero::<T, Self, N>();
        };
        let mut sum = a(j) * Self::splat(b);
        for (j, &b) in terms {
            sum = sum + a(j) * Self::splat(b);
        }
        sum
    }
}

#[inline(always)]
fn zero<T: Scalar, P: Pack<T, N>, const N: usize>() -> P {
    P::splat(T::constant(Constant::double(0.0)))
}
