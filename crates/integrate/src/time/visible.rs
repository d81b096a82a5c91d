//! What of a state is the user's: positions and momenta, without time and its momentum where H depends on it.
//!
//! States of H(t, q, p) are (q, t, p, p_t), of length 2m + 2: the last of either half is hidden.

/// (q, p) of m degrees of freedom of the state `y`, hidden ones or not.
pub(crate) fn visible<T>(y: &[T], m: usize) -> (&[T], &[T]) {
    let (q, p) = y.split_at(y.len() / 2);
    (&q[..m], &p[..m])
}

/// Where component j of (q, p), of m degrees of freedom, stands in a state of length n.
pub(crate) fn place(j: usize, m: usize, n: usize) -> usize {
    if j < m { j } else { j - m + n / 2 }
}
