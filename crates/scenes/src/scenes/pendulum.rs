//! The mathematical pendulum.
//!
//! H = p²/2 − cos q, [Hairer, Lubich, Wanner, I.1.2]. With k² = sin²(q/2) + p²/4 the solutions are, [Lawden,
//! Elliptic Functions and Applications, 5]:
//!
//! - libration, k < 1: sin(q/2) = k sn(u, k), cos(q/2) = dn, p = 2k cn, u = t + t₀;
//! - rotation, k > 1: q = 2 am(u, 1/k), p = ±2k dn, u = ±kt + u₀;
//! - separatrix, k = 1: sin(q/2) = tanh u, p = ±2/cosh u, u = ±t + u₀.
//!
//! t₀ never appears: the addition theorem takes sn, cn, dn at the start from the start itself.

use crate::entry::scene;
use crate::maths::elliptic::{Jacobi, add, jacobi, quarter_period};
use crate::model::{Model, State};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// p²/2 − cos q.
    pub struct Pendulum {
        q: Constant = "0" in angle(), "starting angle, 0 hanging down, in radians";
        p: Constant = "1" in closed(-1e3, 1e3), "starting angular velocity";
    }
    name: "pendulum",
    title: "Mathematical pendulum",
    formula: "H = p^2/2 - cos q",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2",
    invariants: "none besides H",
    solution: "closed form by Jacobi's elliptic functions; reference pendulum",
    hard: "p -> 2 at q = 0 is the separatrix: at p = 1.9999999999 the period is 51.6 instead of 6.28; p >> 1 rotates fast",
    units: "",
    period: "of one oscillation or revolution; of small oscillations on the separatrix",
}

/// Modulus and complementary modulus squared of the motion, both without cancellation.
struct Modulus<T> {
    k2: T,
    complement2: T,
}

impl<T: Float> Modulus<T> {
    fn of(q: T, p: T) -> Self {
        let half = T::ratio(1, 2);
        let ((sin, cos), p) = ((q * half).sin_cos(), p * half);
        Modulus {
            k2: sin * sin + p * p,
            complement2: (cos - p) * (cos + p),
        }
    }

    fn swings(&self) -> bool {
        self.complement2 > T::int(0)
    }
}

impl Model for Pendulum {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        0.5 * (p[0] * p[0]) - q[0].cos()
    }

    fn initial<T: Float>(&self) -> State<T> {
        (vec![self.q.to()], vec![self.p.to()])
    }

    /// One swing there and back, or one turn; 2π on the separatrix, whose period is infinite.
    fn period<T: Float>(&self, (q, p): &State<T>) -> T {
        let m = Modulus::of(q[0], p[0]);
        if m.swings() {
            T::int(4) * quarter_period(m.complement2.sqrt())
        } else if m.complement2 < T::int(0) {
            T::int(2) * quarter_period((-m.complement2 / m.k2).sqrt()) / m.k2.sqrt()
        } else {
            T::two_pi()
        }
    }

    fn step(&self) -> f64 {
        let (_, p) = self.initial::<f64>();
        0.25 / (1.0 + p[0].abs() / 4.0)
    }

    fn flow<T: Float>(&self, (q, p): &State<T>, t: T) -> Option<State<T>> {
        let m = Modulus::of(q[0], p[0]);
        let (q, p) = if m.k2 == T::int(0) {
            (T::int(0), T::int(0))
        } else if m.swings() {
            libration(&m, q[0], p[0], t)
        } else if m.complement2 < T::int(0) {
            rotation(&m, q[0], p[0], t)
        } else {
            separatrix(q[0], p[0], t)
        };
        Some((vec![q], vec![p]))
    }
}

fn libration<T: Float>(m: &Modulus<T>, q: T, p: T, t: T) -> (T, T) {
    let (half, k) = (T::ratio(1, 2), m.k2.sqrt());
    let (sin, cos) = (q * half).sin_cos();
    let start = Jacobi {
        sn: sin / k,
        cn: p * half / k,
        dn: cos,
        am: T::int(0),
    };
    let (sn, cn, dn) = add(&jacobi(t, m.complement2.sqrt()), &start, m.k2);
    (T::int(2) * (k * sn).atan2(dn), T::int(2) * k * cn)
}

fn rotation<T: Float>(m: &Modulus<T>, q: T, p: T, t: T) -> (T, T) {
    let (half, k) = (T::ratio(1, 2), m.k2.sqrt());
    let sign = if p < T::int(0) { T::int(-1) } else { T::int(1) };
    let (sin, cos) = (q * half).sin_cos();
    let start = Jacobi {
        sn: sin,
        cn: cos,
        dn: sign * p * half / k,
        am: q * half,
    };
    let turning = jacobi(sign * k * t, (-m.complement2 / m.k2).sqrt());
    let (sn, cn, dn) = add(&turning, &start, m.k2.recip());
    // am(u + v) lies within π of am(u), since |v| < K: that fixes the turns.
    let angle = sn.atan2(cn);
    let turns = ((turning.am - angle) / T::two_pi()).round();
    (
        T::int(2) * (angle + turns * T::two_pi()),
        sign * T::int(2) * k * dn,
    )
}

fn separatrix<T: Float>(q: T, p: T, t: T) -> (T, T) {
    let half = T::ratio(1, 2);
    let sign = if p < T::int(0) { T::int(-1) } else { T::int(1) };
    let (sin, cos) = (q * half).sin_cos();
    // sinh u₀ = tan(q₀/2).
    let tan = sin / cos;
    let u = sign * t + tan.asinh();
    (T::int(2) * u.sinh().atan(), sign * T::int(2) / u.cosh())
}
