//! The errors of a request for a scene.

use crate::parameter::Range;
use equip_autodiff::BuildError;

/// An invalid request for a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// No scene has this name.
    #[error("there is no scene `{name}`; the nearest names are {}", .nearest.join(", "))]
    UnknownScene {
        /// The requested name.
        name: String,
        /// Known names, nearest first.
        nearest: Vec<&'static str>,
    },
    /// No reference solution has this name.
    #[error("there is no reference solution `{name}`; the known ones are {}", .known.join(", "))]
    UnknownReference {
        /// The requested name.
        name: String,
        /// All known names.
        known: Vec<&'static str>,
    },
    /// The scene has no such parameter.
    #[error("the scene {scene} has no parameter `{name}`; {}", allowed(.known))]
    UnknownParameter {
        /// The scene.
        scene: &'static str,
        /// The name given.
        name: String,
        /// The parameters the scene has.
        known: Vec<&'static str>,
    },
    /// A parameter was given more than once.
    #[error("the parameter {parameter} of {scene} was given twice; give it once")]
    GivenTwice {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        parameter: &'static str,
    },
    /// The text is not a number.
    #[error(
        "`{text}` is not a value for {parameter} of {scene}; write a decimal like 0.6 or 1e-3, or a quotient like 1/12"
    )]
    NotANumber {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The text given.
        text: String,
    },
    /// The parameter counts something.
    #[error("{parameter} of {scene} must be a whole number in {range}, not `{text}`")]
    NotAnInteger {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The text given.
        text: String,
        /// What is allowed.
        range: Range,
    },
    /// The value is outside the range of the parameter.
    #[error("{parameter} = {text} of {scene} is out of range; choose a value in {range}")]
    OutOfRange {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// The text given.
        text: String,
        /// What is allowed.
        range: Range,
    },
    /// The starting point lies where the energy asked for cannot reach.
    #[error(
        "{scene} cannot start there with energy {energy}: the start alone takes {needed}; raise the energy or move the start towards the origin"
    )]
    EnergyTooLow {
        /// The scene.
        scene: &'static str,
        /// The requested energy.
        energy: f64,
        /// The energy of the starting point with the free momentum zero.
        needed: f64,
    },
    /// H or an invariant could not be recorded.
    #[error(transparent)]
    Recording(#[from] BuildError),
}

fn allowed(names: &[&str]) -> String {
    match names {
        [] => "it has none".into(),
        names => format!("it has {}", names.join(", ")),
    }
}
