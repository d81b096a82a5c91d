//! Uncoupled harmonic oscillators.
//!
//! H = ½ Σ (p_j² + ω_j² q_j²), ω_j = ω ρ^{j−1}. H is quadratic: every Gauss method keeps it and no α is
//! needed.

use crate::entry::scene;
use crate::invariant::{Invariant, InvariantKind, moment};
use crate::model::{Model, State};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float, Num};

scene! {
    /// ½ Σ (p_j² + ω_j² q_j²) with frequencies in geometric progression.
    pub struct Harmonic {
        m: usize = "2" in closed(1.0, 64.0), "number of oscillators";
        omega: Constant = "1" in above(0.0, 1e6), "first frequency";
        ratio: Constant = "2" in closed(0.5, 10.0), "quotient of consecutive frequencies";
    }
    name: "harmonic",
    title: "Harmonic oscillators",
    formula: "H = sum_j (p_j^2 + w_j^2 q_j^2)/2, w_j = omega ratio^(j-1)",
    source: "textbook",
    invariants: "energy of oscillator 1 and of oscillator m (quadratic); angular momentum of the first two when ratio = 1",
    solution: "closed form",
    hard: "h omega >> 1: h = 1 with omega = 10^6 must stay bounded; ratio = 10 with m = 7 spans six decades",
    units: "",
    period: "of oscillator 1",
}

impl Harmonic {
    fn frequencies<T: Float>(&self) -> Vec<T> {
        let ratio = self.ratio.to::<T>();
        std::iter::successors(Some(self.omega.to::<T>()), |&w| Some(w * ratio))
            .take(self.m)
            .collect()
    }
}

impl Model for Harmonic {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let mut omega = Var::from(self.omega);
        let mut twice = p[0] * p[0] + omega * omega * (q[0] * q[0]);
        for j in 1..self.m {
            omega *= self.ratio;
            twice += p[j] * p[j] + omega * omega * (q[j] * q[j]);
        }
        0.5 * twice
    }

    /// Even oscillators start displaced by 1, odd ones with speed 1.
    fn initial<T: Float>(&self) -> State<T> {
        let parity = |j: usize, r: usize| T::int(i64::from(j % 2 == r));
        (
            (0..self.m).map(|j| parity(j, 0)).collect(),
            (0..self.m).map(|j| parity(j, 1)).collect(),
        )
    }

    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / self.omega.to::<T>()
    }

    fn step(&self) -> f64 {
        let fastest = self.frequencies::<f64>().into_iter().fold(0.0, f64::max);
        0.25 / fastest
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        let mut all = Vec::new();
        for (name, j) in [
            ("energy of oscillator 1", 0),
            ("energy of oscillator m", self.m - 1),
        ] {
            all.push(Invariant::record(
                name,
                InvariantKind::Quadratic,
                self.m,
                |q, p| {
                    let omega = (0..j).fold(Num::from(self.omega), |w, _| w * self.ratio);
                    0.5 * (p[j] * p[j] + omega * omega * (q[j] * q[j]))
                },
            )?);
        }
        if self.m > 1 && self.ratio.to::<f64>() == 1.0 {
            let angular = |q: &[_], p: &[_]| moment(q, p, 0, 1);
            all.push(Invariant::record(
                "angular momentum",
                InvariantKind::Quadratic,
                self.m,
                angular,
            )?);
        }
        Ok(all)
    }

    fn flow<T: Float>(&self, (q, p): &State<T>, t: T) -> Option<State<T>> {
        let turned = self
            .frequencies::<T>()
            .into_iter()
            .enumerate()
            .map(|(j, omega)| {
                let (sin, cos) = (omega * t).sin_cos();
                (
                    cos * q[j] + sin * p[j] / omega,
                    cos * p[j] - omega * sin * q[j],
                )
            });
        Some(turned.unzip())
    }
}
