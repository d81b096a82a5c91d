//! The part of a state that the user sees: positions and momenta, without time and its momentum if H depends
//! on time.
//!
//! States of H(t, q, p) are (q, t, p, p_t), of length 2m + 2. The last component of each half is hidden.

/// (q, p) with m degrees of freedom, from the state `y` with or without hidden components.
pub(crate) fn visible<T>(y: &[T], m: usize) -> (&[T], &[T]) {
    let (q, p) = y.split_at(y.len() / 2);
    (&q[..m], &p[..m])
}

/// The index of component j of (q, p), with m degrees of freedom, in a state of length n.
pub(crate) fn place(j: usize, m: usize, n: usize) -> usize {
    if j < m { j } else { j - m + n / 2 }
}
