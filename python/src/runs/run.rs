//! Whole runs: another thread makes the steps.

use crate::faults::{of_run, value_error};
use crate::number::{Number, Pair, Pairs, arrays};
use crate::options::Options;
use crate::recording::recorded::Recorded;
use crate::runs::certificate::certificate;
use crate::runs::curve::{Curve, Kept};
use crate::runs::keeping::Keeping;
use crate::runs::patience::patiently_with;
use crate::runs::signals::{Signals, Watch};
use equip::integrate::{Integrator, RunFailure};
use equip::prelude::*;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::time::Duration;

/// Where a run starts and where it ends: q, p, t0, t1.
pub(crate) type Interval = (Pairs, Pairs, Pair, Pair);

/// File and seconds between two checkpoints.
type CheckpointOptions = (PathBuf, f64);

/// Integrates `system`; a dict of arrays, the certificate, and the fault that ended the run, if one did.
#[pyfunction]
#[pyo3(signature = (system, start, options, precision, progress, checkpoint=None))]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    system: &Recorded,
    start: Interval,
    options: Options,
    precision: &str,
    progress: Option<Py<PyAny>>,
    checkpoint: Option<CheckpointOptions>,
) -> PyResult<Bound<'py, PyDict>> {
    let end = start.3.0 + start.3.1;
    let keeping = checkpoint.map(|(path, seconds)| {
        let every = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        Keeping::new(path, end, every)
    });
    let keeping = keeping.transpose()?;
    let progress = progress.as_ref();
    system.raised.or(|| match precision {
        "f64" => whole::<f64>(py, system, start, options.integrator()?, progress, keeping),
        "dd" => whole::<DoubleDouble>(py, system, start, options.integrator()?, progress, keeping),
        other => Err(value_error(format!(
            "precision is '{other}'; it must be 'f64' or 'dd' (double-double, 31 digits)"
        ))),
    })
}

fn whole<'py, T: Number + Kept>(
    py: Python<'py>,
    system: &Recorded,
    (q, p, t0, t1): Interval,
    integrator: Integrator<T>,
    progress: Option<&Py<PyAny>>,
    keeping: Option<Keeping>,
) -> PyResult<Bound<'py, PyDict>> {
    let (q, p) = (T::read_all(&q), T::read_all(&p));
    let interval = T::read(t0)..=T::read(t1);
    let hamiltonian = system.hamiltonian.clone();
    let from = match &keeping {
        Some(keeping) => keeping.read()?,
        None => None,
    };
    if let Some(from) = &from {
        from.check_start(&q, &p, *interval.start())
            .map_err(of_run)?;
    }
    let mut watch = Watch::new(progress, keeping.is_some());
    let reached = watch.reached.clone();
    let found = patiently_with(py, &mut watch, move |stop| {
        let mut signals = Signals::new(stop, reached, keeping);
        let observer = &mut signals;
        let made = match &from {
            Some(from) => integrator.integrate_from(&hamiltonian, from, *interval.end(), observer),
            None => integrator.integrate_observed(&hamiltonian, &q, &p, interval, observer),
        };
        if let Some(error) = signals.fault {
            return Err(error);
        }
        let (run, fault) = match made {
            Ok(run) => (run, None),
            Err(RunFailure { error, partial }) => match partial {
                Some(run) => (*run, Some(error.to_string())),
                None => return Err(of_run(error)),
            },
        };
        let output_errors = output_errors(&hamiltonian, &run);
        Ok((run, fault, output_errors))
    })?;
    let (run, fault, output_errors) = found?;
    let dict = results(py, &run)?;
    dict.set_item("fault", fault)?;
    if let Some(energy_errors) = output_errors {
        dict.set_item("output_energy_error", energy_errors.into_pyarray(py))?;
    }
    Ok(dict)
}

/// What a run leaves, flat.
fn results<'py, T: Number + Kept>(py: Python<'py>, run: &Run<T>) -> PyResult<Bound<'py, PyDict>> {
    let state = |i| run.q(i).iter().chain(run.p(i)).copied();
    let outputs = run.outputs().flat_map(|(_, q, p)| q.iter().chain(p));
    let roots = run.events().iter().flat_map(|e| e.q.iter().chain(&e.p));
    let doubles = |numbers: Vec<f64>| numbers.into_pyarray(py);
    let dict = PyDict::new(py);
    dict.set_item("t", arrays(py, run.times().iter().copied()))?;
    dict.set_item("y", arrays(py, (0..run.len()).flat_map(state)))?;
    let energy_errors = run.energy_errors().iter().map(|x| x.high());
    dict.set_item("energy_error", doubles(energy_errors.collect()))?;
    let labels = Outcome::ALL.map(|outcome| outcome.label()).to_vec();
    let codes: Vec<u8> = run
        .outcomes()
        .iter()
        .map(|&outcome| code(outcome))
        .collect();
    dict.set_item("outcome", (labels, codes.into_pyarray(py)))?;
    dict.set_item("output_t", arrays(py, run.outputs().map(|(t, _, _)| t)))?;
    dict.set_item("output_y", arrays(py, outputs.copied()))?;
    let events: Vec<i64> = run.events().iter().map(|e| e.event as i64).collect();
    dict.set_item("event", events.into_pyarray(py))?;
    let event_times = run.events().iter().map(|e| e.time.high());
    dict.set_item("event_t", doubles(event_times.collect()))?;
    dict.set_item("event_y", doubles(roots.map(|x| x.high()).collect()))?;
    let curve = run.trajectory().map(|trajectory| Curve {
        n: 2 * trajectory.degrees_of_freedom(),
        dense: T::keep(trajectory.clone()),
    });
    dict.set_item("curve", curve)?;
    dict.set_item("stopped", run.stopped())?;
    dict.set_item("certificate", certificate(py, run.certificate())?)?;
    Ok(dict)
}

/// The place of an outcome among all.
fn code(outcome: Outcome) -> u8 {
    let mut all = Outcome::ALL.iter();
    all.position(|&o| o == outcome).unwrap_or_default() as u8
}

/// H - H_ref at the output times. With H(t, q, p) the energy that has gone in up to a time between two
/// steps is not known.
fn output_errors<T: Number>(hamiltonian: &Hamiltonian, run: &Run<T>) -> Option<Vec<f64>> {
    let energy = run.certificate().energy.as_ref()?;
    if hamiltonian.has_time() {
        return None;
    }
    let mut evaluator = hamiltonian.evaluator::<T>();
    let energy_errors = run.outputs().map(|(_, q, p)| {
        let y: Vec<T> = q.iter().chain(p).copied().collect();
        evaluator.compensated_value(&y) - energy.start
    });
    Some(energy_errors.map(|error| error.high()).collect())
}
