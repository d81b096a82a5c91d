//! The catalogue of scenes, by name, and scenes with given parameters.

mod any_model;
mod instance;
mod reference;
mod scene;

pub use instance::Instance;
pub use reference::{Reference, reference_names};
pub use scene::{Scene, all, find};
