//! What every scene's Hamiltonian says of itself, and the one type that holds any of them.

use crate::scenes::*;
use crate::{Invariant, View};
use equip_autodiff::{BuildError, Energy, Hamiltonian};
use equip_scalar::Float;

/// Positions q and momenta p.
pub(crate) type State<T> = (Vec<T>, Vec<T>);

/// A Hamiltonian with its start, its time scale and what is known of its solutions.
pub(crate) trait Model: Energy {
    /// The state at t = 0, computed in `T`.
    fn initial<T: Float>(&self) -> State<T>;

    /// The natural unit of time of the solution through `start`.
    fn period<T: Float>(&self, start: &State<T>) -> T;

    /// A fixed step that resolves the motion.
    fn step(&self) -> f64;

    /// An end time worth a picture.
    fn end(&self) -> f64;

    /// What to draw.
    fn view(&self) -> View;

    /// Quantities kept besides H.
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

macro_rules! models {
    ($($name:ident),* $(,)?) => {
        /// Any of the scenes' Hamiltonians.
        #[derive(Debug, Clone)]
        pub(crate) enum AnyModel {
            $($name($name),)*
        }

        $(impl From<$name> for AnyModel {
            fn from(model: $name) -> Self {
                AnyModel::$name(model)
            }
        })*

        /// One expression for whichever model it is.
        macro_rules! with_model {
            ($any:expr, $model:ident => $body:expr) => {
                match $any {
                    $(AnyModel::$name($model) => $body,)*
                }
            };
        }
    };
}
models!(
    Arenstorf,
    ChargedParticle,
    Dnls,
    DoublePendulum,
    FaouHairerPham,
    Fpu,
    FputBeta,
    Harmonic,
    HenonHeiles,
    Kepler,
    LennardJones,
    LotkaVolterra,
    OuterSolarSystem,
    Pendulum,
    Pythagorean,
    Quartic,
    Ring,
    SineGordon,
    SpringPendulum,
);

impl AnyModel {
    pub(crate) fn record(&self) -> Result<Hamiltonian, BuildError> {
        with_model!(self, m => Hamiltonian::new(m.degrees_of_freedom(), |q, p| m.energy(q, p)))
    }

    pub(crate) fn initial<T: Float>(&self) -> State<T> {
        with_model!(self, m => m.initial())
    }

    pub(crate) fn period<T: Float>(&self, start: &State<T>) -> T {
        with_model!(self, m => m.period(start))
    }

    pub(crate) fn step(&self) -> f64 {
        with_model!(self, m => m.step())
    }

    pub(crate) fn end(&self) -> f64 {
        with_model!(self, m => m.end())
    }

    pub(crate) fn view(&self) -> View {
        with_model!(self, m => m.view())
    }

    pub(crate) fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        with_model!(self, m => m.invariants())
    }

    pub(crate) fn flow<T: Float>(&self, start: &State<T>, t: T) -> Option<State<T>> {
        with_model!(self, m => m.flow(start, t))
    }

    pub(crate) fn exact<T: Float>(&self, t: T) -> Option<State<T>> {
        with_model!(self, m => m.exact(t))
    }

    pub(crate) fn mass<T: Float>(&self, component: usize) -> T {
        with_model!(self, m => m.mass(component))
    }
}
