//! K(α) as iterations multiply with it: column by column, the padding zero.

use crate::layout::row::stride_for;
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// K(α) of `method` into the entries of `k`, with room for s² numbers.
pub(crate) fn columns_into<T: Float>(
    method: &Coefficients<T>,
    alphas: &[T],
    room: &mut [T],
    k: &mut [T],
) {
    let s = method.stages();
    let stride = stride_for::<T>(s);
    method.matrix_into(alphas, room);
    for (i, row) in room.chunks_exact(s).enumerate() {
        for (j, &x) in row.iter().enumerate() {
            k[j * stride + i] = x;
        }
    }
}
