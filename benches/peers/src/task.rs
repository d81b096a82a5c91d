//! What a scene of the comparison is: the same initial data, end time and error norm for all.

use crate::problem::Problem;
use clap::ValueEnum;
use equip::prelude::*;

/// How EQUIP's steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sizes {
    /// A number of equal steps.
    Equal,
    /// By a tolerance.
    Variable,
}

/// A scene with start, end and what the end state is.
#[derive(Debug, Clone)]
pub struct Task {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Name for people.
    pub title: String,
    /// What the worker of the Python peers builds.
    pub system: &'static str,
    pub parameters: Vec<f64>,
    /// Doubles to start from, in every number type.
    pub q: Vec<f64>,
    pub p: Vec<f64>,
    /// p = m v: what the peers that compute in velocities start from.
    pub masses: Vec<f64>,
    pub end: f64,
    /// Natural periods of the fastest motion over the interval; sets where ladders of steps begin.
    pub periods: f64,
    /// EQUIP's ladders of equal steps end with so many times the steps they begin with.
    pub finest: f64,
    /// How EQUIP's steps are chosen here. Equal steps, ours and others', are left out where a close encounter
    /// makes them hopeless.
    pub sizes: &'static [Sizes],
    /// (q, p) at the end.
    pub reference: Vec<DoubleDouble>,
    /// How far the reference may be off.
    pub uncertainty: f64,
    /// Errors to be reached.
    pub targets: &'static [f64],
    /// A tolerance at which the programs that have one are compared besides.
    pub tolerance: Option<f64>,
}

/// Errors to be reached in `f64`.
pub const DOUBLE: &[f64] = &[1e-6, 1e-8, 1e-10, 1e-12];
/// Errors to be reached in double-double.
pub const EXTENDED: &[f64] = &[1e-12, 1e-15, 1e-20, 1e-25];

impl Task {
    /// The largest difference from the reference in any component of q and p.
    pub fn error(&self, end: &[DoubleDouble]) -> f64 {
        let far = |(&x, &y): (&DoubleDouble, &DoubleDouble)| (x - y).to_f64().abs();
        let error = |worst: f64, x: f64| if x <= worst { worst } else { x };
        end.iter().zip(&self.reference).map(far).fold(0.0, error)
    }

    /// v = p/m at the start, the doubles nearest to the quotients.
    pub fn velocities(&self) -> Vec<f64> {
        self.p
            .iter()
            .zip(&self.masses)
            .map(|(p, m)| p / m)
            .collect()
    }

    /// Whether it is about bodies that attract each other.
    pub fn gravity(&self) -> bool {
        matches!(self.system, "kepler" | "outer-solar-system" | "pythagorean")
    }

    /// Whether it is for number types beyond `f64`.
    pub fn extended(&self) -> bool {
        self.targets == EXTENDED
    }
}

/// What can be done with a task whatever its Hamiltonian is.
pub trait WithTask {
    /// Called with the energy of the task.
    ///
    /// # Errors
    /// What went wrong, in words.
    fn with<P: Problem>(&mut self, problem: P, task: Task) -> Result<(), String>;

    /// The same for tasks beyond `f64`: apart, as fewer programs can do them.
    ///
    /// # Errors
    /// What went wrong, in words.
    fn with_extended<P: Problem>(&mut self, problem: P, task: Task) -> Result<(), String>;
}
