//! Hénon and Heiles' model of a star in a galaxy.
//!
//! H = (|p|² + |q|²)/2 + q₁²q₂ − q₂³/3, [Hénon, Heiles, Astron. J. 69, 1964; Hairer, Lubich, Wanner, I.3.1].
//! The start lies on the section q₁ = 0, with p₁ > 0 from the energy: p₁ = √(2E − q₂² + ⅔q₂³ − p₂²).

use crate::entry::scene;
use crate::error::SceneError;
use crate::model::{Model, State};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float, ratio};

scene! {
    /// (|p|² + |q|²)/2 + q₁²q₂ − q₂³/3.
    pub struct HenonHeiles {
        energy: Constant = "1/12" in closed(0.0, 1.0 / 6.0), "energy, at most that of the escape";
        q2: Constant = "0.3" in closed(-0.5, 1.0), "q2 of the start on the section q1 = 0";
        p2: Constant = "0.2" in closed(-0.6, 0.6), "p2 of the start";
    }
    name: "henon-heiles",
    title: "Hénon–Heiles",
    formula: "H = (p1^2 + p2^2 + q1^2 + q2^2)/2 + q1^2 q2 - q2^3/3",
    source: "Hénon, Heiles, The applicability of the third integral of motion, Astron. J. 69 (1964)",
    invariants: "none besides H",
    solution: "references hh_regular (energy 1/8, t = 1000) and henon_heiles_1_12 (t = 100)",
    hard: "energy above 1/9 mixes order and chaos; at 1/6 nearly all orbits are chaotic and h = 0.5 leaves an energy error a single alpha cannot always remove",
    units: "",
    period: "of small oscillations",
}

impl HenonHeiles {
    /// p₁² of the start.
    fn free_square<T: Float>(&self) -> T {
        let (energy, q2, p2) = (self.energy.to::<T>(), self.q2.to::<T>(), self.p2.to::<T>());
        T::int(2) * energy - q2 * q2 + T::ratio(2, 3) * q2 * q2 * q2 - p2 * p2
    }
}

impl Model for HenonHeiles {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let quadratic = 0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1]);
        quadratic + q[0] * q[0] * q[1] - ratio(1, 3) * (q[1] * q[1] * q[1])
    }

    fn initial<T: Float>(&self) -> State<T> {
        let p1 = self.free_square::<T>().max(T::int(0)).sqrt();
        (vec![T::int(0), self.q2.to()], vec![p1, self.p2.to()])
    }

    /// That of small oscillations.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi()
    }

    fn step(&self) -> f64 {
        0.25
    }

    fn end(&self) -> f64 {
        200.0
    }

    fn check(&self) -> Result<(), SceneError> {
        let (energy, free) = (self.energy.to::<f64>(), self.free_square::<f64>());
        if free < 0.0 {
            return Err(SceneError::EnergyTooLow {
                scene: SCENE.name,
                energy,
                needed: energy - free / 2.0,
            });
        }
        Ok(())
    }
}
