//! [`Entry`]: how a scene describes itself.

use crate::error::SceneError;
use crate::parameter::{Parameter, Value};

/// A scene with the type of its Hamiltonian; the catalogue makes a [`Scene`](crate::Scene) of it, which says
/// what the fields are.
pub(crate) struct Entry<M> {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) formula: &'static str,
    pub(crate) source: &'static str,
    pub(crate) parameters: &'static [Parameter],
    pub(crate) invariants: &'static str,
    pub(crate) solution: &'static str,
    pub(crate) hard: &'static str,
    pub(crate) build: fn(&[Value]) -> Result<M, SceneError>,
}
