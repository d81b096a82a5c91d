//! The restricted problem of three bodies in the rotating frame, on Arenstorf's closed orbits.
//!
//! H = ½(p₁² + p₂²) + p₁q₂ − p₂q₁ − (1 − μ)/|q + (μ, 0)| − μ/|q − (1 − μ, 0)|, p = (q̇₁ − q₂, q̇₂ + q₁),
//! [Arenstorf, Amer. J. Math. 85, 1963; Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I,
//! II.0]. Both orbits were recomputed with 45 digits: they return to their start within 5e-27 and 4e-26.

use crate::entry::scene;
use crate::model::{Model, State, read};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// A satellite of Earth and Moon in the frame that rotates with them.
    pub struct Arenstorf {
        mu: Constant = "0.012277471" in above(0.0, 0.5), "mass of the Moon as a part of both; the orbits close at the default only";
        orbit: usize = "1" in closed(1.0, 2.0), "1: period 17.07; 2: period 11.12";
    }
    name: "arenstorf",
    title: "Arenstorf orbits",
    formula: "H = (p1^2 + p2^2)/2 + p1 q2 - p2 q1 - (1-mu)/|q + (mu,0)| - mu/|q - (1-mu,0)|",
    source: "Arenstorf, Periodic solutions of the restricted three body problem, Amer. J. Math. 85 (1963); Hairer, Norsett, Wanner, Solving ODEs I, II.0",
    invariants: "none besides H, which is half the negative Jacobi constant",
    solution: "closed orbit: reference arenstorf returns to its start",
    hard: "passes the Moon at 0.006, where speeds and accelerations jump; starting data of 29 digits return with 26",
    units: "distance of Earth and Moon = 1; the frame rotates by 1 radian per unit of time",
    period: "of the orbit",
}

/// Starting velocity q̇₂ and period of the orbits.
const ORBITS: [(&str, &str); 2] = [
    (
        "-2.00158510637908252240537862224",
        "17.0652165601579625588917206249",
    ),
    (
        "-2.0317326295573368357302057924",
        "11.124340337266085134999734047",
    ),
];

impl Arenstorf {
    fn orbit(&self) -> (&'static str, &'static str) {
        ORBITS[self.orbit - 1]
    }
}

impl Model for Arenstorf {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let mu = Var::from(self.mu);
        let rest = 1.0 - mu;
        let distance = |x: Var| (x * x + q[1] * q[1]).sqrt();
        0.5 * (p[0] * p[0] + p[1] * p[1]) + (p[0] * q[1] - p[1] * q[0])
            - rest / distance(q[0] + mu)
            - mu / distance(q[0] - rest)
    }

    fn initial<T: Float>(&self) -> State<T> {
        let x = read::<T>("0.994");
        let (velocity, _) = self.orbit();
        (vec![x, T::int(0)], vec![T::int(0), read::<T>(velocity) + x])
    }

    fn period<T: Float>(&self, _: &State<T>) -> T {
        read(self.orbit().1)
    }

    fn step(&self) -> f64 {
        1e-4
    }

    fn end(&self) -> f64 {
        read(self.orbit().1)
    }
}
