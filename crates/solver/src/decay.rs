//! ϱ, the ratio in which the Legendre coefficients of the stage derivatives decay.
//!
//! $$ \varrho = \max_{g \in \{q, p\}} \max\Big( \theta_{s-1}^{1/(s-1)}, \theta_{s-2}^{1/(s-2)} \Big), \qquad
//!    \theta_k = h \lVert \gamma_k \rVert_g / a_g . $$

use equip_scalar::Float;

/// ϱ from the norms of the coefficients of s stages and what they are relative to, for positions and for
/// momenta; infinite if it is not a number.
pub fn decay<T: Float>(norms: &[Vec<T>; 2], units: [T; 2], s: usize) -> f64 {
    let ratio = |k: usize| {
        let groups = norms.iter().zip(units);
        let moving = groups.filter(|(_, unit)| *unit != T::int(0));
        let relative = moving.map(|(norms, unit)| (norms[k] / unit).to_f64());
        let worst = relative.fold(0.0, |a, x| if x > a || x.is_nan() { x } else { a });
        worst.powf(1.0 / k as f64)
    };
    let before = if s > 2 { ratio(s - 2) } else { 0.0 };
    let last = ratio(s - 1);
    if last.is_nan() || before.is_nan() {
        f64::INFINITY
    } else {
        last.max(before)
    }
}
