//! [`Steps`]: a run one step at a time, with tangent vectors propagated.

use crate::faults::of_run;
use crate::number::{Doubles, Pairs};
use crate::options::Options;
use crate::recording::external::Raised;
use crate::recording::recorded::Recorded;
use crate::runs::certificate::certificate;
use crate::runs::patience::{Stop, lock, patiently, patiently_if};
use crate::runs::signals::{Reached, Signals};
use equip::integrate::{IntegrateError, Occurrence, StepEvents, Stepper};
use equip::prelude::*;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

struct Run {
    hamiltonian: Hamiltonian,
    stepper: Stepper<f64>,
    tangent: Option<TangentMap<f64>>,
    tangent_vectors: Vec<f64>,
    events: Option<StepEvents<f64>>,
    /// The events of the steps of the last call.
    found: Vec<Occurrence<f64>>,
}

impl Run {
    fn advance(&mut self) -> Result<(), IntegrateError<f64>> {
        self.found.clear();
        self.stepper.advance().map(|_| ())?;
        self.follow()
    }

    /// Makes the steps to the time `t`, unless it is told to stop.
    fn advance_to(&mut self, t: f64, stop: &Stop) -> Result<(), IntegrateError<f64>> {
        self.found.clear();
        while !stop.is_set() && self.stepper.advance_towards(t)? {
            self.follow()?;
        }
        Ok(())
    }

    /// Tangent vectors over the step made last, and the events within it.
    fn follow(&mut self) -> Result<(), IntegrateError<f64>> {
        if let Some(tangent) = &mut self.tangent {
            tangent.propagate(&self.stepper, &mut self.tangent_vectors)?;
        }
        if let Some(events) = &mut self.events {
            self.found
                .extend_from_slice(events.find(&mut self.stepper)?);
        }
        Ok(())
    }
}

/// A run one step at a time.
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Steps {
    run: Arc<Mutex<Run>>,
    /// Whether a step may take longer than a signal may wait.
    is_large: bool,
    raised: Raised,
}

/// Place of an event in the list of events, time, and (q, p).
type Found<'py> = (usize, f64, Doubles<'py>);

/// Number, time, size, state, energy error, α and outcome of a step, and its events.
type Made<'py> = (
    u64,
    f64,
    f64,
    Doubles<'py>,
    Option<f64>,
    Doubles<'py>,
    &'static str,
    Vec<Found<'py>>,
);

impl Steps {
    fn run(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Run>> {
        lock(py, &self.run)
    }

    /// Makes steps in another thread.
    fn patiently(
        &self,
        py: Python<'_>,
        f: impl FnOnce(&mut Run, &Stop) -> Result<(), IntegrateError<f64>> + Send + 'static,
    ) -> PyResult<()> {
        let run = Arc::clone(&self.run);
        let work = move |stop: &Stop| {
            let mut run = run.lock().unwrap_or_else(PoisonError::into_inner);
            f(&mut run, stop).map_err(of_run)
        };
        self.raised.or(|| patiently(py, work).flatten())
    }
}

#[pymethods]
impl Steps {
    #[new]
    fn new(
        py: Python<'_>,
        system: &Recorded,
        q: Vec<f64>,
        p: Vec<f64>,
        t: f64,
        options: Options,
        tangent_vectors: Vec<f64>,
    ) -> PyResult<Self> {
        let tangent_vectors = whole(&system.hamiltonian, &tangent_vectors);
        let hamiltonian = system.hamiltonian.clone();
        let (events, integrator) = (options.events(), options.integrator()?);
        let begin = move || {
            let mut stepper = integrator.start(&hamiltonian, &q, &p, t)?;
            let tangent =
                (!tangent_vectors.is_empty()).then(|| TangentMap::new(&hamiltonian, &mut stepper));
            let events = match events.is_empty() {
                true => None,
                false => Some(StepEvents::new(&hamiltonian, &mut stepper, &events)?),
            };
            Ok(Run {
                hamiltonian,
                stepper,
                tangent,
                tangent_vectors,
                events,
                found: Vec::new(),
            })
        };
        let (is_large, raised) = (system.is_large(), system.raised.clone());
        let run = raised.or(|| patiently_if(is_large, py, begin)?.map_err(of_run))?;
        Ok(Steps {
            run: Arc::new(Mutex::new(run)),
            is_large,
            raised,
        })
    }

