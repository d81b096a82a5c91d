//! [`Steps`]: a run one step at a time, with deviations carried along.

use crate::faults::of_run;
use crate::options::{Options, WithIntegrator};
use crate::recording::recorded::Recorded;
use crate::runs::certificate::certificate;
use crate::runs::signals::Signals;
use equip::autodiff::RecordedEvaluator;
use equip::prelude::*;
use equip::solver::{Fixed, Symmetric, Tolerance};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};

type Evaluator = RecordedEvaluator<f64>;

#[expect(clippy::large_enum_variant, reason = "all are ten thousand bytes")]
enum Sized {
    Fixed(Stepper<f64, Evaluator>),
    Adaptive(AdaptiveStepper<f64, Evaluator>),
    Reversible(ReversibleStepper<f64, Evaluator>),
}

macro_rules! each {
    ($sized:expr, $stepper:ident => $body:expr) => {
        match $sized {
            Sized::Fixed($stepper) => $body,
            Sized::Adaptive($stepper) => $body,
            Sized::Reversible($stepper) => $body,
        }
    };
}

struct Run {
    hamiltonian: Hamiltonian,
    stepper: Sized,
    tangent: Option<TangentMap<f64, Evaluator>>,
    deviations: Vec<f64>,
}

impl Run {
    fn advance(&mut self) -> Result<(), IntegrateError<f64>> {
        let Run {
            stepper,
            tangent,
            deviations,
            ..
        } = self;
        each!(stepper, s => {
            s.advance()?;
            match tangent {
                Some(tangent) => tangent.carry(&*s, deviations),
                None => Ok(()),
            }
        })
    }
}

impl Run {
    /// Makes the steps to the time `t`.
    fn advance_to(&mut self, t: f64) -> Result<(), IntegrateError<f64>> {
        let Run {
            stepper,
            tangent,
            deviations,
            ..
        } = self;
        each!(stepper, s => match tangent {
            Some(tangent) => tangent.advance_to(s, t, deviations),
            None => s.advance_to(t).map(drop),
        })
    }

    fn turn_back(&mut self) -> Result<(), IntegrateError<f64>> {
        match &mut self.stepper {
            Sized::Fixed(stepper) => stepper.turn_back(),
            Sized::Adaptive(stepper) => stepper.turn_back(),
            Sized::Reversible(stepper) => return stepper.turn_back(),
        }
        Ok(())
    }
}

/// A run one step at a time.
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Steps {
    run: Mutex<Run>,
}

/// Number, time, size, state, energy defect, α's and outcome of a step.
type Made<'py> = (
    u64,
    f64,
    f64,
    Bound<'py, PyArray1<f64>>,
    Option<f64>,
    Bound<'py, PyArray1<f64>>,
    &'static str,
);

