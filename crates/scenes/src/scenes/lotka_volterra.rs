//! Lotka and Volterra's prey and predators in logarithmic variables.
//!
//! u̇ = u(v − b), v̇ = v(a − u) with q = ln u, p = ln v comes from H = eᵖ − bp + e^q − aq, [Hairer, Lubich,
//! Wanner, I.1.1], which is separable and no polynomial in either part.

use crate::entry::Entry;
use crate::model::{Model, State, View};
use crate::parameter::{Parameter, Range};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

/// eᵖ − bp + e^q − aq.
#[derive(Debug, Clone, Copy)]
pub struct LotkaVolterra {
    /// Equilibrium a of u.
    pub a: Constant,
    /// Equilibrium b of v.
    pub b: Constant,
    /// u at the start.
    pub u: Constant,
    /// v at the start.
    pub v: Constant,
}

const POSITIVE: Range = Range::above(0.0, 1e3);

pub(crate) const SCENE: Entry<LotkaVolterra> = Entry {
    name: "lotka-volterra",
    title: "Lotka–Volterra in logarithms",
    formula: "H = exp(p) - b p + exp(q) - a q, q = ln u, p = ln v",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.1",
    parameters: &[
        Parameter::real("a", "equilibrium of u", "1", POSITIVE),
        Parameter::real("b", "equilibrium of v", "2", POSITIVE),
        Parameter::real("u", "u at the start", "2", POSITIVE),
        Parameter::real("v", "v at the start", "2", POSITIVE),
    ],
    invariants: "none besides H",
    solution: "none stored",
    hard: "starts far from the equilibrium: from u = v = 1000, q falls to about -1978 between outbreaks, where exp(q) is 0 in f64",
    build: |v| {
        let [a, b, u, v] = [0, 1, 2, 3].map(|i| v[i].exact);
        Ok(LotkaVolterra { a, b, u, v })
    },
};

impl Model for LotkaVolterra {
    fn degrees_of_freedom(&self) -> usize {
        1
    }

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

    fn end(&self) -> f64 {
        10.0 * self.period(&self.initial::<f64>())
    }

    fn view(&self) -> View {
        View::PhasePlane
    }
}
