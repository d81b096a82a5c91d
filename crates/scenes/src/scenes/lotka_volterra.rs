//! Lotka and Volterra's prey and predators in logarithmic variables.
//!
//! u̇ = u(v − b), v̇ = v(a − u) with q = ln u, p = ln v comes from H = eᵖ − bp + e^q − aq, [Hairer, Lubich,
//! Wanner, I.1.1], which is separable and no polynomial in either part.

use crate::entry::scene;
use crate::model::{Model, State};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// eᵖ − bp + e^q − aq.
    pub struct LotkaVolterra {
        a: Constant = "1" in above(0.0, 1e3), "equilibrium of u";
        b: Constant = "2" in above(0.0, 1e3), "equilibrium of v";
        u: Constant = "2" in above(0.0, 1e3), "u at the start";
        v: Constant = "2" in above(0.0, 1e3), "v at the start";
    }
    name: "lotka-volterra",
    title: "Lotka–Volterra in logarithms",
    formula: "H = exp(p) - b p + exp(q) - a q, q = ln u, p = ln v",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.1",
    invariants: "none besides H",
    solution: "none stored",
    hard: "starts far from the equilibrium: from u = v = 1000, q falls to about -1978 between outbreaks, where exp(q) is 0 in f64",
    units: "",
    period: "of small oscillations",
}

impl Model for LotkaVolterra {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        (p[0].exp() - self.b * p[0]) + (q[0].exp() - self.a * q[0])
    }

    fn initial<T: Float>(&self) -> State<T> {
        (vec![self.u.to::<T>().ln()], vec![self.v.to::<T>().ln()])
    }

    /// That of small oscillations, 2π/√(ab).
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / (self.a.to::<T>() * self.b.to::<T>()).sqrt()
    }

    fn step(&self) -> f64 {
        0.1 / self.u.to::<f64>().max(self.v.to::<f64>()).max(1.0)
    }
}
