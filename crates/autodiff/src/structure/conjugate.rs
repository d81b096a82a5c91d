//! J = (0 I; −I 0) by components: (Jx)_r = ± x_c.

use equip_scalar::Float;

/// The component c of ∇H from which component `r` of J∇H is formed, and whether the sign changes. With n
/// components the derivatives of the positions are ∂H/∂p, those of the momenta −∂H/∂q. Applied twice, the
/// index map is the identity.
#[doc(hidden)]
#[inline(always)]
pub fn conjugate(r: usize, n: usize) -> (usize, bool) {
    let m = n / 2;
    if r < m { (r + m, false) } else { (r - m, true) }
}

/// Replaces x by Jx.
pub(crate) fn turn<T: Float>(x: &mut [T]) {
    let (q, p) = x.split_at_mut(x.len() / 2);
    for (q, p) in q.iter_mut().zip(p) {
        (*q, *p) = (*p, -*q);
    }
}

/// The component of J∇H formed from component `c` of ∇H, and its sign.
#[doc(hidden)]
#[inline(always)]
pub fn turned<T: Float>(c: usize, n: usize) -> (usize, T) {
    let (r, is_momentum) = conjugate(c, n);
    (r, T::int(if is_momentum { 1 } else { -1 }))
}
