//! Random initial states around a given one. Each depends on the seed and its own index only, not on threads
//! or order.

use equip_scalar::Float;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// The initial state with this `index` that `seed` draws around (`q0`, `p0`), each of length m: every
/// component x becomes x (1 + `spread` u), with an independent u uniform in [−1, 1) for each component.
/// Components that are zero stay zero.
///
/// u comes from ChaCha8, with the key from the seed and the stream from the index: 53 bits of one 64-bit word
/// for each component, those of q first. The states are the same on every machine.
///
/// ```
/// use equip_integrate::drawn_start;
/// let (q, p) = drawn_start(&[1.0, 0.0], &[0.0, 2.0], 0.01, 7, 3);
/// assert!((q[0] - 1.0f64).abs() <= 0.01 && (p[1] - 2.0).abs() <= 0.02);
/// assert_eq!((q[1], p[0]), (0.0, 0.0));
/// assert_eq!((q, p), drawn_start(&[1.0, 0.0], &[0.0, 2.0], 0.01, 7, 3));
/// ```
pub fn drawn_start<T: Float>(
    q0: &[T],
    p0: &[T],
    spread: T,
    seed: u64,
    index: u64,
) -> (Vec<T>, Vec<T>) {
    let mut words = ChaCha8Rng::seed_from_u64(seed);
    words.set_stream(index);
    let mut draw = |&x: &T| {
        let bits = (words.next_u64() >> 11) as f64; // in units of 2⁻⁵³
        let u = bits * f64::EPSILON - 1.0;
        x + x * (spread * T::exact(u))
    };
    (
        q0.iter().map(&mut draw).collect(),
        p0.iter().map(&mut draw).collect(),
    )
}
