//! The one type that holds any scene's Hamiltonian, and [`with_model!`], by which it is used.

use crate::scenes::{
    Arenstorf, ChargedParticle, Dnls, DoublePendulum, FaouHairerPham, Fpu, FputBeta, Harmonic,
    HenonHeiles, Kepler, LennardJones, LotkaVolterra, OuterSolarSystem, Pendulum, Pythagorean,
    Quartic, Ring, SineGordon, SpringPendulum,
};

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
// The lint does not see macros that macros make.
#[allow(clippy::single_component_path_imports)]
pub(super) use with_model;
