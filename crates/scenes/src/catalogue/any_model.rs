//! The one type that holds any scene's Hamiltonian.

use crate::error::SceneError;
use crate::invariant::Invariant;
use crate::model::{Model, State, Units, View, momenta};
use crate::scenes::{
    Arenstorf, ChargedParticle, Dnls, DoublePendulum, FaouHairerPham, Fpu, FputBeta, Harmonic,
    HenonHeiles, Kepler, LennardJones, LotkaVolterra, OuterSolarSystem, Pendulum, Pythagorean,
    Quartic, Ring, SineGordon, SpringPendulum,
};
use equip_autodiff::{BuildError, Hamiltonian};
use equip_scalar::Float;

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
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        with_model!(self, m => m.check())
    }

    pub(crate) fn record(&self) -> Result<Hamiltonian, BuildError> {
        with_model!(self, m => m.hamiltonian())
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

    pub(crate) fn units(&self) -> Units {
        with_model!(self, m => m.units())
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

    /// Masses times velocities.
    pub(crate) fn momenta<T: Float>(&self, velocities: impl Iterator<Item = T>) -> Vec<T> {
        with_model!(self, m => momenta(m, velocities))
    }
}
