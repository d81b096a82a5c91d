//! Shifted Legendre polynomials, orthonormal on [0, 1], with their integrals and derivatives.
//!
//! With L_k the classical polynomials on [−1, 1],
//!
//! $$P_k(c) = \sqrt{2k+1}\,L_k(2c-1), \qquad \int_0^1 P_i P_j = \delta_{ij}, \qquad P_0 = 1.$$
//!
//! The recurrence uses the distance t to the nearer end of the interval and the difference of successive
//! values. This avoids the cancellation in 2c − 1 near c = 0 and c = 1, and in L_{k+1} − L_{k−1} of the
//! integrals:
//!
//! $$D_{k+1} = \frac{k D_k - (2k+1)\,t\,L_k}{k+1}, \qquad L_{k+1} = L_k + D_{k+1}, \qquad x = 1 - t.$$
//!
//! Cost: O(n) operations and n square roots for n polynomials. Arguments outside [0, 1] are allowed
//! (extrapolation).

use equip_scalar::Float;

/// The infinite sequence of pairs (L_k(1 − t), L_k(1 − t) − L_{k−1}(1 − t)) for k = 0, 1, 2, ….
#[derive(Debug, Clone)]
pub(crate) struct Classical<T> {
    t: T,
    k: i64,
    value: T,
    step: T,
}

impl<T: Float> Classical<T> {
    pub(crate) fn new(t: T) -> Self {
        Classical {
            t,
            k: 0,
            value: T::int(1),
            step: T::int(0),
        }
    }
}

impl<T: Float> Iterator for Classical<T> {
    type Item = (T, T);

    fn next(&mut self) -> Option<(T, T)> {
        let here = (self.value, self.step);
        next(self.k, self.t, &mut self.value, &mut self.step);
        self.k += 1;
        Some(here)
    }
}

/// Replaces L_k(1 − t) and its difference L_k − L_{k−1} by L_{k+1} and L_{k+1} − L_k.
#[inline(always)]
pub(crate) fn next<T: Float>(k: i64, t: T, value: &mut T, step: &mut T) {
    *step = (T::int(k) * *step - T::int(2 * k + 1) * t * *value) / T::int(k + 1);
    *value += *step;
}

/// √(2k + 1), the factor that makes P_k orthonormal.
pub(crate) fn norm<T: Float>(k: usize) -> T {
    T::int(2 * k as i64 + 1).sqrt()
}

/// (−1)^k x if `flip`, else x.
pub(crate) fn alternate<T: Float>(flip: bool, k: usize, x: T) -> T {
    if flip && k % 2 == 1 { -x } else { x }
}

/// Whether c is nearer to 0, and twice the distance of c to the nearer end. Near 0 the identity P_k(c) =
/// (−1)^k P_k(1 − c) is used.
fn nearer_end<T: Float>(c: T) -> (bool, T) {
    let near_zero = c < T::ratio(1, 2);
    (
        near_zero,
        T::int(2) * if near_zero { c } else { T::int(1) - c },
    )
}

/// P_0(c) … P_{n−1}(c) for n = `out.len()`, orthonormal on [0, 1].
///
/// ```
/// let mut p = [0.0; 3];
/// equip_tableau::legendre_at(1.0, &mut p);
/// assert_eq!(p, [1.0, 3f64.sqrt(), 5f64.sqrt()]);
/// ```
pub fn legendre_at<T: Float>(c: T, out: &mut [T]) {
    let (flip, t) = nearer_end(c);
    for (k, (p, (value, _))) in out.iter_mut().zip(Classical::new(t)).enumerate() {
        *p = alternate(flip, k, norm::<T>(k) * value);
    }
}

/// ∫₀ᶜ P_k for k = 0 … n − 1, n = `out.len()`.
///
/// Computed as (L_{k+1} − L_{k−1}) / (2√(2k+1)), which equals ξ_{k+1} P_{k+1} − ξ_k P_{k−1} for k ≥ 1. For k
/// ≥ 1 the integrals vanish at both ends, and they are computed with full relative accuracy near both.
///
/// ```
/// let mut integrals = [0.0; 2];
/// equip_tableau::legendre_integrals_at(0.5, &mut integrals);
/// assert_eq!(integrals[0], 0.5);
/// assert!((integrals[1] + 3f64.sqrt() / 4.0).abs() < 1e-16);
/// ```
pub fn legendre_integrals_at<T: Float>(c: T, out: &mut [T]) {
    let (flip, t) = nearer_end(c);
    let steps = Classical::new(t).map(|(_, step)| step);
    for (k, (integral, (d, d_next))) in out
        .iter_mut()
        .zip(steps.clone().zip(steps.skip(1)))
        .enumerate()
    {
        *integral = if k == 0 {
            c
        } else {
            alternate(flip, k + 1, (d + d_next) / (T::int(2) * norm::<T>(k)))
        };
    }
}

/// P_k′(c) for k = 0 … n − 1, n = `out.len()`.
///
/// Computed by L′_{k+1} = L′_{k−1} + (2k + 1) L_k.
///
/// ```
/// let mut slopes = [0.0; 3];
/// equip_tableau::legendre_derivatives_at(0.5, &mut slopes);
/// assert_eq!(slopes, [0.0, 2.0 * 3f64.sqrt(), 0.0]);
/// ```
pub fn legendre_derivatives_at<T: Float>(c: T, out: &mut [T]) {
    let (flip, t) = nearer_end(c);
    let (mut before, mut slope) = (T::int(0), T::int(0));
    for (k, (derivative, (value, _))) in out.iter_mut().zip(Classical::new(t)).enumerate() {
        *derivative = alternate(flip, k + 1, T::int(2) * norm::<T>(k) * slope);
        (before, slope) = (slope, before + T::int(2 * k as i64 + 1) * value);
    }
}
