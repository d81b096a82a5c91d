//! J = (0 I; −I 0) by components: (Jx)_r = ± x_c.

use equip_scalar::Float;

/// The component c of ∇H that component `r` of J∇H is made of, and whether with the opposite sign: for n
/// components the positions move by ∂H/∂p, the momenta by −∂H/∂q. The same map leads back.
#[doc(hidden)]
#[inline(always)]
pub fn conjugate(r: usize, n: usize) -> (usize, bool) {
    let m = n / 2;
    if r < m { (r + m, false) } else { (r - m, true) }
}

/// Jx in place of x.
pub(crate) fn turn<T: Float>(x: &mut [T]) {
    let (q, p) = x.split_at_mut(x.len() / 2);
    for (q, p) in q.iter_mut().zip(p) {
        (*q, *p) = (*p, -*q);
    }
}

/// The component of J∇H that component `c` of ∇H goes to, and with which sign.
#[doc(hidden)]
#[inline(always)]
pub fn turned<T: Float>(c: usize, n: usize) -> (usize, T) {
    let m = n / 2;
    if c < m {
        (c + m, T::int(-1))
    } else {
        (c - m, T::int(1))
    }
}
