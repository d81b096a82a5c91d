//! The properties of the Hamiltonian of a scene.

use crate::error::SceneError;
use crate::invariant::Invariant;
use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_scalar::Float;

/// Positions q and momenta p.
pub type State<T> = (Vec<T>, Vec<T>);

/// The type of picture of a solution.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum View {
    /// One degree of freedom: p against q.
    PhasePlane,
    /// Paths in a plane: for each body the two components of q that are drawn.
    Paths(Vec<(usize, usize)>),
    /// Many degrees of freedom in a row: q_i against i, or against time.
    Profile,
}

impl View {
    /// The paths of bodies in `d` dimensions, seen along the last axis of three.
    pub(crate) fn bodies(number: usize, d: usize) -> Self {
        View::Paths((0..number).map(|b| (d * b, d * b + 1)).collect())
    }

    /// The profile of `n` degrees of freedom in a row, or the phase plane of one.
    pub(crate) fn row(n: usize) -> Self {
        match n {
            1 => View::PhasePlane,
            _ => View::Profile,
        }
    }
}

/// The names of the units of a scene, for the axes of pictures; empty for dimensionless quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units {
    /// Of positions.
    pub length: &'static str,
    /// Of time.
    pub time: &'static str,
}

/// A Hamiltonian with its initial state, its time scale and its known solutions.
pub trait Model {
    /// Number m of positions, and of momenta: that of the initial state.
    fn degrees_of_freedom(&self) -> usize {
        self.initial::<f64>().0.len()
    }

    /// H(q, p); both slices have length m.
    fn energy(&self, q: &[Var], p: &[Var]) -> Var;

    /// H, recorded.
    ///
    /// # Errors
    /// [`BuildError`] where a parameter makes H infinite or no number.
    fn hamiltonian(&self) -> Result<Hamiltonian, BuildError> {
        Hamiltonian::new(self.degrees_of_freedom(), |q, p| self.energy(q, p))
    }

    /// The state at t = 0, computed in `T`.
    fn initial<T: Float>(&self) -> State<T>;

    /// The natural unit of time of the solution through `start`.
    fn period<T: Float>(&self, start: &State<T>) -> T;

    /// A fixed step that resolves the motion.
    fn step(&self) -> f64;

    /// An end time worth a picture: ten periods, unless the scene knows better.
    fn end(&self) -> f64 {
        10.0 * self.period(&self.initial::<f64>())
    }

    /// What to draw: the phase plane of one degree of freedom, else the path of the first two positions.
    fn view(&self) -> View {
        match self.degrees_of_freedom() {
            1 => View::PhasePlane,
            _ => View::Paths(vec![(0, 1)]),
        }
    }

    /// Whether there is a start with these parameters.
    ///
    /// # Errors
    /// [`SceneError`], with what to change.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// The units that its numbers are in.
    fn units(&self) -> Units {
        Units::default()
    }

    /// Quantities conserved besides H.
    ///
    /// # Errors
    /// As [`hamiltonian`](Self::hamiltonian).
    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        Ok(Vec::new())
    }

    /// The state a time `t` after any `start`, where a closed form is known.
    fn flow<T: Float>(&self, _start: &State<T>, _t: T) -> Option<State<T>> {
        None
    }

    /// The state at time `t` from the scene's own start, where a closed form is known.
    fn exact<T: Float>(&self, t: T) -> Option<State<T>> {
        self.flow(&self.initial(), t)
    }

    /// The mass in p = m v of the given component.
    fn mass<T: Float>(&self, _component: usize) -> T {
        T::int(1)
    }
}

/// The period 2π/ω of a frequency ω; 2π if it vanishes.
pub(crate) fn period_of<T: Float>(omega: T) -> T {
    if omega == T::int(0) {
        T::two_pi()
    } else {
        T::two_pi() / omega.abs()
    }
}

/// Every component of q times `q_factor` and of q times `p_factor`, as positions and momenta.
pub(crate) fn scaled<T: Float>(q: &[T], q_factor: T, p_factor: T) -> State<T> {
    let times = |factor: T| q.iter().map(|&q| q * factor).collect();
    (times(q_factor), times(p_factor))
}

/// Masses times velocities.
pub(crate) fn momenta<T: Float>(model: &impl Model, velocities: impl Iterator<Item = T>) -> Vec<T> {
    let momentum = |(i, v)| model.mass::<T>(i) * v;
    velocities.enumerate().map(momentum).collect()
}

/// A decimal that stands in the source; were it none, not a number.
pub(crate) fn read<T: Float>(text: &str) -> T {
    T::decimal(text).unwrap_or(T::NAN)
}
