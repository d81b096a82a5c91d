//! K B K, B = diag(b), of the method with α = 0: two products with K, applied to the forces.
//!
//! An incremental iteration updates Z with K B K, where other iterations apply K twice. Both must agree up to
//! the rounding of the result. The sum of all increments of a step then equals the Z of the other iterations,
//! although the first ones are far from the solution. K B K is therefore summed in double-double: with an
//! error of 5e-17 in the matrix, the angular momentum of Kepler's problem drifts by 2e-17 a step.
//!
//! Cost: s³ products, for `f64` in double-double.

use crate::layout::aligned::{Aligned, Places};
use crate::layout::row::stride_for;
use equip_scalar::{DoubleDouble, Float, InstructionSet, Kernel};
use equip_tableau::Coefficients;

/// K B K column by column, from K column by column; for `f64` to half a unit in the last place.
pub(crate) fn of<T: Float>(
    set: InstructionSet,
    method: &Coefficients<T>,
    k: &[T],
    places: &mut Places,
) -> Aligned<T> {
    let stride = stride_for::<T>(method.stages());
    let k = &k[..method.stages() * stride];
    let mut twice = places.zeros(stride * stride);
    let doubles = (T::as_doubles(method.weights()), T::as_doubles(k));
    let (Some(b), Some(k), Some(to)) = (doubles.0, doubles.1, T::as_doubles_mut(&mut twice)) else {
        add_product(set, k, method, &mut twice);
        return twice;
    };
    let [k, b] = [k, b].map(|x| {
        x.iter()
            .map(|&x| DoubleDouble::exact(x))
            .collect::<Vec<_>>()
    });
    let mut wide = vec![DoubleDouble::exact(0.0); to.len()];
    set.run(&mut Product {
        k: &k,
        b: &b,
        stride,
        twice: &mut wide,
    });
    to.iter_mut()
        .zip(&wide)
        .for_each(|(to, x)| *to = x.to_f64());
    twice
}

/// Adds K B K to `twice`, for any K column by column.
pub(crate) fn add_product<T: Float>(
    set: InstructionSet,
    k: &[T],
    method: &Coefficients<T>,
    twice: &mut [T],
) {
    set.run(&mut Product {
        k,
        b: method.weights(),
        stride: stride_for::<T>(method.stages()),
        twice,
    });
}

struct Product<'a, T> {
    k: &'a [T],
    b: &'a [T],
    stride: usize,
    twice: &'a mut [T],
}

impl<T: Float> Kernel for Product<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let columns = self.k.chunks_exact(self.stride);
        for (to, from) in (self.twice.chunks_exact_mut(self.stride)).zip(columns.clone()) {
            for ((column, &x), &b) in columns.clone().zip(from).zip(self.b) {
                let x = b * x;
                for (to, &k) in to.iter_mut().zip(column) {
                    *to += k * x;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::product::columns_into;

    /// K L in double-double, with K column by column.
    fn mixed(k: &[f64], s: usize, l: &[DoubleDouble]) -> Vec<DoubleDouble> {
        let (zero, stride) = (DoubleDouble::exact(0.0), stride_for::<f64>(s));
        let entry = |i: usize, j: usize| DoubleDouble::exact(k[j * stride + i]);
        (0..s)
            .map(|i| (0..s).fold(zero, |sum, j| sum + entry(i, j) * l[j]))
            .collect()
    }

    /// To half a unit in the last place, K B K times each unit vector equals two products with K.
    #[test]
    fn it_is_two_products_rounded_once() {
        for s in [2, 3, 4, 5, 8, 9, 15, 16, 17, 24, 32] {
            let gauss = Coefficients::<f64>::gauss(s).unwrap();
            let stride = stride_for::<f64>(s);
            for set in InstructionSet::available() {
                let mut k = vec![0.0; stride * stride];
                columns_into(&gauss, &vec![0.0; s - 1], &mut vec![0.0; s * s], &mut k);
                let found = of(set, &gauss, &k, &mut Places::default());
                for j in 0..s {
                    let mut l = vec![DoubleDouble::exact(0.0); s];
                    l[j] = DoubleDouble::exact(1.0);
                    let mut l = mixed(&k, s, &l);
                    for (l, &b) in l.iter_mut().zip(gauss.weights()) {
                        *l *= DoubleDouble::exact(b);
                    }
                    for (i, x) in mixed(&k, s, &l).into_iter().enumerate() {
                        let found = found[j * stride + i];
                        let off = (x - DoubleDouble::exact(found)).to_f64().abs();
                        let half = 0.5 * (found.abs().next_up() - found.abs());
                        assert!(off <= half + 1e-30, "s = {s}, {set:?}: {off:e}");
                    }
                }
            }
        }
    }
}
