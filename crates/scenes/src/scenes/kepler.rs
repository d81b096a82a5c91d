//! Kepler's problem in the plane.
//!
//! H = |p|²/2 − μ/|q|, [Hairer, Lubich, Wanner, Geometric Numerical Integration, I.2.2]; started at the
//! pericentre of an ellipse with semi-major axis 1: q = (1 − e, 0), p = (0, √(μ(1 + e)/(1 − e))).

use crate::entry::scene;
use crate::invariant::{Invariant, InvariantKind, angular_momenta, moment};
use crate::maths::anomaly::{advance, ellipse};
use crate::model::{Model, State};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float};

scene! {
    /// |p|²/2 − μ/|q| in the plane.
    pub struct Kepler {
        e: Constant = "0.6" in below(0.0, 1.0), "eccentricity of the ellipse, started at its pericentre";
        mu: Constant = "1" in above(0.0, 1e6), "gravitational parameter";
    }
    name: "kepler",
    title: "Kepler's problem",
    formula: "H = (p1^2 + p2^2)/2 - mu/sqrt(q1^2 + q2^2)",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.2.2",
    invariants: "angular momentum (quadratic), Laplace-Runge-Lenz vector (not quadratic)",
    solution: "closed form by Kepler's equation; references kepler06_1000 and kepler09_100",
    hard: "e -> 1: at e = 0.99 the speed at the pericentre is 199 times that at the apocentre and a fixed step needs some 10^4 steps a period",
    units: "",
    period: "of the orbit",
}

impl Model for Kepler {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - self.mu / (q[0] * q[0] + q[1] * q[1]).sqrt()
    }

    fn initial<T: Float>(&self) -> State<T> {
        let (e, mu) = (self.e.to::<T>(), self.mu.to::<T>());
        let (zero, one) = (T::int(0), T::int(1));
        (
            vec![one - e, zero],
            vec![zero, (mu * (one + e) / (one - e)).sqrt()],
        )
    }

    fn period<T: Float>(&self, (q, p): &State<T>) -> T {
        ellipse(self.mu.to(), [q[0], q[1]], [p[0], p[1]])
            .map_or(T::two_pi(), |orbit| T::two_pi() / orbit.n)
    }

    fn step(&self) -> f64 {
        let e = self.e.to::<f64>();
        self.period(&self.initial::<f64>()) / 24.0 * (1.0 - e) * (1.0 - e * e).sqrt()
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        let mut all = angular_momenta(1, 2)?;
        for (name, i, sign) in [
            ("Laplace-Runge-Lenz x", 0, 1.0),
            ("Laplace-Runge-Lenz y", 1, -1.0),
        ] {
            // p × L − μ q/|q|, with L along the third axis.
            all.push(Invariant::record(name, InvariantKind::Other, 2, |q, p| {
                let r = (q[0] * q[0] + q[1] * q[1]).sqrt();
                sign * p[1 - i] * moment(q, p, 0, 1) - self.mu * q[i] / r
            })?);
        }
        Ok(all)
    }

    fn flow<T: Float>(&self, (q, p): &State<T>, t: T) -> Option<State<T>> {
        let (q, p) = advance(self.mu.to(), [q[0], q[1]], [p[0], p[1]], t)?;
        Some((q.to_vec(), p.to_vec()))
    }
}
