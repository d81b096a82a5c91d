//! Many runs of one system over threads, by the library's ensemble: a row for each, in the order of the
//! starts.

use crate::faults::{of_run, value_error};
use crate::number::Doubles;
use crate::options::Options;
use crate::recording::recorded::Recorded;
use crate::runs::patience::{Meanwhile, Stop, patiently, patiently_with};
use equip::integrate::{RunFailure, Starts, drawn_start};
use equip::prelude::*;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPoolBuilder;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// How a run ended.
struct End {
    t: f64,
    y: Vec<f64>,
    energy_error: f64,
    steps: u64,
    is_conserved: bool,
    /// Lyapunov exponent and MEGNO.
    chaos: [f64; 2],
}

impl End {
    /// That of a run that has failed, whose states have `n` numbers.
    fn failed(n: usize) -> Self {
        End {
            t: f64::NAN,
            y: vec![f64::NAN; n],
            energy_error: f64::NAN,
            steps: 0,
            is_conserved: false,
            chaos: [f64::NAN; 2],
        }
    }
}

type Row = Result<End, String>;

/// Integrates `system` from each of the starts, which stand one after the other in `q` and `p`.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "handed over by one function of Python"
)]
pub(crate) fn ensemble<'py>(
    py: Python<'py>,
    system: &Recorded,
    q: Vec<f64>,
    p: Vec<f64>,
    span: (f64, f64),
    options: Options,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (hamiltonian, integrator) = (system.hamiltonian.clone(), options.integrator()?);
    let n = 2 * (hamiltonian.degrees_of_freedom() - usize::from(hamiltonian.has_time()));
    let done = Arc::new(AtomicUsize::new(0));
    let mut watch = Watch {
        done: Arc::clone(&done),
        progress: progress.as_ref(),
    };
    let work = move |stop: &Stop| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(value_error)?;
        let row = |_, run: Result<Run<f64>, RunFailure<f64>>| {
            done.fetch_add(1, Relaxed);
            run.map(|run| end(&run))
                .map_err(|failure| failure.to_string())
        };
        let starts = Starts::new(&q, &p, span.0..=span.1);
        let is_over = || stop.is_set();
        let rows = pool.install(|| integrator.ensemble(&hamiltonian, starts, row, is_over));
        rows.map_err(of_run)
    };
    system.raised.or(|| {
        let rows = patiently_with(py, &mut watch, work)??;
        table(py, n, rows)
    })
}

/// Shows how many rows are made.
struct Watch<'a> {
    done: Arc<AtomicUsize>,
    progress: Option<&'a Py<PyAny>>,
}

impl Meanwhile for Watch<'_> {
    fn look(&mut self, py: Python<'_>) -> PyResult<()> {
        let done = self.done.load(Relaxed);
        (self.progress).map_or(Ok(()), |f| f.call1(py, (done,)).map(drop))
    }
}

fn end(run: &Run<f64>) -> End {
    let (t, q, p) = run.last();
    let certificate = run.certificate();
    End {
        t,
        y: [q, p].concat(),
        energy_error: certificate.energy.as_ref().map_or(f64::NAN, |e| e.max),
        steps: certificate.counts.steps,
        is_conserved: certificate.energy_conserved_on_every_step(),
        chaos: (certificate.chaos).map_or([f64::NAN; 2], |chaos| [chaos.lyapunov, chaos.megno]),
    }
}

/// Rows of arrays; NaN where a run has failed.
fn table(py: Python<'_>, n: usize, rows: Vec<Option<Row>>) -> PyResult<Bound<'_, PyDict>> {
    let (mut ends, errors) = (Vec::with_capacity(rows.len()), PyDict::new(py));
    for (i, row) in rows.into_iter().enumerate() {
        let row = row.ok_or_else(|| value_error("a thread of the ensemble ended early"))?;
        ends.push(row.or_else(|error| errors.set_item(i, error).map(|()| End::failed(n)))?);
    }
    let numbers = |of: fn(&End) -> f64| ends.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
    let dict = PyDict::new(py);
    dict.set_item("t", numbers(|end| end.t))?;
    let y: Vec<f64> = ends.iter().flat_map(|end| end.y.iter().copied()).collect();
    dict.set_item("y", y.into_pyarray(py))?;
    dict.set_item("energy_error", numbers(|end| end.energy_error))?;
    let steps: Vec<i64> = ends.iter().map(|end| end.steps as i64).collect();
    dict.set_item("steps", steps.into_pyarray(py))?;
    let conserved: Vec<bool> = ends.iter().map(|end| end.is_conserved).collect();
    dict.set_item("energy_conserved", conserved.into_pyarray(py))?;
    dict.set_item("lyapunov", numbers(|end| end.chaos[0]))?;
    dict.set_item("megno", numbers(|end| end.chaos[1]))?;
    dict.set_item("errors", errors)?;
    Ok(dict)
}

/// `n` starts around one, flat, one after the other: positions, and momenta.
#[pyfunction]
pub(crate) fn draw_starts<'py>(
    py: Python<'py>,
    q0: Vec<f64>,
    p0: Vec<f64>,
    n: u64,
    seed: u64,
    spread: f64,
) -> PyResult<(Doubles<'py>, Doubles<'py>)> {
    let (q, p) = patiently(py, move |stop| {
        let start = |index| drawn_start(&q0, &p0, spread, seed, index);
        let wanted = (0..n).take_while(|_| !stop.is_set());
        let (q, p): (Vec<_>, Vec<_>) = wanted.map(start).unzip();
        (q.concat(), p.concat())
    })?;
    Ok((q.into_pyarray(py), p.into_pyarray(py)))
}
