//! Whole runs: the GIL is free while steps are made.

use crate::faults::{of_run, value_error};
use crate::number::{Number, Pair};
use crate::options::{Options, WithIntegrator};
use crate::recording::recorded::Recorded;
use crate::runs::certificate::certificate;
use crate::runs::keeping::{self, Keeping};
use crate::runs::signals::Signals;
use equip::autodiff::Evaluate;
use equip::prelude::*;
use equip::solver::{Fixed, StepSizes, Symmetric, Tolerance};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};

type Pairs = (Vec<f64>, Vec<f64>);

/// Trajectories of either number type.
enum Dense {
    Double(Trajectory<f64>),
    DoubleDouble(Trajectory<DoubleDouble>),
}

/// A run at any time.
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Curve {
    dense: Dense,
    n: usize,
}

#[pymethods]
impl Curve {
    /// First and last time.
    fn interval(&self) -> (f64, f64) {
        match &self.dense {
            Dense::Double(trajectory) => trajectory.interval(),
            Dense::DoubleDouble(trajectory) => {
                let (start, end) = trajectory.interval();
                (start.to_f64(), end.to_f64())
            }
        }
    }

    /// The state (q, p), 2m numbers, at each of the times, one after the other.
    fn at<'py>(&self, times: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let states = match &self.dense {
            Dense::Double(trajectory) => states(trajectory, times.as_slice()?, self.n),
            Dense::DoubleDouble(trajectory) => states(trajectory, times.as_slice()?, self.n),
        };
        Ok(states?.into_pyarray(times.py()))
    }
}

fn states<T: Number>(trajectory: &Trajectory<T>, times: &[f64], n: usize) -> PyResult<Vec<f64>> {
    let mut y = vec![T::int(0); n];
    let mut states = Vec::with_capacity(times.len() * n);
    for &t in times {
        if !trajectory.at_into(T::exact(t), &mut y) {
            let (start, end) = trajectory.interval();
            return Err(value_error(format!(
                "t = {t} is outside the run, {start} to {end}"
            )));
        }
        states.extend(y.iter().map(|x| x.to_f64()));
    }
    Ok(states)
}

/// Where a run starts and where it ends: q, p, t0, t1.
pub(crate) type Interval = (Pairs, Pairs, Pair, Pair);

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
    checkpoint: Option<PathBuf>,
) -> PyResult<Bound<'py, PyDict>> {
    let (start, progress, checkpoint) = (&start, progress.as_ref(), checkpoint.as_deref());
    match precision {
        "f64" => options.with::<f64, _>(Whole {
            py,
            system,
            start,
            progress,
            checkpoint,
        })?,
        "dd" => options.with::<DoubleDouble, _>(Whole {
            py,
            system,
            start,
            progress,
            checkpoint,
        })?,
        other => Err(value_error(format!(
            "precision is '{other}'; it must be 'f64' or 'dd' (double-double, 31 digits)"
        ))),
    }
}

struct Whole<'a, 'py> {
    py: Python<'py>,
    system: &'a Recorded,
    start: &'a Interval,
    progress: Option<&'a Py<PyAny>>,
    checkpoint: Option<&'a Path>,
}

impl<'py, T: Number + Kept> WithIntegrator<T> for Whole<'_, 'py> {
    type Output = PyResult<Bound<'py, PyDict>>;

    fn fixed(self, integrator: Integrator<T, Fixed<T>>) -> Self::Output {
        self.run(&integrator)
    }

    fn adaptive(self, integrator: Integrator<T, Tolerance<T>>) -> Self::Output {
        self.run(&integrator)
    }

    fn reversible(self, integrator: Integrator<T, Symmetric<T>>) -> Self::Output {
        self.run(&integrator)
    }
}

