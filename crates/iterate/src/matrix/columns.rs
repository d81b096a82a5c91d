//! K(α) in the layout of the iterations: column by column, with padding of zeros.

use crate::layout::row::stride_for;
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// Writes K(α) of `method` to `k`. `room` is workspace for s² numbers.
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
