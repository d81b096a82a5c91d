//! K B K, B = diag(b), of the method with α = 0: what two products with K do to the forces.
//!
//! An incremental iteration moves Z by it where other iterations have K twice, and is to differ from them by
//! no more than rounding the result: Z of all drafts of a step together is that of these iterations then,
//! though it was far off in the first of them. So K B K is summed in double-double: with a K that is 5e-17
//! off angular momentum of Kepler's problem grows by 2e-17 a step.
//!
//! Cost: s³ products, of doubles in double-double.

use crate::MAX_STAGES;
use crate::layout::aligned::{Aligned, Places};
use crate::layout::row::{rows, stride_for};
use crate::matrix::product::{Mixes, Packed, product_any};
use equip_scalar::{DoubleDouble, Float, InstructionSet, Kernel};
use equip_tableau::Coefficients;

/// K B K column by column, of K column by column; of doubles to half a unit in the last place.
pub(crate) fn of<T: Float>(
    set: InstructionSet,
    method: &Coefficients<T>,
    k: &[T],
    places: &mut Places,
) -> Aligned<T> {
    let s = method.stages();
    let stride = stride_for::<T>(s);
    let k = &k[..s * stride];
    let mut twice = places.zeros(stride * stride);
    let doubles = (T::as_doubles(method.weights()), T::as_doubles(k));
    let (Some(b), Some(k), Some(to)) = (doubles.0, doubles.1, T::as_doubles_mut(&mut twice)) else {
        add_product(set, k, method, &mut twice);
        return twice;
    };
    let width = s.next_multiple_of(8);
    let mut columns = vec![DoubleDouble::exact(0.0); s * width];
    for (to, from) in columns.chunks_exact_mut(width).zip(k.chunks_exact(stride)) {
        for (x, &k) in to.iter_mut().zip(&from[..s]) {
            *x = DoubleDouble::exact(k);
        }
    }
    set.run(&mut Exactly {
        columns: &columns,
        b,
        width,
        stride,
        twice: to,
    });
    twice
}

/// K B K of any K, which stands column by column, added to `twice`.
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

struct Exactly<'a> {
    /// K, columns of this width.
    columns: &'a [DoubleDouble],
    b: &'a [f64],
    width: usize,
    stride: usize,
    twice: &'a mut [f64],
}

impl Kernel for Exactly<'_> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        match self.width {
            8 => self.packed::<1>(),
            16 => self.packed::<2>(),
            _ => self.any(),
        }
    }
}

impl Exactly<'_> {
    /// Up to 16 stages.
    #[inline(always)]
    fn packed<const G: usize>(&mut self) {
        let k = Packed::<DoubleDouble, G, 8, 16>::of(rows(self.columns), self.b.len());
        let columns = self.columns.chunks_exact(self.width);
        for (to, column) in self.twice.chunks_exact_mut(self.stride).zip(columns) {
            let mut row = [[DoubleDouble::exact(0.0); 8]; G];
            weigh(column, self.b, row.as_flattened_mut());
            round(k.product(&row).as_flattened(), to);
        }
    }

    #[inline(always)]
    fn any(&mut self) {
        let (s, groups) = (self.b.len(), self.width / 8);
        let k = self.columns.as_chunks::<8>().0;
        let columns = self.columns.chunks_exact(self.width);
        for (to, column) in self.twice.chunks_exact_mut(self.stride).zip(columns) {
            let mut row = [[DoubleDouble::exact(0.0); 8]; MAX_STAGES / 8];
            weigh(column, self.b, row.as_flattened_mut());
            for (g, to) in to.chunks_mut(8).enumerate() {
                round(&product_any(k, &row[..groups], g, s), to);
            }
        }
    }
}

/// B times a column.
#[inline(always)]
fn weigh(column: &[DoubleDouble], b: &[f64], to: &mut [DoubleDouble]) {
    for ((to, &x), &b) in to.iter_mut().zip(column).zip(b) {
        *to = x * DoubleDouble::exact(b);
    }
}

#[inline(always)]
fn round(from: &[DoubleDouble], to: &mut [f64]) {
    for (to, x) in to.iter_mut().zip(from) {
        *to = x.to_f64();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::coefficients::Columns;

    /// K L in double-double, K column by column.
    fn mixed(k: &[f64], s: usize, l: &[DoubleDouble]) -> Vec<DoubleDouble> {
        let (zero, stride) = (DoubleDouble::exact(0.0), stride_for::<f64>(s));
        let entry = |i: usize, j: usize| DoubleDouble::exact(k[j * stride + i]);
        (0..s)
            .map(|i| (0..s).fold(zero, |sum, j| sum + entry(i, j) * l[j]))
            .collect()
    }

    /// To half a unit in the last place, what two products with K do to each unit vector, B between them.
    #[test]
    fn it_is_two_products_rounded_once() {
        for s in [2, 3, 4, 5, 8, 9, 15, 16, 17, 24, 32] {
            let gauss = Coefficients::<f64>::gauss(s).unwrap();
            let stride = stride_for::<f64>(s);
            for set in InstructionSet::available() {
                let mut k = vec![0.0; stride * stride];
                Columns::new(&gauss).fill(set, &vec![0.0; s - 1], &mut k);
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