impl<'py> Whole<'_, 'py> {
    fn run<T: Number + Kept, S: StepSizes<T> + Send + Sync>(
        self,
        integrator: &Integrator<T, S>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (q, p, t0, t1) = self.start;
        let (q, p) = (T::read_all(q), T::read_all(p));
        let interval = T::read(*t0)..=T::read(*t1);
        let (hamiltonian, progress) = (&self.system.hamiltonian, self.progress);
        let from = self.checkpoint.map(keeping::read).transpose()?.flatten();
        if let Some(from) = &from {
            let is_that = from.check_start(&q, &p, *interval.start());
            is_that.map_err(|error| of_run(&error))?;
        }
        let keeping = (self.checkpoint).map(|path| Keeping::new(path.into(), t1.0 + t1.1));
        let (made, fault) = self.py.detach(|| {
            let mut signals = Signals::new(progress, keeping);
            let watch = &mut signals;
            let made = match &from {
                Some(from) => integrator.integrate_from(hamiltonian, from, *interval.end(), watch),
                None => integrator.integrate_observed(hamiltonian, &q, &p, interval, watch),
            };
            (made, signals.fault)
        });
        if let Some(error) = fault {
            return Err(error);
        }
        match made {
            Ok(run) => results(self.py, hamiltonian, &run, None),
            Err(RunFailure { error, partial }) => match partial {
                Some(run) => results(self.py, hamiltonian, &run, Some(error.to_string())),
                None => Err(of_run(&error)),
            },
        }
    }
}

/// Number types whose trajectories can be kept.
trait Kept: Sized {
    fn keep(trajectory: &Trajectory<Self>) -> Dense;
}

impl Kept for f64 {
    fn keep(trajectory: &Trajectory<f64>) -> Dense {
        Dense::Double(trajectory.clone())
    }
}

impl Kept for DoubleDouble {
    fn keep(trajectory: &Trajectory<DoubleDouble>) -> Dense {
        Dense::DoubleDouble(trajectory.clone())
    }
}

/// Numbers as an array, and what they have below it.
fn arrays<'py, T: Number>(
    py: Python<'py>,
    numbers: impl Iterator<Item = T>,
) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
    let (high, low): Pairs = numbers.map(|x| (x.to_f64(), x.low())).unzip();
    (high.into_pyarray(py), low.into_pyarray(py))
}

fn results<'py, T: Number + Kept>(
    py: Python<'py>,
    hamiltonian: &Hamiltonian,
    run: &Run<T>,
    fault: Option<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let state = |i| run.q(i).iter().chain(run.p(i)).copied();
    dict.set_item("t", arrays(py, run.times().iter().copied()))?;
    dict.set_item("y", arrays(py, (0..run.len()).flat_map(state)))?;
    dict.set_item(
        "energy_defect",
        arrays(py, run.energy_defects().iter().copied()).0,
    )?;
    let outcomes: Vec<&str> = run.outcomes().iter().map(|o| o.label()).collect();
    dict.set_item("outcome", outcomes)?;
    dict.set_item("output_t", arrays(py, run.outputs().map(|(t, _, _)| t)))?;
    let outputs = run.outputs().flat_map(|(_, q, p)| q.iter().chain(p));
    dict.set_item("output_y", arrays(py, outputs.copied()))?;
    // With H(t, q, p) the energy that has gone in up to a time between two steps is not known.
    if let Some(energy) = &run.certificate().energy
        && !hamiltonian.has_time()
    {
        let mut evaluator = hamiltonian.evaluator::<T>();
        let defects = run.outputs().map(|(_, q, p)| {
            let y: Vec<T> = q.iter().chain(p).copied().collect();
            evaluator.compensated_value(&y) - energy.start
        });
        dict.set_item("output_energy_defect", arrays(py, defects).0)?;
    }
    let events: Vec<_> = run.events().iter().map(|e| e.event).collect();
    dict.set_item("event", events)?;
    dict.set_item("event_t", arrays(py, run.events().iter().map(|e| e.time)).0)?;
    let roots = run.events().iter().flat_map(|e| e.q.iter().chain(&e.p));
    dict.set_item("event_y", arrays(py, roots.copied()).0)?;
    let n = 2 * (hamiltonian.degrees_of_freedom() - usize::from(hamiltonian.has_time()));
    let curve = run.trajectory().map(|trajectory| Curve {
        dense: T::keep(trajectory),
        n,
    });
    dict.set_item("curve", curve)?;
    dict.set_item("stopped", run.stopped())?;
    dict.set_item("fault", fault)?;
    dict.set_item("certificate", certificate(py, run.certificate())?)?;
    Ok(dict)
}
