//! Kepler's problem in closed form: the state after time t on an ellipse through a given state.
//!
//! Lagrange's f and g with the eccentric anomaly difference x, [Danby, Fundamentals of Celestial Mechanics,
//! 6]:
//!
//! x − (1 − ρ) sin x + σ (1 − cos x) = n t,   ρ = r₀/a = 1 − e cos E₀,   σ = q₀·p₀/√(μa) = e sin E₀.
//!
//! The left side is evaluated as ρx + (1 − ρ)(x − sin x) + 2σ sin²(x/2), which loses nothing where e → 1 and
//! x → 0.

use equip_scalar::Float;

/// More steps than bisection alone needs in any float type.
const MOST_STEPS: usize = 400;

/// The elements of an ellipse.
pub(crate) struct Ellipse<T> {
    /// Semi-major axis a.
    pub(crate) a: T,
    /// Mean motion n = √(μ/a³).
    pub(crate) n: T,
}

/// The ellipse through (q, p), or nothing if the orbit is not bound.
pub(crate) fn ellipse<T: Float>(mu: T, q: [T; 2], p: [T; 2]) -> Option<Ellipse<T>> {
    let r = norm(q);
    let inverse = T::int(2) / r - (p[0] * p[0] + p[1] * p[1]) / mu;
    let a = inverse.recip();
    (inverse > T::int(0)).then(|| Ellipse {
        a,
        n: (mu / a).sqrt() / a,
    })
}

/// The state a time t after (q, p), or nothing if the orbit is not bound.
pub(crate) fn advance<T: Float>(mu: T, q: [T; 2], p: [T; 2], t: T) -> Option<([T; 2], [T; 2])> {
    let Ellipse { a, n } = ellipse(mu, q, p)?;
    let r0 = norm(q);
    let rho = r0 / a;
    let sigma = (q[0] * p[0] + q[1] * p[1]) / (mu * a).sqrt();
    let turns = n * t / T::two_pi();
    let mean = (turns - turns.round()) * T::two_pi();

    let x = anomaly(rho, sigma, mean);
    let (sin, _) = x.sin_cos();
    let versine = versine(x);
    let r = a * derivative(rho, sigma, x);
    let f = T::int(1) - a / r0 * versine;
    let g = (rho * sin + sigma * versine) / n;
    let f_dot = -(mu * a).sqrt() / (r * r0) * sin;
    let g_dot = T::int(1) - a / r * versine;
    let combine = |s: T, t: T| [s * q[0] + t * p[0], s * q[1] + t * p[1]];
    Some((combine(f, g), combine(f_dot, g_dot)))
}

/// The root x of the equation above: Newton's method, kept inside a bracket by bisection.
fn anomaly<T: Float>(rho: T, sigma: T, mean: T) -> T {
    let left = |x: T| rho * x + (T::int(1) - rho) * x_minus_sin(x) + sigma * versine(x);
    // |x − mean| = |(1 − ρ) sin x − σ(1 − cos x)| < 3 for every ellipse.
    let (mut low, mut high) = (mean - T::int(3), mean + T::int(3));
    let mut x = mean;
    for _ in 0..MOST_STEPS {
        let residual = left(x) - mean;
        if residual > T::int(0) {
            high = x;
        } else {
            low = x;
        }
        let mut next = x - residual / derivative(rho, sigma, x);
        if !(next >= low && next <= high) {
            next = (low + high) * T::ratio(1, 2);
        }
        let change = (next - x).abs();
        x = next;
        if change <= T::EPSILON * x.abs() {
            break;
        }
    }
    x
}

/// dM/dx = r/a.
fn derivative<T: Float>(rho: T, sigma: T, x: T) -> T {
    rho + (T::int(1) - rho) * versine(x) + sigma * x.sin()
}

/// 1 − cos x.
fn versine<T: Float>(x: T) -> T {
    let half = (x * T::ratio(1, 2)).sin();
    T::int(2) * half * half
}

/// x − sin x, by its series where the difference would cancel.
fn x_minus_sin<T: Float>(x: T) -> T {
    if x.abs() > T::int(1) {
        return x - x.sin();
    }
    let square = x * x;
    let mut term = x * square / T::int(6);
    let mut sum = term;
    let mut k = 4;
    while term.abs() > T::EPSILON * sum.abs() {
        term = -term * square / T::int(k * (k + 1));
        sum += term;
        k += 2;
    }
    sum
}

fn norm<T: Float>(v: [T; 2]) -> T {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}
