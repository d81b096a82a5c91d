//! The Sun and the outer planets.
//!
//! H = Σ |p_i|²/(2m_i) − G Σ_{i<j} m_i m_j/|q_i − q_j|, [Hairer, Lubich, Wanner, I.2.4, Table 2.2]: Sun with
//! the inner planets, Jupiter, Saturn, Uranus, Neptune, Pluto, on 5 September 1994 in heliocentric
//! coordinates; astronomical units, days, m in solar masses. The data are the doubles nearest to the table's
//! decimals in every float type, and m_i = (G m_i)/G from the doubles of the products G m_i, so that the
//! stored reference fits to its last digit.

use super::gravity;
use crate::entry::scene;
use crate::invariant::{Invariant, all_momenta};
use crate::model::{Model, State, Units, View, momenta};
use equip_autodiff::{BuildError, Var};
use equip_scalar::Float;

scene! {
    /// The Sun and its first outer planets.
    pub struct OuterSolarSystem {
        planets: usize = "5" in closed(1.0, 5.0), "planets taken, in the order Jupiter, Saturn, Uranus, Neptune, Pluto";
    }
    name: "outer-solar-system",
    title: "Outer solar system",
    formula: "H = sum |p_i|^2/(2 m_i) - G sum_{i<j} m_i m_j/|q_i - q_j|",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.2.4",
    invariants: "momentum (linear), angular momentum (quadratic), three components each",
    solution: "reference outer_ss (t = 200000 days)",
    hard: "masses from 1 to 8e-9 and |H| = 3e-8: the energy's round-off level lies near 1e-23",
    units: "astronomical units, days, solar masses",
    period: "of Jupiter",
}

/// G in au³/(day² solar mass).
const G: f64 = 0.000295912208286;

/// G m of each body.
const GM: [f64; 6] = [
    0.00029591397690000476,
    2.825328644881507e-07,
    8.450771312727215e-08,
    1.293944677450143e-08,
    1.532112500187004e-08,
    2.276247756046154e-12,
];

/// Positions in au.
const Q: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [-3.5023653, -3.8169847, -1.5507963],
    [9.0755314, -3.0458353, -1.6483708],
    [8.310142, -16.2901086, -7.2521278],
    [11.4707666, -25.7294829, -10.8169456],
    [-15.5387357, -25.2225594, -3.1902382],
];

/// Velocities in au/day.
const V: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [0.00565429, -0.0041249, -0.00190589],
    [0.00168318, 0.00483525, 0.00192462],
    [0.00354178, 0.00137102, 0.00055029],
    [0.0028893, 0.00114527, 0.00039677],
    [0.00276725, -0.00170702, -0.00136504],
];

impl OuterSolarSystem {
    fn bodies(&self) -> usize {
        self.planets + 1
    }
}

impl Model for OuterSolarSystem {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let gravity = Var::from(G);
        let masses: Vec<_> = GM
            .iter()
            .take(self.bodies())
            .map(|&gm| Var::from(gm) / gravity)
            .collect();
        gravity::energy(3, gravity, &masses, q, p)
    }

    fn initial<T: Float>(&self) -> State<T> {
        let first = |all: &[[f64; 3]; 6]| all[..self.bodies()].as_flattened().to_vec();
        let q = first(&Q).into_iter().map(T::exact).collect();
        (q, momenta(self, first(&V).into_iter().map(T::exact)))
    }

    /// Jupiter's year, in days.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::ratio(43326, 10)
    }

    fn step(&self) -> f64 {
        200.0
    }

    fn end(&self) -> f64 {
        200_000.0
    }

    fn units(&self) -> Units {
        Units {
            length: "AU",
            time: "days",
        }
    }

    fn view(&self) -> View {
        View::bodies(self.bodies(), 3)
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        all_momenta(self.bodies(), 3)
    }

    fn mass<T: Float>(&self, component: usize) -> T {
        T::exact(GM[component / 3]) / T::exact(G)
    }
}
