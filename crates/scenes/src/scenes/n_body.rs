//! A ring of equal bodies in space.
//!
//! H = Σ |p_i|²/(2m) − Σ_{i<j} m²/|q_i − q_j|, m = 1/N, G = 1, [Maxwell 1859; Meyer, Hall, Introduction to
//! Hamiltonian Dynamical Systems, relative equilibria]. A regular N-gon of radius 1 turns rigidly with Ω² =
//! (m/4) Σ_{k=1}^{N−1} 1/sin(πk/N). The start moves every position by a seeded vector in the cube of half
//! side δ; with δ = 0 the turning ring is the exact solution (unstable, though).

use super::gravity;
use crate::entry::scene;
use crate::invariant::{Invariant, all_momenta};
use crate::maths::seeded::Seeded;
use crate::model::{Model, State, View};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float, ratio};

scene! {
    /// N bodies of mass 1/N, started near a turning ring of radius 1.
    pub struct Ring {
        n: usize = "8" in closed(2.0, 256.0), "number of bodies";
        disorder: Constant = "0.01" in closed(0.0, 0.1), "largest displacement from the ring";
        seed: u64 = "1" in closed(0.0, 4_294_967_295.0), "seed of the displacements";
    }
    name: "n-body",
    title: "Ring of bodies",
    formula: "H = sum |p_i|^2/(2 m) - sum_{i<j} m^2/|q_i - q_j|, m = 1/n, in space",
    source: "Maxwell, On the stability of the motion of Saturn's rings (1859); seeded displacements are this project's",
    invariants: "momentum (linear), angular momentum (quadratic), three components each",
    solution: "closed form when disorder = 0 (unstable: round-off grows)",
    hard: "n bodies cost n^2/2 pairs; the ring is unstable and close encounters follow",
    units: "G = 1",
    period: "of the ring",
}

impl Ring {
    /// Ω.
    fn turning<T: Float>(&self) -> T {
        let n = T::int(self.n as i64);
        let inverse = |k: usize| (T::pi() * T::int(k as i64) / n).sin().recip();
        let sum = (1..self.n).fold(T::int(0), |sum, k| sum + inverse(k));
        (sum / (T::int(4) * n)).sqrt()
    }

    /// Positions of the regular ring turned by `angle`, and its momenta.
    fn rigid<T: Float>(&self, angle: T) -> State<T> {
        let n = T::int(self.n as i64);
        let speed = self.turning::<T>() / n;
        let turn = |i: usize| (angle + T::two_pi() * T::int(i as i64) / n).sin_cos();
        let zero = T::int(0);
        let q = (0..self.n)
            .map(turn)
            .flat_map(|(sin, cos)| [cos, sin, zero]);
        let p = (0..self.n)
            .map(turn)
            .flat_map(|(sin, cos)| [-speed * sin, speed * cos, zero]);
        (q.collect(), p.collect())
    }
}

impl Model for Ring {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let masses = vec![Var::from(ratio(1, self.n as i64)); self.n];
        gravity::energy(3, Var::from(1.0), &masses, q, p)
    }

    fn initial<T: Float>(&self) -> State<T> {
        let (mut q, p) = self.rigid(T::int(0));
        let disorder = self.disorder.to::<T>();
        let mut random = Seeded::new(self.seed);
        for x in &mut q {
            *x += disorder * random.signed_unit::<T>();
        }
        (q, p)
    }

    /// One turn of the ring.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / self.turning::<T>()
    }

    fn step(&self) -> f64 {
        self.period(&self.initial::<f64>()) / (20.0 * self.n as f64)
    }

    fn end(&self) -> f64 {
        self.period(&self.initial::<f64>()) / 2.0
    }

    fn view(&self) -> View {
        View::bodies(self.n, 3)
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        all_momenta(self.n, 3)
    }

    fn exact<T: Float>(&self, t: T) -> Option<State<T>> {
        let is_ring = self.disorder.to::<f64>() == 0.0;
        is_ring.then(|| self.rigid(self.turning::<T>() * t))
    }
}
