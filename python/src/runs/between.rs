//! States between those that a run has kept, for pictures: the motion is computed again from each of them.

use crate::faults::of_run;
use crate::number::Doubles;
use crate::recording::recorded::Recorded;
use crate::runs::patience::{Stop, patiently};
use equip::integrate::IntegrateError;
use equip::prelude::*;
use numpy::IntoPyArray;
use pyo3::prelude::*;

/// Stages and tolerance of curves: no eye sees more.
const STAGES: usize = 6;
const TOLERANCE: f64 = 1e-8;

/// From each state in `y` but the last, those at `points` times, evenly from its own up to that of the next
/// one, flat. Where a step cannot be made they are on the straight line.
#[pyfunction]
pub(crate) fn between<'py>(
    py: Python<'py>,
    system: &Recorded,
    t: Vec<f64>,
    y: Vec<f64>,
    points: usize,
) -> PyResult<Doubles<'py>> {
    let hamiltonian = system.hamiltonian.clone();
    let work = move |stop: &Stop| curves(&hamiltonian, &t, &y, points, stop);
    let made = system.raised.or(|| patiently(py, work))?;
    Ok(made.map_err(of_run)?.into_pyarray(py))
}

fn curves(
    hamiltonian: &Hamiltonian,
    t: &[f64],
    y: &[f64],
    points: usize,
    stop: &Stop,
) -> Result<Vec<f64>, IntegrateError<f64>> {
    let mut prepared = Gauss::stages(STAGES)
        .tolerance(TOLERANCE)
        .prepare(hamiltonian)?;
    let n = y.len() / t.len();
    let mut states = Vec::with_capacity(t.len() * points * n);
    let pairs = t
        .windows(2)
        .zip(y.chunks_exact(n).zip(y[n..].chunks_exact(n)));
    for (times, (from, to)) in pairs {
        if stop.is_set() {
            break;
        }
        let (q, p) = from.split_at(n / 2);
        let mut run = prepared.start(q, p, times[0]).ok();
        states.extend_from_slice(from);
        for i in 1..points {
            let share = i as f64 / points as f64;
            let time = times[0] + share * (times[1] - times[0]);
            match run.as_mut().and_then(|run| run.advance_to(time).ok()) {
                Some(view) => states.extend(view.q.iter().chain(view.p)),
                None => {
                    run = None;
                    let line = from.iter().zip(to).map(|(a, b)| a + share * (b - a));
                    states.extend(line);
                }
            }
        }
    }
    Ok(states)
}
