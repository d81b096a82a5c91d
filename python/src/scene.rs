//! Scenes: named Hamiltonians with a start and a time scale.

use crate::faults::value_error;
use crate::number::Pairs;
use crate::recording::recorded::Recorded;
use crate::runs::patience::patiently;
use equip::prelude::{DoubleDouble, Hamiltonian};
use equip::scenes;
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn pairs(all: &[DoubleDouble]) -> Pairs {
    all.iter().map(|x| (x.hi(), x.lo())).unzip()
}

/// Name, meaning and default.
type Described = (&'static str, &'static str, &'static str);

/// Name and parameters of every scene.
#[pyfunction]
pub(crate) fn scene_list() -> Vec<(&'static str, Vec<Described>)> {
    let parameters = |scene: &scenes::Scene| {
        let all = scene.parameters.iter();
        all.map(|p| (p.name, p.meaning, p.default)).collect()
    };
    let all = scenes::all().iter();
    all.map(|scene| (scene.name, parameters(scene))).collect()
}

/// Operations of an H for each of its positions, about.
const OPERATIONS: usize = 50;

fn recorded(hamiltonian: &Hamiltonian) -> Recorded {
    let length = OPERATIONS * hamiltonian.degrees_of_freedom();
    Recorded::new(hamiltonian.clone(), length)
}

/// What a scene has, as a dict.
#[pyfunction]
pub(crate) fn scene<'py>(
    py: Python<'py>,
    name: &str,
    parameters: Vec<(String, String)>,
) -> PyResult<Bound<'py, PyDict>> {
    let scene = scenes::find(name).map_err(value_error)?;
    let instance = patiently(py, move |_| {
        let given = parameters.iter().map(|(k, v)| (k.as_str(), v.as_str()));
        let given: Vec<(&str, &str)> = given.collect();
        scene.instance(&given)
    })?;
    let instance = instance.map_err(value_error)?;
    let (q, p) = instance.initial::<DoubleDouble>();
    let doubles = instance.initial::<f64>();
    let dict = PyDict::new(py);
    dict.set_item("hamiltonian", recorded(instance.hamiltonian()))?;
    dict.set_item("start", doubles)?;
    dict.set_item("q", pairs(&q))?;
    dict.set_item("p", pairs(&p))?;
    dict.set_item("period", instance.period::<f64>())?;
    dict.set_item("step", instance.suggested_step())?;
    dict.set_item("end", instance.suggested_end())?;
    dict.set_item("parameters", instance.parameters().collect::<Vec<_>>())?;
    let invariants = instance.invariants().iter();
    let invariants: Vec<_> = invariants
        .map(|i| (i.name, recorded(&i.quantity)))
        .collect();
    dict.set_item("invariants", invariants)?;
    dict.set_item("title", scene.title)?;
    dict.set_item("formula", scene.formula)?;
    dict.set_item("source", scene.source)?;
    dict.set_item("solution", scene.solution)?;
    dict.set_item("hard", scene.hard)?;
    dict.set_item("units", scene.units)?;
    Ok(dict)
}
