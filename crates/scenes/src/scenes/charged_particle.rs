//! A charged particle in a plane across a magnetic field that grows with the distance.
//!
//! H = ½|p − A(q)|² + c/|q|, A = (b/3)|q|(−q₂, q₁), B = ∂₁A₂ − ∂₂A₁ = b|q|, [Qin et al., Why is Boris
//! algorithm so good?, Phys. Plasmas 20, 2013; Hairer, Lubich, Energy behaviour of the Boris method, BIT 58,
//! 2018], with b = 1, c = 1/100, q = (0, −1), q̇ = (0.1, 0.01). Both A and U are unchanged by turns, so q₁p₂
//! − q₂p₁ is kept.

use crate::entry::scene;
use crate::invariant::{Invariant, angular_momenta};
use crate::model::{Model, State, period_of};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float, ratio};

scene! {
    /// ½|p − A(q)|² + c/|q| in the field b|q|.
    pub struct ChargedParticle {
        b: Constant = "1" in closed(-1e4, 1e4), "strength of the magnetic field";
        c: Constant = "0.01" in closed(0.0, 1e3), "strength of the repelling potential";
    }
    name: "charged-particle",
    title: "Charged particle in a magnetic field",
    formula: "H = |p - A(q)|^2/2 + c/|q|, A(q) = (b/3) |q| (-q2, q1)",
    source: "Qin et al., Why is Boris algorithm so good?, Phys. Plasmas 20 (2013); Hairer, Lubich, BIT 58 (2018)",
    invariants: "canonical angular momentum q1 p2 - q2 p1 (quadratic)",
    solution: "none stored",
    hard: "not separable; b >> 1: gyration with frequency b |q| around a slow drift",
    units: "",
    period: "of the gyration at |q| = 1",
}

impl Model for ChargedParticle {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let r = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let strength = ratio(1, 3) * (self.b * r);
        let (v1, v2) = (p[0] + strength * q[1], p[1] - strength * q[0]);
        0.5 * (v1 * v1 + v2 * v2) + self.c / r
    }

    fn initial<T: Float>(&self) -> State<T> {
        // A(0, −1) = (b/3, 0).
        let p1 = T::ratio(1, 10) + self.b.to::<T>() / T::int(3);
        (vec![T::int(0), T::int(-1)], vec![p1, T::ratio(1, 100)])
    }

    /// The gyration at |q| = 1; 2π without a field.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        period_of(self.b.to())
    }

    fn step(&self) -> f64 {
        self.period(&self.initial::<f64>()) / 20.0
    }

    fn end(&self) -> f64 {
        500.0
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        angular_momenta(1, 2)
    }
}
