//! Scenes: named Hamiltonians with formula, source, parameters, invariants, exact or reference solutions, and
//! difficulties.
//!
//! [`all`] is the catalogue, and [`find`] looks up a name. [`Scene::instance`] takes parameters as text and
//! traces H. [`Instance`] has everything that a run needs, in any floating-point type.
//! [`Instance::from_reference`] has the initial state of a stored reference. The Hamiltonians themselves are
//! in [`energies`], as types with their parameters.
//!
//! ```
//! let scene = equip_scenes::find("pendulum")?;
//! let pendulum = scene.instance(&[("p", "1.5")])?;
//! let period = pendulum.period::<f64>();
//! let (q, p) = pendulum.exact(period).expect("the pendulum has a closed form");
//! assert!(q[0].abs() < 1e-14 && (p[0] - 1.5).abs() < 1e-14);
//! # Ok::<(), equip_scenes::SceneError>(())
//! ```
//!
//! This crate does not integrate. The solutions of scenes are closed forms or stored references.
#![forbid(unsafe_code)]

mod catalogue;
mod entry;
mod error;
mod invariant;
mod maths;
mod model;
mod parameter;
mod reading;
mod reference;
mod scenes;

pub use catalogue::{Instance, Reference, Scene, all, find, reference_names};
pub use error::SceneError;
pub use invariant::{Invariant, InvariantKind};
pub use model::{Units, View};
pub use parameter::{Parameter, Range};

/// The scenes' Hamiltonians as types.
pub mod energies {
    pub use crate::model::{Model, State};
    pub use crate::scenes::*;
}
