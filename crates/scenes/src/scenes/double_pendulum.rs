//! The double pendulum, plain and with a stiff spring between its rods.
//!
//! In Q = (θ₁, θ₂ − θ₁) and its momenta, [Antoñana, Makazaga, Murua, Numer. Algorithms 76 (2017) and 78
//! (2018)]:
//!
//! H = (C₁P₂² + C₂D² + C₃P₂D cos Q₂)/(C₄ − C₅ cos 2Q₂) − C₆ cos Q₁ − C₇ cos(Q₁ + Q₂) + ½C²Q₂²,   D = P₂ − P₁,
//!
//! C₁ = l₁²(m₁ + m₂), C₂ = l₂²m₂, C₃ = 2l₁l₂m₂, C₄ = l₁²l₂²m₂(2m₁ + m₂), C₅ = l₁²l₂²m₂², C₆ = gl₁(m₁ + m₂),
//! C₇ = gl₂m₂, here with unit masses and lengths. H is not separable. The stiff start has Q₂ = −1.1/√(1 +
//! 100C²).

use crate::entry::Entry;
use crate::invariant::{Invariant, InvariantKind};
use crate::model::{Model, State};
use crate::parameter::{Parameter, Range};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float, ratio};

/// Two unit rods with unit masses, and a spring ½C²Q₂² between them.
#[derive(Debug, Clone, Copy)]
pub struct DoublePendulum {
    /// Starting angles and momenta Q₁, Q₂, P₁, P₂; Q₂ is divided by √(1 + 100C²).
    pub start: [Constant; 4],
    /// Acceleration of gravity.
    pub g: Constant,
    /// Root C of the spring's stiffness; none for no spring.
    pub spring: Option<Constant>,
}

const MOMENTUM: Range = Range::closed(-100.0, 100.0);
const GRAVITY: Parameter = Parameter::real(
    "g",
    "acceleration of gravity",
    "9.8",
    Range::closed(0.0, 1e4),
);

pub(crate) const SCENE: Entry<DoublePendulum> = Entry {
    name: "double-pendulum",
    title: "Double pendulum",
    formula: "H = (2 P2^2 + D^2 + 2 P2 D cos Q2)/(3 - cos 2Q2) - 2 g cos Q1 - g cos(Q1 + Q2), D = P2 - P1",
    source: "Antoñana, Makazaga, Murua, Reducing and monitoring round-off error propagation for symplectic implicit Runge-Kutta schemes, Numer. Algorithms 76 (2017)",
    parameters: &[
        Parameter::real(
            "q1",
            "starting angle of the first rod",
            "1.1",
            Range::angle(),
        ),
        Parameter::real(
            "q2",
            "starting angle of the second rod against the first",
            "-1.1",
            Range::angle(),
        ),
        Parameter::real("p1", "starting momentum of Q1", "2.7746", MOMENTUM),
        Parameter::real("p2", "starting momentum of Q2", "2.7746", MOMENTUM),
        GRAVITY,
    ],
    invariants: "none besides H; the angular momentum P1 (linear) when g = 0",
    solution: "reference double_pendulum (t = 16)",
    hard: "not separable; q1 = q2 = p1 = 0, p2 = 3.873 is the chaotic start of the source",
    units: "",
    period: "of one pendulum of unit length",
    build: |v| DoublePendulum {
        start: [0, 1, 2, 3].map(|i| v[i].exact),
        g: v[4].exact,
        spring: None,
    },
};

pub(crate) const STIFF: Entry<DoublePendulum> = Entry {
    name: "stiff-double-pendulum",
    title: "Double pendulum with a stiff spring",
    formula: "H = (2 P2^2 + D^2 + 2 P2 D cos Q2)/(3 - cos 2Q2) - 2 g cos Q1 - g cos(Q1 + Q2) + C^2 Q2^2/2, D = P2 - P1",
    source: "Antoñana, Makazaga, Murua, Efficient implementation of symplectic implicit Runge-Kutta schemes with simplified Newton iterations, Numer. Algorithms 78 (2018)",
    parameters: &[
        Parameter::real(
            "c",
            "root C of the stiffness",
            "32",
            Range::closed(0.0, 1e6),
        ),
        GRAVITY,
    ],
    invariants: "none besides H; the angular momentum P1 (linear) when g = 0",
    solution: "none stored",
    hard: "C -> infinity: fast frequency near 2.2 C, so h = 2^-7 gives h omega = 0.6 at C = 32 and 18 at C = 1024; not separable",
    units: "",
    period: "of one pendulum of unit length",
    build: |v| {
        let momentum = ratio(27_746, 10_000);
        let start = [ratio(11, 10), ratio(-11, 10), momentum, momentum];
        DoublePendulum {
            start,
            g: v[1].exact,
            spring: Some(v[0].exact),
        }
    },
};

impl Model for DoublePendulum {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let d = p[1] - p[0];
        let kinetic = (2.0 * (p[1] * p[1]) + d * d + 2.0 * (p[1] * d * q[1].cos()))
            / (3.0 - (2.0 * q[1]).cos());
        let potential = self.g * (2.0 * q[0].cos() + (q[0] + q[1]).cos());
        match self.spring {
            None => kinetic - potential,
            Some(c) => {
                let stretch = c * q[1];
                kinetic - potential + 0.5 * (stretch * stretch)
            }
        }
    }

    fn initial<T: Float>(&self) -> State<T> {
        let [q1, q2, p1, p2] = self.start.map(|c| c.to::<T>());
        let q2 = match self.spring {
            None => q2,
            Some(c) => q2 / (T::int(1) + T::int(100) * c.to::<T>() * c.to::<T>()).sqrt(),
        };
        (vec![q1, q2], vec![p1, p2])
    }

    /// That of one pendulum of unit length; 1 without gravity.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        let g = self.g.to::<T>();
        if g > T::int(0) {
            T::two_pi() / g.sqrt()
        } else {
            T::int(1)
        }
    }

    fn step(&self) -> f64 {
        1.0 / 64.0
    }

    fn end(&self) -> f64 {
        16.0
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        if self.g.to::<f64>() != 0.0 {
            return Ok(Vec::new());
        }
        Invariant::record("angular momentum", InvariantKind::Linear, 2, |_, p| p[0])
            .map(|i| vec![i])
    }
}
