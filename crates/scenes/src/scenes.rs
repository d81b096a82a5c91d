//! The scenes, one file each.

macro_rules! scenes {
    ($($file:ident: $($name:ident),*;)*) => {
        $(
            pub(crate) mod $file;
            pub use $file::{$($name),*};
        )*
    };
}
scenes!(
    arenstorf: Arenstorf;
    charged_particle: ChargedParticle;
    dnls: Dnls;
    double_pendulum: DoublePendulum;
    faou_hairer_pham: FaouHairerPham;
    fpu: Fpu;
    fput_beta: FputBeta;
    harmonic: Harmonic;
    henon_heiles: HenonHeiles;
    kepler: Kepler;
    lennard_jones: LennardJones;
    lotka_volterra: LotkaVolterra;
    n_body: Ring;
    outer_solar_system: OuterSolarSystem;
    pendulum: Pendulum;
    pythagorean: Pythagorean;
    quartic: Quartic;
    sine_gordon: SineGordon;
    spring_pendulum: SpringPendulum;
);
mod gravity;
