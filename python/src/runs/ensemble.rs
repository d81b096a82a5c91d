//! Many runs of one system over threads: a row for each, in the order of the starts, whatever the threads.

use crate::faults::of_run;
use crate::options::{Options, WithIntegrator};
use crate::recording::recorded::Recorded;
use crate::runs::signals::PATIENCE;
use equip::prelude::*;
use equip::solver::{Fixed, StepSizes, Tolerance};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;

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

type Row = (usize, Result<End, String>);

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
    let (hamiltonian, progress) = (&system.hamiltonian, progress.as_ref());
    let task = Task {
        py,
        hamiltonian,
        q: &q,
        p: &p,
        span,
        threads,
        progress,
    };
    options.with::<f64, _>(task)?
}

struct Task<'a, 'py> {
    py: Python<'py>,
    hamiltonian: &'a Hamiltonian,
    q: &'a [f64],
    p: &'a [f64],
    span: (f64, f64),
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
}

/// What the threads share.
struct Shared<'a> {
    hamiltonian: &'a Hamiltonian,
    q: &'a [f64],
    p: &'a [f64],
    span: (f64, f64),
    next: AtomicUsize,
    stop: AtomicBool,
}

impl<'py> Task<'_, 'py> {
    fn run<S: StepSizes<f64> + Send + Sync>(
        self,
        integrator: &Integrator<f64, S>,
    ) -> PyResult<Bound<'py, PyDict>> {
        // Faults of the options are those of all members.
        let prepared = integrator.prepare(self.hamiltonian);
        drop(prepared.map_err(|error| of_run(&error))?);
        let m = self.hamiltonian.degrees_of_freedom();
        let members = self.q.len() / m;
        let shared = Shared {
            hamiltonian: self.hamiltonian,
            q: self.q,
            p: self.p,
            span: self.span,
            next: AtomicUsize::new(0),
            stop: AtomicBool::new(false),
        };
        let (threads, progress) = (self.threads.clamp(1, members.max(1)), self.progress);
        let rows = self.py.detach(|| {
            thread::scope(|scope| {
                let (sender, receiver) = channel::<Row>();
                for _ in 0..threads {
                    let (sender, shared) = (sender.clone(), &shared);
                    scope.spawn(move || shared.work(integrator, &sender));
                }
                drop(sender);
                let mut rows: Vec<Option<Result<End, String>>> =
                    (0..members).map(|_| None).collect();
                let mut asked = std::time::Instant::now();
                let mut done = 0;
                loop {
                    match receiver.recv_timeout(PATIENCE) {
                        Ok((i, row)) => {
                            rows[i] = Some(row);
                            done += 1;
                        }
                        Err(RecvTimeoutError::Timeout) => {}
                        Err(RecvTimeoutError::Disconnected) => return Ok(rows),
                    }
                    if asked.elapsed() < PATIENCE {
                        continue;
                    }
                    asked = std::time::Instant::now();
                    let ask = Python::attach(|py| {
                        py.check_signals()?;
                        progress.map_or(Ok(()), |f| f.call1(py, (done,)).map(drop))
                    });
                    if let Err(error) = ask {
                        shared.stop.store(true, Relaxed);
                        return Err(error);
                    }
                }
            })
        })?;
        table(self.py, m, rows)
    }
}

impl Shared<'_> {
    /// Makes runs until none is left.
    fn work<S: StepSizes<f64>>(&self, integrator: &Integrator<f64, S>, rows: &Sender<Row>) {
        let m = self.hamiltonian.degrees_of_freedom();
        let Ok(mut prepared) = integrator.prepare(self.hamiltonian) else {
            return;
        };
        loop {
            let i = self.next.fetch_add(1, Relaxed);
            if i * m >= self.q.len() || self.stop.load(Relaxed) {
                return;
            }
            let (q, p) = (&self.q[i * m..][..m], &self.p[i * m..][..m]);
            let mut watch = |_: &StepView<'_, f64>| match self.stop.load(Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let made = prepared.integrate_observed(q, p, self.span.0..=self.span.1, &mut watch);
            let row = made
                .map(|run| end(&run))
                .map_err(|failure| failure.to_string());
            if rows.send((i, row)).is_err() {
                return;
            }
        }
    }
}

fn end(run: &equip::prelude::Run<f64>) -> End {
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
fn table<'py>(
    py: Python<'py>,
    m: usize,
    rows: Vec<Option<Result<End, String>>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (mut t, mut y, mut defects, mut steps, mut kept) = (vec![], vec![], vec![], vec![], vec![]);
    let (mut lyapunov, mut megno) = (vec![], vec![]);
    let errors = PyDict::new(py);
    for (i, row) in rows.into_iter().enumerate() {
        let end = match row {
            Some(Ok(end)) => end,
            Some(Err(error)) => {
                errors.set_item(i, error)?;
                End {
                    t: f64::NAN,
                    y: vec![f64::NAN; 2 * m],
                    energy_defect: f64::NAN,
                    steps: 0,
                    is_kept: false,
                    chaos: [f64::NAN; 2],
                }
            }
            None => {
                return Err(crate::faults::value_error(
                    "a thread of the ensemble ended early",
                ));
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
