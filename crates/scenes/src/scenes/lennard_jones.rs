//! Atoms with Lennard–Jones forces in the plane.
//!
//! H = ½ Σ |p_i|² + 4 Σ_{i<j} (r_ij⁻¹² − r_ij⁻⁶), in reduced units (depth and diameter 1), [Hairer, Lubich,
//! Wanner, I.4; Allen, Tildesley, Computer Simulation of Liquids]. Start: the N points of a triangular
//! lattice of spacing 2^{1/6} nearest to the origin, with seeded momenta in a square of half side `speed`
//! whose mean is taken out. Seven atoms are one atom in a hexagon, as in the frozen argon crystal.

use crate::entry::scene;
use crate::invariant::{Invariant, all_momenta};
use crate::maths::seeded::Seeded;
use crate::model::{Model, State, View};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float};

scene! {
    /// N atoms near a triangular lattice.
    pub struct LennardJones {
        n: usize = "7" in closed(2.0, 512.0), "number of atoms";
        speed: Constant = "0.2" in closed(0.0, 10.0), "largest component of the random momenta";
        seed: u64 = "1" in closed(0.0, 4_294_967_295.0), "seed of the momenta";
    }
    name: "lennard-jones",
    title: "Lennard-Jones cluster",
    formula: "H = sum |p_i|^2/2 + 4 sum_{i<j} (r^-12 - r^-6), r = |q_i - q_j|, in the plane",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.4 (frozen argon); seeded momenta are this project's",
    invariants: "momentum (linear) in x and y, angular momentum (quadratic)",
    solution: "none stored",
    hard: "speed = 10 gives an atom up to 100 times the depth of the well, against a core that rises like r^-12",
    units: "",
    period: "of two atoms about their equilibrium",
}

impl LennardJones {
    /// Lattice coordinates (i, j) of the sites i a + j b, nearest to the origin first.
    fn sites(&self) -> Vec<(i64, i64)> {
        // The disc of radius w around the origin lies in |i|, |j| ≤ 2w/√3 and holds more than 3w² sites.
        let reach = (self.n as f64 / 3.0).sqrt().ceil() as i64 + 1;
        let mut sites: Vec<_> = (-2 * reach..=2 * reach)
            .flat_map(|i| (-2 * reach..=2 * reach).map(move |j| (i, j)))
            .collect();
        sites.sort_by_key(|&(i, j)| (i * i + i * j + j * j, i, j));
        sites.truncate(self.n);
        sites
    }
}

impl Model for LennardJones {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let kinetic: Var = p.iter().map(|&p| p * p).sum();
        let mut pairs = Vec::with_capacity(self.n * self.n / 2);
        for (i, a) in q.chunks_exact(2).enumerate() {
            for b in q.chunks_exact(2).take(i) {
                let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
                let sixth = (dx * dx + dy * dy).powi(-3);
                pairs.push(sixth * sixth - sixth);
            }
        }
        0.5 * kinetic + 4.0 * pairs.into_iter().sum::<Var>()
    }

    fn initial<T: Float>(&self) -> State<T> {
        let spacing = T::int(2).sqrt().cbrt();
        let height = spacing * T::int(3).sqrt() * T::ratio(1, 2);
        let place = |(i, j): (i64, i64)| [spacing * T::ratio(2 * i + j, 2), height * T::int(j)];
        let q = self.sites().into_iter().flat_map(place).collect();

        let mut random = Seeded::new(self.seed);
        let speed = self.speed.to::<T>();
        let mut p: Vec<T> = (0..2 * self.n)
            .map(|_| speed * random.signed_unit::<T>())
            .collect();
        for axis in 0..2 {
            let sum = p
                .iter()
                .skip(axis)
                .step_by(2)
                .fold(T::int(0), |sum, &p| sum + p);
            let mean = sum / T::int(self.n as i64);
            p.iter_mut().skip(axis).step_by(2).for_each(|p| *p -= mean);
        }
        (q, p)
    }

    /// That of two atoms about their equilibrium, 2π/√(144/2^{1/3}).
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / (T::int(144) / T::int(2).cbrt()).sqrt()
    }

    fn step(&self) -> f64 {
        0.02
    }

    fn end(&self) -> f64 {
        20.0
    }

    fn view(&self) -> View {
        View::bodies(self.n, 2)
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        all_momenta(self.n, 2)
    }
}
