//! [`Options`]: method, steps and what is wanted of a run, as the Python code hands them over.

use crate::faults::value_error;
use crate::number::{Number, Pair, Pairs};
use crate::recording::recorded::Recorded;
use equip::integrate::{AlphaPolicy, Alphas, Integrator, Preconditioner};
use equip::prelude::*;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Name, function, direction, whether it ends the run, and what it does to the state.
type EventOptions = (String, Py<Recorded>, i8, bool, Option<Py<PyAny>>);

/// Positions and momenta that an event has made; None where it has raised an exception, which it keeps.
type Changed<'py> = Option<(PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>)>;

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    family: String,
    stages: usize,
    alpha: Pair,
    alpha_policy: String,
    alpha_bound: f64,
    preconditioner: String,
    measure_energy: bool,
    pub(crate) step: Option<Pair>,
    tolerance: f64,
    rtol: Option<Pairs>,
    atol: Option<Pairs>,
    first_step: Option<f64>,
    min_step: f64,
    max_step: f64,
    max_steps: u64,
    record: u64,
    t_eval: Pairs,
    dense: bool,
    chaos: bool,
    invariants: Vec<(String, Py<Recorded>)>,
    preserve: Vec<(String, Py<Recorded>)>,
    events: Vec<EventOptions>,
}

impl Options {
    pub(crate) fn method(&self) -> PyResult<Method> {
        Ok(match self.family.as_str() {
            "equip" => Equip::stages(self.stages),
            "equip-last" => Equip::stages(self.stages).alphas(Alphas::Last),
            "gauss" => Gauss::stages(self.stages),
            "fixed-alpha" => {
                Method::fixed_alpha(self.stages, DoubleDouble::new(self.alpha.0, self.alpha.1))
            }
            other => Method::named(other)
                .ok_or_else(|| value_error(format!("unknown family {other}")))?,
        })
    }

    /// The integrator.
    pub(crate) fn integrator<T: Number>(&self) -> PyResult<Integrator<T>> {
        let method = self.method()?;
        self.fill(match self.step {
            Some(h) => method.step(T::read(h)),
            None => {
                let tolerance = T::exact(self.tolerance);
                let sizes = method.tolerance(tolerance).max_steps(self.max_steps);
                let mut sizes = sizes
                    .min_step(T::exact(self.min_step))
                    .max_step(T::exact(self.max_step));
                let exact = |x: &[f64]| x.iter().map(|&x| T::exact(x)).collect::<Vec<T>>();
                if let Some((q, p)) = &self.rtol {
                    sizes = sizes.rtol(&exact(q), &exact(p));
                }
                if let Some((q, p)) = &self.atol {
                    sizes = sizes.atol(&exact(q), &exact(p));
                }
                if let Some(h) = self.first_step {
                    sizes = sizes.first_step(T::exact(h));
                }
                sizes
            }
        })
    }

    /// The events.
    pub(crate) fn events<T: Number>(&self) -> Vec<Event<T>> {
        let event = |(name, function, direction, ends, change): &EventOptions| {
            let mut event = Event::recorded(name, function.get().hamiltonian.clone());
            if *direction > 0 {
                event = event.rising();
            }
            if *direction < 0 {
                event = event.falling();
            }
            if *ends {
                event = event.terminal();
            }
            if let Some(change) = change {
                let change = Arc::new(Python::attach(|py| change.clone_ref(py)));
                event = event.then(move |t, q, p| change_state(&change, t, q, p));
            }
            event
        };
        self.events.iter().map(event).collect()
    }

    fn fill<T: Number>(&self, integrator: Integrator<T>) -> PyResult<Integrator<T>> {
        let mut integrator = integrator
            .output_at(&T::read_all(&self.t_eval))
            .alpha_bound(T::exact(self.alpha_bound))
            .measure_energy(self.measure_energy)
            .record(match self.record {
                0 => Record::Ends,
                k => Record::Every(k),
            })
            .alpha_policy(match self.alpha_policy.as_str() {
                "within error" => AlphaPolicy::WithinError,
                "always" => AlphaPolicy::Always,
                "refuse" => AlphaPolicy::Refuse,
                other => return Err(value_error(format!("unknown alpha_policy {other}"))),
            })
            .preconditioner(match self.preconditioner.as_str() {
                "automatic" => Preconditioner::Automatic,
                "identity" => Preconditioner::Identity,
                "diagonal" => Preconditioner::Diagonal,
                "frozen" => Preconditioner::Frozen,
                "full" => Preconditioner::Full,
                other => return Err(value_error(format!("unknown preconditioner {other}"))),
            });
        if self.dense {
            integrator = integrator.dense();
        }
        if self.chaos {
            integrator = integrator.chaos();
        }
        let invariant = |(name, function): &(String, Py<Recorded>)| {
            Invariant::new(name, function.get().hamiltonian.clone())
        };
        for watched in &self.invariants {
            integrator = integrator.invariant(invariant(watched));
        }
        for kept in &self.preserve {
            integrator = integrator.preserve(invariant(kept));
        }
        for event in self.events() {
            integrator = integrator.event(event);
        }
        Ok(integrator)
    }
}

/// Calls a function of Python with a state, and takes over the one it returns.
fn change_state<T: Number>(change: &Py<PyAny>, t: T, q: &mut [T], p: &mut [T]) -> ControlFlow<()> {
    Python::attach(|py| {
        let array = |x: &[T]| {
            let numbers: Vec<f64> = x.iter().map(|x| x.high()).collect();
            numbers.into_pyarray(py)
        };
        let found = change.bind(py).call1((t.high(), array(q), array(p)));
        let changed = found.and_then(|found| found.extract::<Changed<'_>>());
        let Ok(Some((new_q, new_p))) = changed else {
            return ControlFlow::Break(());
        };
        for (old, new) in [(q, new_q), (p, new_p)] {
            match new.as_slice() {
                Ok(new) if new.len() == old.len() => {
                    old.iter_mut()
                        .zip(new)
                        .for_each(|(old, &new)| *old = T::exact(new));
                }
                _ => return ControlFlow::Break(()),
            }
        }
        ControlFlow::Continue(())
    })
}
