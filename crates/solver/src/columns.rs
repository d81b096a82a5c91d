//! K(α) for sweeps: column by column, padded with zeros, and made anew whenever the α's move.
//!
//! K(α)_ij = ½ + U_ij, U = U(0) + Σ_k α_k T_k. As in `Gauss::skew_into` ½ + |U_ij| is rounded and the smaller one of the pair is 1 minus that, so that K_ij +
//! K_ji = 1 to the last bit. U is antisymmetric to the last bit, so each of the two is found without the other, and all
//! entries at once: s² products for each α_k ≠ 0, in vector instructions.

use crate::aligned::{Aligned, Places};
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Gauss;

/// U(0) and the T_k, laid out as K is.
#[derive(Debug)]
pub(crate) struct Columns<T> {
    unperturbed: Aligned<T>,
    /// T_1 … T_{s−1}.
    basis: Vec<Aligned<T>>,
    /// ½ and 1 where K has an entry, 0 in the padding.
    half: Aligned<T>,
    one: Aligned<T>,
}

impl<T: Float> Columns<T> {
    pub(crate) fn new(gauss: &Gauss<T>, stride: usize) -> Self {
        let (s, mut places) = (gauss.stages(), Places::default());
        let mut padded = |entry: &dyn Fn(usize, usize) -> T| {
            let mut x = places.zeros(stride * stride);
            for j in 0..s {
                for i in 0..s {
                    x[j * stride + i] = entry(i, j);
                }
            }
            x
        };
        let mut u = vec![T::int(0); s * s];
        gauss.antisymmetric_into(&vec![T::int(0); s - 1], &mut u);
        Columns {
            unperturbed: padded(&|i, j| u[i * s + j]),
            basis: (1..s)
                .map(|k| padded(&|i, j| gauss.skew_basis(k)[i * s + j]))
                .collect(),
            half: padded(&|_, _| T::ratio(1, 2)),
            one: padded(&|_, _| T::int(1)),
        }
    }

    /// K(α) into `k`.
    pub(crate) fn fill(&self, set: InstructionSet, alphas: &[T], k: &mut [T]) {
        set.run(&mut Fill {
            columns: self,
            alphas,
            k,
        });
    }
}

struct Fill<'a, T> {
    columns: &'a Columns<T>,
    alphas: &'a [T],
    k: &'a mut [T],
}

impl<T: Float> Kernel for Fill<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let (columns, k) = (self.columns, &mut *self.k);
        k.copy_from_slice(&columns.unperturbed);
        for (basis, &alpha) in columns.basis.iter().zip(self.alphas) {
            if alpha != T::int(0) {
                for (u, &t) in k.iter_mut().zip(&**basis) {
                    *u += alpha * t;
                }
            }
        }
        for ((k, &half), &one) in k.iter_mut().zip(&*columns.half).zip(&*columns.one) {
            let large = half + k.abs();
            *k = if *k < T::int(0) { one - large } else { large };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::DoubleDouble;

    fn entries_are_those_of_the_tableau<T: Float>() {
        for s in 1..=12 {
            let gauss = Gauss::<T>::new(s).unwrap_or_else(|e| panic!("{e}"));
            let stride = s.next_multiple_of(4);
            let columns = Columns::new(&gauss, stride);
            let alphas: Vec<T> = (1..s as i64).map(|k| T::ratio(k * k - 3 * k, 7)).collect();
            let mut expected = vec![T::int(0); stride * stride];
            gauss.skew_columns_into(&alphas, stride, &mut expected);
            for set in InstructionSet::available() {
                let mut k = vec![T::NAN; stride * stride];
                columns.fill(set, &alphas, &mut k);
                assert!(k == expected, "s = {s}, {set:?}");
            }
        }
    }

    #[test]
    fn entries_of_k_have_the_bits_of_the_tableau() {
        entries_are_those_of_the_tableau::<f64>();
        entries_are_those_of_the_tableau::<DoubleDouble>();
    }
}
