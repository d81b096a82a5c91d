//! A mass on a stiff spring under gravity, in the plane.
//!
//! H = ½|p|² + g q₂ + ½k(|q| − 1)², [Ascher, Reich, On some difficulties in integrating highly oscillatory
//! Hamiltonian systems, 1999]. Start: horizontal, the spring stretched so that the centrifugal force of the
//! speed 1 balances it to first order, q = (1 + 1/k, 0), p = (0, −1): little energy in the fast motion at any
//! k.

use crate::entry::scene;
use crate::invariant::{Invariant, angular_momenta};
use crate::model::{Model, State};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float};

scene! {
    /// ½|p|² + g q₂ + ½k(|q| − 1)².
    pub struct SpringPendulum {
        k: Constant = "10000" in closed(1.0, 1e12), "stiffness of the spring";
        g: Constant = "1" in closed(0.0, 1e3), "acceleration of gravity";
    }
    name: "spring-pendulum",
    title: "Stiff spring pendulum",
    formula: "H = |p|^2/2 + g q2 + k (|q| - 1)^2/2",
    source: "Ascher, Reich, On some difficulties in integrating highly oscillatory Hamiltonian systems, LNCSE 4 (1999)",
    invariants: "none besides H; angular momentum when g = 0",
    solution: "none stored",
    hard: "k -> infinity: fast frequency sqrt(k), h = 0.1 gives h omega = 10 at the default and 10^5 at k = 10^12",
    units: "",
    period: "of the spring",
}

impl Model for SpringPendulum {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let stretch = (q[0] * q[0] + q[1] * q[1]).sqrt() - 1.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) + self.g * q[1] + 0.5 * (self.k * (stretch * stretch))
    }

    fn initial<T: Float>(&self) -> State<T> {
        let (zero, one) = (T::int(0), T::int(1));
        (vec![one + self.k.to::<T>().recip(), zero], vec![zero, -one])
    }

    /// That of the spring.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / self.k.to::<T>().sqrt()
    }

    fn step(&self) -> f64 {
        1.0 / self.k.to::<f64>().sqrt()
    }

    fn end(&self) -> f64 {
        20.0
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        if self.g.to::<f64>() == 0.0 {
            angular_momenta(1, 2)
        } else {
            Ok(Vec::new())
        }
    }
}
