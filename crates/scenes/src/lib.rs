//! Named Hamiltonians: formula, source, parameters, invariants, exact or reference solutions, hard range.
//!
//! [`all`] is the catalogue, [`find`] looks up a name, [`Scene::instance`] fills in parameters given as text and records H, and
//! [`Instance`] has everything a run needs, in any float type. [`Instance::from_reference`] starts where a stored reference started.
//! The Hamiltonians themselves are in [`energies`], as types that implement
//! [`Energy`](equip_autodiff::Energy), for code that wants them compiled and not recorded.
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
//! What it does not do: integrate. Scenes know their solutions only in closed form or from the table of references.
#![forbid(unsafe_code)]

mod anomaly;
mod decimal_text;
mod elliptic;
mod error;
mod instance;
mod invariant;
mod model;
mod parameter;
mod reference;
mod references;
mod scene;
mod scenes;
mod seeded;

pub use error::SceneError;
pub use instance::{Instance, View};
pub use invariant::{Invariant, InvariantKind};
pub use parameter::{Parameter, Range};
pub use reference::{Reference, reference_names};
pub use scene::Scene;

/// The scenes' Hamiltonians as types.
pub mod energies {
    pub use crate::scenes::*;
}

use scenes::*;

static ALL: [Scene; 20] = [
    kepler::SCENE,
    henon_heiles::SCENE,
    pendulum::SCENE,
    quartic::SCENE,
    harmonic::SCENE,
    double_pendulum::SCENE,
    double_pendulum::STIFF,
    spring_pendulum::SCENE,
    fpu::SCENE,
    fput_beta::SCENE,
    outer_solar_system::SCENE,
    pythagorean::SCENE,
    n_body::SCENE,
    arenstorf::SCENE,
    charged_particle::SCENE,
    lennard_jones::SCENE,
    faou_hairer_pham::SCENE,
    lotka_volterra::SCENE,
    dnls::SCENE,
    sine_gordon::SCENE,
];

/// The catalogue.
pub fn all() -> &'static [Scene] {
    &ALL
}

/// How many names an error suggests.
const SUGGESTIONS: usize = 3;

/// The scene of that name.
///
/// # Errors
/// [`SceneError::UnknownScene`], with the nearest known names.
pub fn find(name: &str) -> Result<&'static Scene, SceneError> {
    ALL.iter().find(|scene| scene.name == name).ok_or_else(|| {
        let mut nearest: Vec<_> = ALL.iter().map(|scene| scene.name).collect();
        nearest.sort_by_key(|known| distance(name, known));
        nearest.truncate(SUGGESTIONS);
        SceneError::UnknownScene {
            name: name.into(),
            nearest,
        }
    })
}

/// Levenshtein's distance, insertions, deletions and replacements counting one; less if one name begins the other.
fn distance(a: &str, b: &str) -> usize {
    if !a.is_empty() && (a.starts_with(b) || b.starts_with(a)) {
        return 0;
    }
    let mut row: Vec<usize> = (0..=b.chars().count()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.chars().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row.last().copied().unwrap_or(0)
}
