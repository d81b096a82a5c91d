//! Many runs of one system over threads, by the library's ensemble: a row for each, in the order of the starts.

use crate::faults::{of_run, value_error};
use crate::options::{Options, WithIntegrator};
use crate::recording::recorded::Recorded;
use crate::runs::signals::PATIENCE;
use equip::prelude::*;
use equip::solver::{Fixed, Starts, StepSizes, Symmetric, Tolerance, drawn_start};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Instant;

/// How a run ended.
struct End {
    t: f64,
    y: Vec<f64>,
    energy_defect: f64,
    steps: u64,
    is_kept: bool,
    /// Lyapunov exponent and MEGNO.
    chaos: [f64; 2],
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
    options.with::<f64, _>(Task {
        py,
        hamiltonian: &system.hamiltonian,
        starts: Starts::new(&q, &p, span.0..=span.1),
        threads,
        progress: progress.as_ref(),
    })?
}

struct Task<'a, 'py> {
    py: Python<'py>,
    hamiltonian: &'a Hamiltonian,
    starts: Starts<'a, f64>,
    threads: usize,
    progress: Option<&'a Py<PyAny>>,
}

impl<'py> WithIntegrator<f64> for Task<'_, 'py> {
    type Output = PyResult<Bound<'py, PyDict>>;

    fn fixed(self, integrator: Integrator<f64, Fixed<f64>>) -> Self::Output {
        self.run(&integrator)
    }

    fn adaptive(self, integrator: Integrator<f64, Tolerance<f64>>) -> Self::Output {
        self.run(&integrator)
    }

    fn reversible(self, integrator: Integrator<f64, Symmetric<f64>>) -> Self::Output {
        self.run(&integrator)
    }
}

impl<'py> Task<'_, 'py> {
    fn run<S: StepSizes<f64> + Send + Sync>(
        self,
        integrator: &Integrator<f64, S>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).build();
        let pool = pool.map_err(value_error)?;
        let (hamiltonian, starts, progress) = (self.hamiltonian, self.starts, self.progress);
        let is_over = AtomicBool::new(false);
        let rows = self.py.detach(|| {
            thread::scope(|scope| {
                let (sender, receiver) = channel::<()>();
                let (pool, is_over) = (&pool, &is_over);
                let work = scope.spawn(move || {
                    let row = |_, run: Result<Run<f64>, RunFailure<f64>>| {
                        // Nobody counts any more once an exception has ended the ensemble.
                        let _ = sender.send(());
                        run.map(|run| end(&run))
                            .map_err(|failure| failure.to_string())
                    };
                    let stop = || is_over.load(Relaxed);
                    pool.install(|| integrator.ensemble(hamiltonian, starts, row, stop))
                });
                let watched = watch(&receiver, progress);
                is_over.store(watched.is_err(), Relaxed);
                let rows = work.join();
                watched.map(|()| rows)
            })
        })?;
        let rows = rows.map_err(|_| value_error("a thread of the ensemble ended early"))?;
        let rows = rows.map_err(|error| of_run(&error))?;
        let n = 2 * (hamiltonian.degrees_of_freedom() - usize::from(hamiltonian.has_time()));
        table(self.py, n, rows)
    }
}

/// Counts rows until no thread makes any more, and asks Python for signals now and then.
fn watch(rows: &Receiver<()>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    let (mut asked, mut done) = (Instant::now(), 0);
    loop {
        match rows.recv_timeout(PATIENCE) {
            Ok(()) => done += 1,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if asked.elapsed() < PATIENCE {
            continue;
        }
        asked = Instant::now();
        Python::attach(|py| {
            py.check_signals()?;
            progress.map_or(Ok(()), |f| f.call1(py, (done,)).map(drop))
        })?;
    }
}

fn end(run: &Run<f64>) -> End {
    let (t, q, p) = run.last();
    let certificate = run.certificate();
    End {
        t,
        y: [q, p].concat(),
        energy_defect: certificate.energy.as_ref().map_or(f64::NAN, |e| e.max),
        steps: certificate.counts.steps,
        is_kept: certificate.energy_kept_on_every_step(),
        chaos: (certificate.chaos).map_or([f64::NAN; 2], |chaos| [chaos.lyapunov, chaos.megno]),
    }
}

/// Rows of arrays; NaN where a run has failed.
fn table(py: Python<'_>, n: usize, rows: Vec<Option<Row>>) -> PyResult<Bound<'_, PyDict>> {
    let (mut t, mut y, mut defects, mut steps, mut kept) = (vec![], vec![], vec![], vec![], vec![]);
    let (mut lyapunov, mut megno) = (vec![], vec![]);
    let errors = PyDict::new(py);
    for (i, row) in rows.into_iter().enumerate() {
        let row = row.ok_or_else(|| value_error("a thread of the ensemble ended early"))?;
        let end = match row {
            Ok(end) => end,
            Err(error) => {
                errors.set_item(i, error)?;
                End {
                    t: f64::NAN,
                    y: vec![f64::NAN; n],
                    energy_defect: f64::NAN,
                    steps: 0,
                    is_kept: false,
                    chaos: [f64::NAN; 2],
                }
            }
        };
        t.push(end.t);
        y.extend(end.y);
        defects.push(end.energy_defect);
        steps.push(end.steps as i64);
        kept.push(end.is_kept);
        lyapunov.push(end.chaos[0]);
        megno.push(end.chaos[1]);
    }
    let dict = PyDict::new(py);
    dict.set_item("t", t.into_pyarray(py))?;
    dict.set_item("y", y.into_pyarray(py))?;
    dict.set_item("energy_defect", defects.into_pyarray(py))?;
    dict.set_item("steps", steps.into_pyarray(py))?;
    dict.set_item("kept", kept.into_pyarray(py))?;
    dict.set_item("lyapunov", lyapunov.into_pyarray(py))?;
    dict.set_item("megno", megno.into_pyarray(py))?;
    dict.set_item("errors", errors)?;
    Ok(dict)
}

type Floats<'py> = Bound<'py, PyArray1<f64>>;

/// `n` starts around one, flat, one after the other: positions, and momenta.
#[pyfunction]
pub(crate) fn draw_starts<'py>(
    py: Python<'py>,
    q0: Vec<f64>,
    p0: Vec<f64>,
    n: u64,
    seed: u64,
    spread: f64,
) -> (Floats<'py>, Floats<'py>) {
    let start = |index| drawn_start(&q0, &p0, spread, seed, index);
    let (q, p): (Vec<_>, Vec<_>) = (0..n).map(start).unzip();
    (q.concat().into_pyarray(py), p.concat().into_pyarray(py))
}
