//! Rust crates: ode_solvers, differential-equations, diffsol.

use crate::contestant::Contestant;
use crate::problem::Problem;
use crate::task::Task;

/// The Rust peers that can do a task.
pub fn contestants<P: Problem>(_problem: &P, _task: &Task) -> Vec<Box<dyn Contestant>> {
    Vec::new()
}
