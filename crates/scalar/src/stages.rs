//! Z = K L for all components at once: the linear half of a stage sweep.

use crate::{Float, InstructionSet};

/// Z_i = Σ_j K_ij L_j for every component, `stages` being the number of i and of j.
///
/// Layout: component c of stage i stands at `c·stride + i` in `l` and `z`, K **column by column** at `k[j·stride + i]` = K_ij;
/// `stages` ≤ `stride`. Entries from `stages` to `stride` must be finite and are overwritten in `z` with something finite.
/// The sum runs over j = 0, 1, …: the same bits on every instruction set. Cost: s² products for each component.
///
/// # Panics
/// If `l` and `z` differ in length or `k` has fewer than `stages` columns.
#[inline]
pub fn mix_stages<T: Float>(
    set: InstructionSet,
    k: &[T],
    l: &[T],
    z: &mut [T],
    stages: usize,
    stride: usize,
) {
    let _ = set;
    assert_eq!(l.len(), z.len(), "one place for each stage and component");
    for (l, z) in l.chunks_exact(stride).zip(z.chunks_exact_mut(stride)) {
        z.fill(T::int(0));
        for (column, &l) in k.chunks_exact(stride).zip(&l[..stages]) {
            for (z, &k) in z.iter_mut().zip(column) {
                *z += k * l;
            }
        }
    }
}
