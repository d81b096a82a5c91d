//! [`Scene`]: an entry of the catalogue, and all of them.

use super::any_model::AnyModel;
use crate::error::SceneError;
use crate::parameter::{Parameter, Value};
use crate::scenes::{
    arenstorf, charged_particle, dnls, double_pendulum, faou_hairer_pham, fpu, fput_beta, harmonic,
    henon_heiles, kepler, lennard_jones, lotka_volterra, n_body, outer_solar_system, pendulum,
    pythagorean, quartic, sine_gordon, spring_pendulum,
};

/// The description of a named Hamiltonian; [`instance`](Scene::instance) builds it for given parameters.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    /// The name, as in `equip run kepler`.
    pub name: &'static str,
    /// The title.
    pub title: &'static str,
    /// H, as text.
    pub formula: &'static str,
    /// The source of H and its initial data.
    pub source: &'static str,
    /// Parameters with their defaults and ranges.
    pub parameters: &'static [Parameter],
    /// The invariants besides H, as text.
    pub invariants: &'static str,
    /// Closed form or stored reference, as text.
    pub solution: &'static str,
    /// The difficulties of the scene, as text.
    pub hard: &'static str,
    /// The units of length, time and mass, as text; empty without units.
    pub units: &'static str,
    /// The motion to which [`Instance::period`](crate::Instance::period) belongs, as text; empty if there is
    /// none. A unit of time then takes its place.
    pub period: &'static str,
    pub(crate) build: fn(&[Value]) -> AnyModel,
}

/// The scene of an entry whose `build` makes a Hamiltonian of its own type.
macro_rules! scene {
    ($entry:path) => {
        Scene {
            name: $entry.name,
            title: $entry.title,
            formula: $entry.formula,
            source: $entry.source,
            parameters: $entry.parameters,
            invariants: $entry.invariants,
            solution: $entry.solution,
            hard: $entry.hard,
            units: $entry.units,
            period: $entry.period,
            build: |values| ($entry.build)(values).into(),
        }
    };
}

static ALL: [Scene; 20] = [
    scene!(kepler::SCENE),
    scene!(henon_heiles::SCENE),
    scene!(pendulum::SCENE),
    scene!(quartic::SCENE),
    scene!(harmonic::SCENE),
    scene!(double_pendulum::SCENE),
    scene!(double_pendulum::STIFF),
    scene!(spring_pendulum::SCENE),
    scene!(fpu::SCENE),
    scene!(fput_beta::SCENE),
    scene!(outer_solar_system::SCENE),
    scene!(pythagorean::SCENE),
    scene!(n_body::SCENE),
    scene!(arenstorf::SCENE),
    scene!(charged_particle::SCENE),
    scene!(lennard_jones::SCENE),
    scene!(faou_hairer_pham::SCENE),
    scene!(lotka_volterra::SCENE),
    scene!(dnls::SCENE),
    scene!(sine_gordon::SCENE),
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

/// Levenshtein's distance, insertions, deletions and replacements counting one; less if one name begins the
/// other.
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
