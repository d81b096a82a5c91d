//! K⁻¹, for L of stiff components.

use crate::layout::row::stride_for;
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// K⁻¹ of the initial α_k, column by column with padding of zeros, and its norm: the largest sum of a row.
#[derive(Debug)]
pub(crate) struct InverseK<T> {
    pub(crate) columns: Vec<T>,
    pub(crate) norm: T,
}

impl<T: Float> InverseK<T> {
    pub(crate) fn new(method: &Coefficients<T>, alphas: &[T]) -> Self {
        let s = method.stages();
        let stride = stride_for::<T>(s);
        let inverse = method.pseudo_inverse(alphas);
        let mut columns = vec![T::int(0); stride * stride];
        let mut norm = 0.0_f64;
        for (i, row) in inverse.chunks_exact(s).enumerate() {
            norm = norm.max(row.iter().map(|x| x.abs()).sum());
            for (j, &x) in row.iter().enumerate() {
                columns[j * stride + i] = T::exact(x);
            }
        }
        let norm = T::exact(norm);
        InverseK { columns, norm }
    }
}
