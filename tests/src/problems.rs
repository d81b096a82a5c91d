//! Standard problems, written as closures; initial values in any float type.

use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{Constant, Float, decimal, ratio};

/// Initial positions and momenta.
#[derive(Debug, Clone, PartialEq)]
pub struct Start<T> {
    /// q(0), length m.
    pub q: Vec<T>,
    /// p(0), length m.
    pub p: Vec<T>,
}

impl<T: Float> Start<T> {
    fn decimals(q: &[&str], p: &[&str]) -> Self {
        let read = |texts: &[&str]| texts.iter().map(|x| T::decimal(x).unwrap()).collect();
        Start {
            q: read(q),
            p: read(p),
        }
    }

    /// (q, p) in one vector.
    pub fn state(&self) -> Vec<T> {
        self.q.iter().chain(&self.p).copied().collect()
    }
}

/// H = |p|²/2 − 1/|q| in the plane, started at the pericentre of an ellipse with semi-major axis 1, period
/// 2π.
///
/// The eccentricity is `e`/10: q = (1 − e, 0), p = (0, √((1 + e)/(1 − e))).
pub fn kepler<T: Float>(e: i64) -> (Hamiltonian, Start<T>) {
    let h = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    });
    let zero = T::int(0);
    let start = Start {
        q: vec![T::ratio(10 - e, 10), zero],
        p: vec![zero, T::ratio(10 + e, 10 - e).sqrt()],
    };
    (h.unwrap(), start)
}

/// H = p²/2 − cos q from q = 0, p = 1.
pub fn pendulum<T: Float>() -> (Hamiltonian, Start<T>) {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos());
    (h.unwrap(), Start::decimals(&["0"], &["1"]))
}

/// H = (|p|² + |q|²)/2 + q₁² q₂ − q₂³/3 from q = (0, q₂), p = (p₁, p₂) with p₁ ≥ 0 such that H = `energy`.
pub fn henon_heiles<T: Float>(energy: T, q2: &str, p2: &str) -> (Hamiltonian, Start<T>) {
    let h = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1]) + q[0] * q[0] * q[1]
            - ratio(1, 3) * q[1].powi(3)
    });
    let (q2, p2) = (T::decimal(q2).unwrap(), T::decimal(p2).unwrap());
    let two = T::int(2);
    let potential = q2 * q2 / two - q2 * q2 * q2 / T::int(3);
    let p1 = (two * (energy - potential) - p2 * p2).sqrt();
    let start = Start {
        q: vec![T::int(0), q2],
        p: vec![p1, p2],
    };
    (h.unwrap(), start)
}

/// H = (C1 P2² + C2 D² + C3 P2 D cos Q2)/(C4 − C5 cos 2Q2) − C6 cos Q1 − C7 cos(Q1 + Q2) with D = P2 − P1:
/// two unit rods with unit masses in relative angles, not separable.
pub fn double_pendulum<T: Float>() -> (Hamiltonian, Start<T>) {
    let c6 = decimal("19.6").unwrap();
    let c7 = decimal("9.8").unwrap();
    let h = Hamiltonian::new(2, |q, p| {
        let d = p[1] - p[0];
        let kinetic = -2.0 * p[1] * p[1] - d * d - 2.0 * p[1] * d * q[1].cos();
        kinetic / ((2.0 * q[1]).cos() - 3.0) - c6 * q[0].cos() - c7 * (q[0] + q[1]).cos()
    });
    (
        h.unwrap(),
        Start::decimals(&["1.1", "-1.1"], &["2.7746", "2.7746"]),
    )
}

/// H = Σ (p_i² + ω_i² q_i²)/2 with the given ω_i, from q = (1, …), p = (1/2, …): quadratic.
pub fn harmonic<T: Float>(frequencies: &[Constant]) -> (Hamiltonian, Start<T>) {
    let m = frequencies.len();
    let h = Hamiltonian::new(m, |q, p| {
        (0..m)
            .map(|i| 0.5 * (p[i] * p[i] + (frequencies[i] * q[i]).powi(2)))
            .sum::<Var>()
    });
    let start = Start {
        q: vec![T::int(1); m],
        p: vec![T::ratio(1, 2); m],
    };
    (h.unwrap(), start)
}
