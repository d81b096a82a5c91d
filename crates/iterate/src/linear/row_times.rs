//! Rows of ∇²H at the stages, multiplied by X.

use crate::layout::row::fused_each;
use equip_autodiff::Pattern;
use equip_scalar::Float;

/// Σ_e entry_e X for one row and one group of stages, over the columns before `end`, for S sides from `side`
/// on.
#[inline(always)]
pub(crate) fn row_times<T: Float, const N: usize, const S: usize>(
    pattern: &Pattern,
    entries: &[T],
    (row, end): (usize, usize),
    x: &[T],
    (side, groups, g): (usize, usize, usize),
) -> [[T; N]; S] {
    let (entries, x) = (entries.as_chunks::<N>().0, x.as_chunks::<N>().0);
    let n = pattern.dimension();
    let range = pattern.row_starts[row]..pattern.row_starts[row + 1];
    let mut sums = [[T::int(0); N]; S];
    for (e, &column) in range.clone().zip(&pattern.columns[range]) {
        if column >= end {
            break;
        }
        let entry = &entries[e * groups + g];
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = fused_each(entry, &x[((side + k) * n + column) * groups + g], sum);
        }
    }
    sums
}
