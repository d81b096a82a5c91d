//! The quartic oscillator.
//!
//! H = p²/2 + q⁴/4: all solutions are one curve scaled. With A = (4E)^{1/4} and Jacobi's functions at k² =
//! 1/2, q = A cn(At + u₀), p = −A² sn dn, [Abramowitz, Stegun, 16]; u₀ enters by the addition theorem.

use crate::entry::scene;
use crate::maths::elliptic::{Jacobi, add, jacobi, quarter_period};
use crate::model::{Model, State};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// p²/2 + q⁴/4.
    pub struct Quartic {
        q: Constant = "1" in closed(-1e3, 1e3), "starting position";
        p: Constant = "0" in closed(-1e3, 1e3), "starting momentum";
    }
    name: "quartic",
    title: "Quartic oscillator",
    formula: "H = p^2/2 + q^4/4",
    source: "textbook; closed form after Abramowitz, Stegun, Handbook of Mathematical Functions, 16",
    invariants: "none besides H",
    solution: "closed form by Jacobi's elliptic functions",
    hard: "amplitude A: the period is 7.416/A; at q = 0 the force and its derivative vanish",
    units: "",
    period: "of the oscillation",
}

/// A = (2p² + q⁴)^{1/4}.
fn amplitude<T: Float>(q: T, p: T) -> T {
    let square = q * q;
    (T::int(2) * p * p + square * square).sqrt().sqrt()
}

impl Model for Quartic {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        0.5 * (p[0] * p[0]) + 0.25 * q[0].powi(4)
    }

    fn initial<T: Float>(&self) -> State<T> {
        (vec![self.q.to()], vec![self.p.to()])
    }

    /// 4K/A; 1 at rest.
    fn period<T: Float>(&self, (q, p): &State<T>) -> T {
        let a = amplitude(q[0], p[0]);
        if a == T::int(0) {
            return T::int(1);
        }
        T::int(4) * quarter_period(T::ratio(1, 2).sqrt()) / a
    }

    fn step(&self) -> f64 {
        self.period(&self.initial::<f64>()) / 30.0
    }

    fn end(&self) -> f64 {
        20.0 * self.period(&self.initial::<f64>())
    }

    fn flow<T: Float>(&self, (q, p): &State<T>, t: T) -> Option<State<T>> {
        let a = amplitude(q[0], p[0]);
        if a == T::int(0) {
            return Some((q.clone(), p.clone()));
        }
        let half = T::ratio(1, 2);
        let cn = q[0] / a;
        let dn = ((T::int(1) + cn * cn) * half).sqrt();
        let start = Jacobi {
            sn: -p[0] / (a * a * dn),
            cn,
            dn,
            am: T::int(0),
        };
        let (sn, cn, dn) = add(&jacobi(a * t, half.sqrt()), &start, half);
        Some((vec![a * cn], vec![-a * a * sn * dn]))
    }
}
