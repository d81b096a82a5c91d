//! Energy-preserving integration of Hamiltonian systems y' = J∇H(y), from the scalar energy H alone.
//!
//! ```
//! use equip::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // 1. Write H, nothing else: no gradient, no Hessian. Parameters are captured as in any closure.
//! let mu = 1.0;
//! let kepler = Hamiltonian::new(2, |q, p| {
//!     0.5 * (p[0] * p[0] + p[1] * p[1]) - mu / (q[0] * q[0] + q[1] * q[1]).sqrt()
//! })?;
//!
//! // 2. Choose a method and a tolerance, and integrate from (q, p) over an interval of time.
//! let run = Equip::stages(8)
//!     .tolerance(1e-12)
//!     .integrate(&kepler, &[0.4, 0.0], &[0.0, 2.0], 0.0..=100.0)?;
//!
//! // 3. Read what was conserved: measured, not promised.
//! println!("{}", run.certificate());
//! assert!(run.certificate().energy_conserved_on_every_step());
//! # Ok(())
//! # }
//! ```
//!
//! For many runs of one system, everything that does not depend on the initial condition is prepared once:
//!
//! ```
//! # use equip::prelude::*;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
//! let mut prepared = Equip::stages(4).step(0.1).prepare(&pendulum)?;
//! for momentum in [0.5, 1.0, 1.5] {
//!     let run = prepared.integrate(&[0.0], &[momentum], 0.0..=10.0)?;
//!     assert!(run.certificate().energy_conserved_on_every_step());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! The source tree has a guide (`docs/SUMMARY.md`) and fifteen example programs (`crates/equip/examples`).
//!
//! | crate | re-exported as | contents |
//! |---|---|---|
//! | `equip-scalar` | [`scalar`] | floating-point types: `f64`, `DoubleDouble`, constants in H |
//! | `equip-tableau` | [`tableau`] | Gauss nodes, weights, K(α) |
//! | `equip-autodiff` | [`autodiff`] | H → gradient, Hessian, structure |
//! | `equip-tables` | [`tables`] | parts of H given as data or as closures |
//! | `equip-integrate` | [`integrate`] | methods, runs, events, checkpoints, certificate |
//! | `equip-scenes` | [`scenes`] | named Hamiltonians with references |
//!
//! The feature `rayon` adds ensembles over threads (`Integrator::ensemble`). With the feature `serde`,
//! checkpoints and certificates can be serialised. The default feature `sparse` factorises ∇²H of long chains
//! as sparse matrices; without it the build is shorter. The program `equip` is the package `equip-cli`.
#![forbid(unsafe_code)]

pub use equip_autodiff as autodiff;
pub use equip_integrate as integrate;
pub use equip_scalar as scalar;
pub use equip_scenes as scenes;
pub use equip_tableau as tableau;
pub use equip_tables as tables;

pub mod prelude;

/// Compiles the snippets of the page on tables and closures.
#[doc = include_str!("../../../docs/potentials-from-data.md")]
#[cfg(doctest)]
struct PotentialsPage;

/// Compiles the snippets of the page on constants.
#[doc = include_str!("../../../docs/constants.md")]
#[cfg(doctest)]
struct ConstantsPage;

/// Compiles the programs of the page of recipes.
#[doc = include_str!("../../../docs/recipes.md")]
#[cfg(doctest)]
struct RecipesPage;

/// Compiles the programs of the other chapters of the guide.
#[cfg(doctest)]
mod guide {
    #[doc = include_str!("../../../docs/first-run.md")]
    struct FirstRun;

    #[doc = include_str!("../../../docs/writing-h.md")]
    struct WritingH;

    #[doc = include_str!("../../../docs/choosing.md")]
    struct Choosing;

    #[doc = include_str!("../../../docs/brackets.md")]
    struct Brackets;

    #[doc = include_str!("../../../docs/events.md")]
    struct Events;

    #[doc = include_str!("../../../docs/ensembles.md")]
    struct Ensembles;

    #[doc = include_str!("../../../docs/adding-a-method.md")]
    struct AddingAMethod;
}

#[doc = include_str!("../../../README.md")]
#[cfg(doctest)]
struct ReadMe;
