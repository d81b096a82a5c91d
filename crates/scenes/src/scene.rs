//! [`Scene`]: an entry of the catalogue.

use crate::model::AnyModel;
use crate::parameter::{Value, read_all};
use crate::{Instance, Parameter, SceneError};

/// A named Hamiltonian, described; [`instance`](Self::instance) builds it for given parameters.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    /// Name, as in `equip run kepler`.
    pub name: &'static str,
    /// Title, for people.
    pub title: &'static str,
    /// H, as text.
    pub formula: &'static str,
    /// Where H and its initial data come from.
    pub source: &'static str,
    /// Parameters with their defaults and ranges.
    pub parameters: &'static [Parameter],
    /// What is kept besides H, as text.
    pub invariants: &'static str,
    /// Closed form or stored reference, as text.
    pub solution: &'static str,
    /// Where the scene becomes hard, in words and numbers.
    pub hard: &'static str,
    pub(crate) build: fn(&[Value]) -> Result<AnyModel, SceneError>,
}

impl Scene {
    /// The scene with the given parameter values, the others at their defaults.
    ///
    /// Values are text, a decimal or a quotient of integers, so that a run in double-double reads `0.1` as 1/10.
    ///
    /// ```
    /// let kepler = equip_scenes::find("kepler")?.instance(&[("e", "0.9")])?;
    /// let (q, p) = kepler.initial::<f64>();
    /// assert!((q[0] - 0.1).abs() < 1e-16 && (p[1] - 19.0_f64.sqrt()).abs() < 1e-14);
    /// # Ok::<(), equip_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`], naming what is allowed, for a parameter that is unknown, given twice, not a number, not a
    /// whole number where one is asked for, or out of range.
    pub fn instance(&'static self, values: &[(&str, &str)]) -> Result<Instance, SceneError> {
        let values = read_all(self.name, self.parameters, values)?;
        let model = (self.build)(&values)?;
        Instance::new(self, values, model, None)
    }
}
