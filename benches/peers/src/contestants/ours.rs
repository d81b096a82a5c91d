//! EQUIP(s) with equal or variable steps, with H as a closure, and with its gradient by hand besides.

use crate::clock::turn;
use crate::contestant::{Contestant, Ladder, Ran};
use crate::task::{Sizes, Task};
use clap::ValueEnum;
use equip::integrate::Preconditioner;
use equip::scalar::Float;
use equip::prelude::*;
use std::rc::Rc;

/// Variable steps after which a run is given up.
const MOST_STEPS: u64 = 1_000_000;

/// How EQUIP's stages are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Solver {
    Automatic,
    FixedPoint,
    Newton,
}

impl Solver {
    fn choice(self) -> Preconditioner {
        match self {
            Solver::Automatic => Preconditioner::Automatic,
            Solver::FixedPoint => Preconditioner::Identity,
            Solver::Newton => Preconditioner::Full,
        }
    }
}

/// A variant of EQUIP.
#[derive(Debug, Clone, Copy)]
pub struct Variant {
    pub stages: usize,
    pub sizes: Sizes,
    pub solver: Solver,
}

impl Variant {
    /// The settings to be tried on a task, in numbers with `epsilon`.
    fn ladder(&self, task: &Task, epsilon: f64) -> Ladder {
        match self.sizes {
            Sizes::Equal => {
                // A method of order 2s needs no fewer evaluations a natural period than about half a dozen.
                let fewest = (task.periods * 6.0 / self.stages as f64).max(2.0).ceil();
                Ladder::steps(fewest, fewest * task.finest)
            }
            Sizes::Variable => Ladder::tolerances(3, -(epsilon.log10().ceil() as i32)),
        }
    }
}

/// EQUIP on a task, for one way to give H and one number type.
pub struct Ours<T> {
    h: Rc<Hamiltonian>,
    route: &'static str,
    variant: Variant,
    ladder: Ladder,
    q: Vec<T>,
    p: Vec<T>,
    end: T,
}

impl<T: Float> Ours<T> {
    pub fn new(h: &Rc<Hamiltonian>, route: &'static str, variant: Variant, task: &Task) -> Self {
        let exact = |x: &Vec<f64>| x.iter().map(|&x| T::exact(x)).collect();
        Ours {
            h: Rc::clone(h),
            route,
            variant,
            ladder: variant.ladder(task, T::EPSILON.to_f64()),
            q: exact(&task.q),
            p: exact(&task.p),
            end: T::exact(task.end),
        }
    }

    fn ran(seconds: f64, (q, p): (&[T], &[T]), steps: u64) -> Ran {
        let wide = |&x: &T| DoubleDouble::from_expansion(x.expansion());
        Ran {
            seconds,
            end: q.iter().chain(p).map(wide).collect(),
            steps: Some(steps),
        }
    }

    fn equal(&self, setting: f64) -> Result<Ran, String> {
        let steps = setting as u64;
        let h = self.end / T::exact(setting);
        let integrator = Equip::stages(self.variant.stages)
            .step(h)
            .preconditioner(self.variant.solver.choice());
        let prepare = || integrator.start(&self.h, &self.q, &self.p, T::int(0));
        let (seconds, state) = turn(prepare, |stepper| {
            let stepper = stepper.as_mut().map_err(|e| e.to_string())?;
            (0..steps).try_for_each(|_| stepper.advance().map(drop).map_err(|e| e.to_string()))
        })?;
        let stepper = state.map_err(|e| e.to_string())?;
        let view = stepper.view();
        Ok(Self::ran(seconds, (view.q, view.p), steps))
    }

    fn variable(&self, setting: f64) -> Result<Ran, String> {
        let integrator = Equip::stages(self.variant.stages)
            .tolerance(T::exact(setting))
            .record(Record::Ends)
            .max_steps(MOST_STEPS)
            .preconditioner(self.variant.solver.choice());
        // The start is timed with the rest: it chooses the first step.
        let (seconds, run) = turn(
            || None,
            |run| {
                let interval = T::int(0)..=self.end;
                let made = integrator.integrate(&self.h, &self.q, &self.p, interval);
                *run = Some(made.map_err(|e| e.to_string())?);
                Ok::<(), String>(())
            },
        )?;
        let run = run.ok_or("no run")?;
        let (_, q, p) = run.last();
        Ok(Self::ran(seconds, (q, p), run.certificate().counts.steps))
    }
}

impl<T: Float> Contestant for Ours<T> {
    fn program(&self) -> &str {
        "equip"
    }

    fn method(&self) -> String {
        let sizes = match self.variant.sizes {
            Sizes::Equal => "",
            Sizes::Variable => ", variable",
        };
        let solver = match self.variant.solver {
            Solver::Automatic => "",
            Solver::FixedPoint => " fixed point",
            Solver::Newton => " Newton",
        };
        format!("{}{sizes}: s = {}{solver}", self.route, self.variant.stages)
    }

    fn ladder(&self) -> Ladder {
        self.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        match self.variant.sizes {
            Sizes::Equal => self.equal(setting),
            Sizes::Variable => self.variable(setting),
        }
    }
}