    /// Makes a step.
    fn advance(&self, py: Python<'_>) -> PyResult<()> {
        if self.is_large {
            return self.patiently(py, |run, _| run.advance());
        }
        py.check_signals()?;
        let mut held = self.run(py)?;
        let run: &mut Run = &mut held;
        py.detach(|| run.advance()).map_err(of_run)
    }

    /// Makes the steps to the time `t`, forward or back.
    fn advance_to(&self, py: Python<'_>, t: f64) -> PyResult<()> {
        self.patiently(py, move |run, stop| run.advance_to(t, stop))
    }

    /// Turns the run round in time.
    fn turn_back(&self, py: Python<'_>) -> PyResult<()> {
        self.run(py)?.stepper.turn_back();
        Ok(())
    }

    /// The step made last.
    fn made<'py>(&self, py: Python<'py>) -> PyResult<Made<'py>> {
        let run = self.run(py)?;
        let view = run.stepper.view();
        let y = [view.q, view.p].concat().into_pyarray(py);
        let alphas = view.alphas.to_vec().into_pyarray(py);
        let outcome = view.outcome.label();
        let energy_error = view.energy_error;
        let event = |e: &Occurrence<f64>| {
            let y = [e.q.as_slice(), &e.p].concat().into_pyarray(py);
            (e.event, e.time, y)
        };
        let events = run.found.iter().map(event).collect();
        let (index, time, step) = (view.index, view.time, view.step);
        Ok((index, time, step, y, energy_error, alphas, outcome, events))
    }

    fn restart(&self, py: Python<'_>, q: Vec<f64>, p: Vec<f64>, t: f64) -> PyResult<()> {
        let mut run = self.run(py)?;
        run.found.clear();
        self.raised
            .or(|| run.stepper.restart(&q, &p, t).map_err(of_run))
    }

    fn set_state(&self, py: Python<'_>, q: Vec<f64>, p: Vec<f64>) -> PyResult<()> {
        let mut run = self.run(py)?;
        run.found.clear();
        self.raised
            .or(|| run.stepper.set_state(&q, &p).map_err(of_run))
    }

    /// Tangent vectors, one after the other.
    fn tangent_vectors<'py>(&self, py: Python<'py>) -> PyResult<Doubles<'py>> {
        let run = self.run(py)?;
        let m = run.hamiltonian.degrees_of_freedom();
        let kept = m - usize::from(run.hamiltonian.has_time());
        let halves = run.tangent_vectors.chunks_exact(m);
        let visible: Vec<f64> = halves.flat_map(|half| half[..kept].to_vec()).collect();
        Ok(visible.into_pyarray(py))
    }

    fn set_tangent_vectors(&self, py: Python<'_>, tangent_vectors: Vec<f64>) -> PyResult<()> {
        let mut run = self.run(py)?;
        run.tangent_vectors = whole(&run.hamiltonian, &tangent_vectors);
        Ok(())
    }

    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let run = self.run(py)?;
        let found = run.stepper.certificate();
        certificate(py, &found)
    }
}

/// Tangent vectors (δq, δp) as the tangent map propagates them: with (δt, δp_t) = 0 where H depends on time.
fn whole(hamiltonian: &Hamiltonian, tangent_vectors: &[f64]) -> Vec<f64> {
    let m = hamiltonian.degrees_of_freedom();
    let kept = m - usize::from(hamiltonian.has_time());
    let mut whole = vec![0.0; tangent_vectors.len() / kept * m];
    let halves = whole
        .chunks_exact_mut(m)
        .zip(tangent_vectors.chunks_exact(kept));
    halves.for_each(|(whole, half)| whole[..kept].copy_from_slice(half));
    whole
}

/// A fixed step that reaches a target.
#[pyfunction]
pub(crate) fn suggest_step(
    py: Python<'_>,
    system: &Recorded,
    start: Pairs,
    span: (f64, f64),
    options: Options,
    target: (String, f64),
) -> PyResult<f64> {
    let method = options.method()?;
    let target = match target.0.as_str() {
        "phase" => Target::Phase(target.1),
        "energy" => Target::Energy(target.1),
        _ => Target::Trajectory(target.1),
    };
    let (q, p) = start;
    let hamiltonian = system.hamiltonian.clone();
    let search = move |stop: &Stop| {
        let mut signals = Signals::new(stop, Reached::default(), None);
        let span = span.0..=span.1;
        let found = method.suggest_step_observed(&hamiltonian, &q, &p, span, target, &mut signals);
        found.map_err(of_run)
    };
    system.raised.or(|| patiently(py, search).flatten())
}
