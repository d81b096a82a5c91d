//! K(α) for iterations: column by column, padded with zeros, and made anew whenever the α_k move.
//!
//! Of a method without α_k K is a copy. Of a Gauss method K(α)_ij = ½ + U_ij, U = U(0) + Σ_k α_k T_k. As in
//! `Coefficients::matrix_into` ½ + |U_ij| is rounded and the smaller of the pair is 1 minus that, so that
//! K_ij + K_ji = 1 to the last bit. U is antisymmetric to the last bit, so each of the two is found without
//! the other, and all entries at once: s² products for each α_k ≠ 0, in vector instructions.

use crate::MAX_STAGES;
use crate::layout::aligned::{Aligned, Places};
use crate::layout::row::{add, scaled, stride_for};
use equip_scalar::{Float, InstructionSet, Kernel, Pack, Piecewise, Scalar};
use equip_tableau::Coefficients;

/// U(0) and the T_k, laid out as K is: column by column.
#[derive(Debug)]
pub(crate) struct Columns<T> {
    /// Of a method without α_k K itself.
    unperturbed: Aligned<T>,
    /// T_1 … T_{s−1}, one behind the other; empty if there are no α_k.
    basis: Aligned<T>,
    /// ½ and 1 where K has an entry, 0 in the padding.
    half_and_one: [Aligned<T>; 2],
    /// Whether K_ij + K_ji = 1.
    is_skew: bool,
    /// Numbers before the columns that are all padding.
    used: usize,
}

impl<T: Float> Columns<T> {
    pub(crate) fn new(method: &Coefficients<T>) -> Self {
        let (s, mut places) = (method.stages(), Places::default());
        let stride = stride_for::<T>(s);
        let lay_out = |entries: &[T], x: &mut [T]| {
            for j in 0..s {
                for i in 0..s {
                    x[j * stride + i] = entries[i * s + j];
                }
            }
        };
        let len = stride * stride;
        let mut laid_out = |entries: &[T]| {
            let mut x = places.zeros(len);
            lay_out(entries, &mut x);
            x
        };
        let is_skew = method.is_skew();
        let mut u = vec![T::int(0); s * s];
        if is_skew {
            method.antisymmetric_into(&vec![T::int(0); method.alphas()], &mut u);
        } else {
            method.matrix_into(&[], &mut u);
        }
        let unperturbed = laid_out(&u);
        let half_and_one = [T::ratio(1, 2), T::int(1)].map(|x| laid_out(&vec![x; s * s]));
        let mut basis = places.zeros(method.alphas() * len);
        for (k, x) in basis.chunks_exact_mut(len).enumerate() {
            lay_out(method.skew_basis(k + 1), x);
        }
        Columns {
            unperturbed,
            basis,
            half_and_one,
            is_skew,
            used: s * stride,
        }
    }

    /// K(α) into `k`, whose last columns, if they are padding, stay as they are.
    pub(crate) fn fill(&self, set: InstructionSet, alphas: &[T], k: &mut [T]) {
        if !self.is_skew {
            k[..self.used].copy_from_slice(&self.unperturbed[..self.used]);
            return;
        }
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
        // Strides are multiples of it.
        if const { T::WIDTH == 1 } {
            self.packs::<1>();
        } else if T::IS_DOUBLE {
            self.packs::<4>();
        } else {
            self.packs::<8>();
        }
    }
}

impl<T: Float> Fill<'_, T> {
    #[inline(always)]
    fn packs<const N: usize>(&mut self) {
        let (columns, used) = (self.columns, self.columns.used);
        let (unperturbed, k) = (&columns.unperturbed[..used], &mut self.k[..used]);
        let basis = columns.basis.chunks_exact(columns.unperturbed.len());
        let moved = basis
            .zip(self.alphas)
            .filter(|&(_, &alpha)| alpha != T::int(0));
        if T::IS_DOUBLE {
            k.copy_from_slice(unperturbed);
            for (basis, &alpha) in moved {
                for (u, t) in k.as_chunks_mut::<N>().0.iter_mut().zip(basis.as_chunks().0) {
                    add(u, &scaled(t, alpha));
                }
            }
        } else {
            // As one dot product, which is the same sum in doubles.
            let mut terms = [(unperturbed, T::int(1)); MAX_STAGES];
            let mut count = 1;
            for (basis, &alpha) in moved {
                terms[count] = (basis, alpha);
                count += 1;
            }
            let k = k.as_chunks_mut::<N>().0;
            match count {
                ..=4 => dots::<T, N, 4>(&terms[..count], k),
                _ => dots::<T, N, MAX_STAGES>(&terms[..count], k),
            }
        }
        let k = k.as_chunks_mut::<N>().0;
        let [half, one] = &columns.half_and_one;
        let constants = half.as_chunks().0.iter().zip(one.as_chunks().0);
        for (k, (half, one)) in k.iter_mut().zip(constants) {
            let u = T::Pack::of(k);
            let large = T::Pack::of(half) + T::Pack::abs(u);
            let small = T::Pack::of(one) - large;
            let takes_large = T::Pack::at_most(T::Pack::splat(T::int(0)), u);
            *k = T::Pack::choose(takes_large, large, small).numbers();
        }
    }
}

/// Σ of at most C matrices, each times its factor.
#[inline(always)]
fn dots<T: Float, const N: usize, const C: usize>(terms: &[(&[T], T)], to: &mut [[T; N]]) {
    let mut factors = [T::int(0); C];
    let mut packs = [[T::Pack::splat(T::int(0))]; C];
    for (factor, term) in factors.iter_mut().zip(terms) {
        *factor = term.1;
    }
    for (at, u) in to.iter_mut().enumerate() {
        for (pack, (matrix, _)) in packs.iter_mut().zip(terms) {
            *pack = [T::Pack::of(&matrix.as_chunks().0[at])];
        }
        *u = T::Pack::dot(&packs[..terms.len()], 0, &factors).numbers();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::DoubleDouble;

    fn entries_are_those_of_the_tableau<T: Float>() {
        for s in 1..=20 {
            let gauss = Coefficients::<T>::gauss(s).unwrap_or_else(|e| panic!("{e}"));
            let (columns, stride) = (Columns::new(&gauss), stride_for::<T>(s));
            let alphas: Vec<T> = (1..s as i64).map(|k| T::ratio(k * k - 3 * k, 7)).collect();
            for set in InstructionSet::available() {
                let mut k = vec![T::int(0); stride * stride];
                k[..columns.used].fill(T::NAN);
                columns.fill(set, &alphas, &mut k);
                let mut expected = vec![T::int(0); stride * stride];
                for (at, x) in gauss.matrix(&alphas).into_iter().enumerate() {
                    expected[at % s * stride + at / s] = x;
                }
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
