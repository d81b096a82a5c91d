//! Versions of the programs that are compared.

use crate::contestants::python::Worker;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::rc::Rc;

const LOCK: &str = include_str!("../Cargo.lock");

/// The version of a crate this program was built with.
fn of(name: &str) -> Option<&'static str> {
    let (_, rest) = LOCK.split_once(&format!("name = \"{name}\"\nversion = \""))?;
    rest.split('"').next()
}

/// All programs by name.
pub fn of_all(worker: Option<&Rc<RefCell<Worker>>>) -> Value {
    let mut all = json!({});
    for (program, name) in [
        ("equip", "equip-ode"),
        ("ode_solvers", "ode_solvers"),
        ("differential-equations", "differential-equations"),
        ("diffsol", "diffsol"),
    ] {
        all[program] = json!(of(name));
    }
    let python = worker.and_then(|w| w.borrow_mut().versions().ok());
    if let (Some(all), Some(Value::Object(python))) = (all.as_object_mut(), python) {
        all.extend(python);
    }
    all
}