impl Steps {
    fn with<R>(&self, f: impl FnOnce(&mut Run) -> R) -> R {
        f(&mut self.run.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Steps {
    #[new]
    fn new(
        system: &Recorded,
        q: Vec<f64>,
        p: Vec<f64>,
        t: f64,
        options: Options,
        deviations: Vec<f64>,
    ) -> PyResult<Self> {
        let hamiltonian = &system.hamiltonian;
        let mut stepper = options
            .with::<f64, _>(Start {
                hamiltonian,
                q: &q,
                p: &p,
                t,
            })?
            .map_err(|error| of_run(&error))?;
        let deviations = whole(hamiltonian, &deviations);
        let tangent = (!deviations.is_empty())
            .then(|| each!(&mut stepper, s => TangentMap::new(hamiltonian, s)));
        let run = Mutex::new(Run {
            hamiltonian: hamiltonian.clone(),
            stepper,
            tangent,
            deviations,
        });
        Ok(Steps { run })
    }

    /// Makes a step.
    fn advance(&self, py: Python<'_>) -> PyResult<()> {
        py.check_signals()?;
        py.detach(|| self.with(Run::advance))
            .map_err(|error| of_run(&error))
    }

    /// Makes the steps to the time `t`, forward or back.
    fn advance_to(&self, py: Python<'_>, t: f64) -> PyResult<()> {
        py.check_signals()?;
        py.detach(|| self.with(|run| run.advance_to(t)))
            .map_err(|error| of_run(&error))
    }

    /// Turns the run round in time.
    fn turn_back(&self) -> PyResult<()> {
        self.with(Run::turn_back).map_err(|error| of_run(&error))
    }

    /// The step made last.
    fn made<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.with(|run| {
            let view = each!(&run.stepper, s => s.view());
            let y = [view.q, view.p].concat().into_pyarray(py);
            let alphas = view.alphas.to_vec().into_pyarray(py);
            let outcome = view.outcome.label();
            let defect = view.energy_defect;
            (view.index, view.time, view.step, y, defect, alphas, outcome)
        })
    }

    fn restart(&self, q: Vec<f64>, p: Vec<f64>, t: f64) -> PyResult<()> {
        self.with(|run| each!(&mut run.stepper, s => s.restart(&q, &p, t)))
            .map_err(|error| of_run(&error))
    }

    fn set_state(&self, q: Vec<f64>, p: Vec<f64>) -> PyResult<()> {
        self.with(|run| each!(&mut run.stepper, s => s.set_state(&q, &p)))
            .map_err(|error| of_run(&error))
    }

    /// Deviations, one after the other.
    fn deviations<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let visible = self.with(|run| {
            let m = run.hamiltonian.degrees_of_freedom();
            let kept = m - usize::from(run.hamiltonian.has_time());
            let halves = run.deviations.chunks_exact(m);
            halves
                .flat_map(|half| half[..kept].to_vec())
                .collect::<Vec<_>>()
        });
        visible.into_pyarray(py)
    }

    fn set_deviations(&self, deviations: Vec<f64>) {
        self.with(|run| run.deviations = whole(&run.hamiltonian, &deviations));
    }

    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = self.with(|run| each!(&run.stepper, s => s.certificate()));
        certificate(py, &found)
    }
}

/// Deviations (δq, δp) as the tangent map carries them: with (δt, δp_t) = 0 where H depends on time.
fn whole(hamiltonian: &Hamiltonian, deviations: &[f64]) -> Vec<f64> {
    let m = hamiltonian.degrees_of_freedom();
    let kept = m - usize::from(hamiltonian.has_time());
    let mut whole = vec![0.0; deviations.len() / kept * m];
    let halves = whole.chunks_exact_mut(m).zip(deviations.chunks_exact(kept));
    halves.for_each(|(whole, half)| whole[..kept].copy_from_slice(half));
    whole
}

struct Start<'a> {
    hamiltonian: &'a Hamiltonian,
    q: &'a [f64],
    p: &'a [f64],
    t: f64,
}

impl WithIntegrator<f64> for Start<'_> {
    type Output = Result<Sized, IntegrateError<f64>>;

    fn fixed(self, integrator: Integrator<f64, Fixed<f64>>) -> Self::Output {
        let stepper = integrator.start(self.hamiltonian, self.q, self.p, self.t)?;
        Ok(Sized::Fixed(stepper))
    }

    fn adaptive(self, integrator: Integrator<f64, Tolerance<f64>>) -> Self::Output {
        let stepper = integrator.start(self.hamiltonian, self.q, self.p, self.t)?;
        Ok(Sized::Adaptive(stepper))
    }

    fn reversible(self, integrator: Integrator<f64, Symmetric<f64>>) -> Self::Output {
        let stepper = integrator.start(self.hamiltonian, self.q, self.p, self.t)?;
        Ok(Sized::Reversible(stepper))
    }
}

/// A fixed step that reaches a target.
#[pyfunction]
pub(crate) fn suggest_step(
    py: Python<'_>,
    system: &Recorded,
    start: (Vec<f64>, Vec<f64>),
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
    let mut signals = Signals::new(None, None);
    let found = py.detach(|| {
        let span = span.0..=span.1;
        method.suggest_step_observed(&system.hamiltonian, &q, &p, span, target, &mut signals)
    });
    match signals.fault {
        Some(fault) => Err(fault),
        None => found.map_err(|error| of_run(&error)),
    }
}
