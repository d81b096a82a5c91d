//! The native part of the Python package `equip`: recording of a Python callable, evaluation, runs.
#![allow(missing_docs)] // What Python sees is documented in the package.

mod faults;
mod number;
mod options;
mod recording;
mod runs;
mod scene;

use pyo3::prelude::*;
use recording::{condition, constant, recorded, table, variable};
use runs::{between, claim, curve, ensemble, run, steps};

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add(
        "IntegrationError",
        py.get_type::<faults::IntegrationError>(),
    )?;
    module.add("FileFormatError", py.get_type::<faults::FileFormatError>())?;
    module.add("FileInUseError", py.get_type::<faults::FileInUseError>())?;
    module.add_class::<claim::Claim>()?;
    module.add_class::<variable::Variable>()?;
    module.add_class::<condition::Condition>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<recorded::Recorded>()?;
    module.add_class::<curve::Curve>()?;
    module.add_class::<steps::Steps>()?;
    module.add_function(wrap_pyfunction!(constant::split, module)?)?;
    module.add_function(wrap_pyfunction!(constant::decimal_text, module)?)?;
    module.add_function(wrap_pyfunction!(scene::scene, module)?)?;
    module.add_function(wrap_pyfunction!(scene::scene_list, module)?)?;
    module.add_function(wrap_pyfunction!(steps::suggest_step, module)?)?;
    module.add_function(wrap_pyfunction!(ensemble::ensemble, module)?)?;
    module.add_function(wrap_pyfunction!(ensemble::draw_starts, module)?)?;
    module.add_function(wrap_pyfunction!(between::between, module)?)?;
    module.add_function(wrap_pyfunction!(run::solve, module)?)
}
