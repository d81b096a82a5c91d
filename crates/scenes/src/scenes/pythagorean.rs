//! Burrau's Pythagorean problem of three bodies.
//!
//! Masses 3, 4, 5 at rest in the corners opposite to the sides 3, 4, 5 of a right triangle, G = 1,
//! [Szebehely, Peters, Astron. J. 72, 1967]. Order of the bodies: 5 at (1, −1), 4 at (−2, −1), 3 at (1, 3).

use super::gravity;
use crate::entry::scene;
use crate::invariant::{Invariant, all_momenta};
use crate::model::{Model, State, View};
use equip_autodiff::{BuildError, Var};
use equip_scalar::Float;

scene! {
    /// Three bodies of masses 5, 4 and 3.
    pub struct Pythagorean {}
    name: "pythagorean",
    title: "Pythagorean three bodies",
    formula: "H = |p1|^2/10 + |p2|^2/8 + |p3|^2/6 - 20/|q1 - q2| - 15/|q1 - q3| - 12/|q2 - q3|",
    source: "Szebehely, Peters, Complete solution of a general problem of three bodies, Astron. J. 72 (1967)",
    invariants: "momentum (linear) in x and y, angular momentum (quadratic)",
    solution: "reference pythagorean (t = 10)",
    hard: "close encounters: two bodies pass at 0.0004 near t = 15.83; chaotic until one body escapes near t = 60",
    units: "G = 1",
    period: "",
}

const MASSES: [i32; 3] = [5, 4, 3];

impl Model for Pythagorean {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        gravity::energy(2, Var::from(1.0), &MASSES.map(Var::from), q, p)
    }

    fn initial<T: Float>(&self) -> State<T> {
        (
            [1, -1, -2, -1, 1, 3].map(T::int).to_vec(),
            vec![T::int(0); 6],
        )
    }

    /// The unit in which G = 1.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::int(1)
    }

    fn step(&self) -> f64 {
        1e-3
    }

    fn end(&self) -> f64 {
        10.0
    }

    fn view(&self) -> View {
        View::bodies(3, 2)
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        all_momenta(3, 2)
    }

    fn mass<T: Float>(&self, component: usize) -> T {
        T::int(i64::from(MASSES[component / 2]))
    }
}
