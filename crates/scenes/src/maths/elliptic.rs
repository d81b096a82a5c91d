//! Jacobi's elliptic functions by the arithmetic–geometric mean, for closed forms of pendulum and quartic
//! oscillator.
//!
//! [Abramowitz, Stegun, 16.4 and 17.6]: a_{n+1} = (a_n + b_n)/2, b_{n+1} = √(a_n b_n), c_{n+1} = (a_n −
//! b_n)/2 from a_0 = 1, b_0 = k', then φ_N = 2^N a_N u and sin(2φ_{n−1} − φ_n) = (c_n/a_n) sin φ_n downwards.
//! Ten rounds reach double-double for every k' > 1e-30. The angle is taken by atan2, whose condition does not
//! suffer where c_n/a_n is near 1.

use equip_scalar::Float;

/// sn, cn, dn and the amplitude am, which grows by 2π while u grows by 4K.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jacobi<T> {
    pub(crate) sn: T,
    pub(crate) cn: T,
    pub(crate) dn: T,
    pub(crate) am: T,
}

/// More rounds than any float type of 212 bits needs.
const MOST_ROUNDS: usize = 24;

/// The quarter period K = π/(2 AGM(1, k')), for 0 < k' ≤ 1.
pub(crate) fn quarter_period<T: Float>(complement: T) -> T {
    let means = means(complement);
    let last = means.last().map_or(T::int(1), |&(a, ..)| a);
    T::frac_pi_2() / last
}

/// The functions at u for the complementary modulus 0 < k' ≤ 1 (k² = 1 − k'²).
pub(crate) fn jacobi<T: Float>(u: T, complement: T) -> Jacobi<T> {
    let means = means(complement);
    let a_last = means.last().map_or(T::int(1), |&(a, ..)| a);
    let full_period = T::two_pi() / a_last;
    let turns = (u / full_period).round();
    let rest = u - turns * full_period;

    let mut phi = rest * a_last;
    for _ in 1..means.len() {
        phi += phi;
    }
    for &(a, b, c) in means.iter().skip(1).rev() {
        let (sin, cos) = phi.sin_cos();
        let a_cos = a * cos;
        let b_sin = b * sin;
        let below = (c * sin).atan2((a_cos * a_cos + b_sin * b_sin).sqrt());
        phi = (phi + below) * T::ratio(1, 2);
    }
    let (sn, cn) = phi.sin_cos();
    let k_sn = complement * sn;
    Jacobi {
        sn,
        cn,
        dn: (cn * cn + k_sn * k_sn).sqrt(),
        am: phi + turns * T::two_pi(),
    }
}

/// (a_n, b_n, c_n) until c_n is below the round-off of a_n.
fn means<T: Float>(complement: T) -> Vec<(T, T, T)> {
    let half = T::ratio(1, 2);
    let (mut a, mut b) = (T::int(1), complement);
    let mut means = vec![(a, b, T::int(0))];
    for _ in 0..MOST_ROUNDS {
        let c = (a - b) * half;
        if c.abs() <= T::EPSILON * a {
            break;
        }
        let mean = (a + b) * half;
        b = (a * b).sqrt();
        a = mean;
        means.push((a, b, c));
    }
    means
}

/// The functions at u + v from those at u and v, [Abramowitz, Stegun, 16.17]; m = k².
pub(crate) fn add<T: Float>(u: &Jacobi<T>, v: &Jacobi<T>, m: T) -> (T, T, T) {
    let product = u.sn * v.sn;
    let scale = (T::int(1) - m * product * product).recip();
    let sn = (u.sn * v.cn * v.dn + v.sn * u.cn * u.dn) * scale;
    let cn = (u.cn * v.cn - product * u.dn * v.dn) * scale;
    let dn = (u.dn * v.dn - m * product * u.cn * v.cn) * scale;
    (sn, cn, dn)
}
