//! Symmetric compositions of Störmer–Verlet with the force by hand, for H = Σ p²/(2m) + U(q).
//!
//! In `f64` they are contestants: what a program with hand-written force and the best explicit symplectic
//! method reaches, without anything that it need not do. In double-double the one of order 10 makes end
//! states that have no closed form.

use crate::clock::turn;
use crate::contestant::{Contestant, Ladder, Ran};
use crate::contestants::coefficients::{Composition, KAHAN_LI, SOFRONIOU_SPALETTA};
use crate::problem::Problem;
use crate::task::Task;
use equip::scalar::Float;
use equip::prelude::*;

/// Sizes of drifts and kicks within a step.
struct Parts<T> {
    kicks: Vec<T>,
    drifts: Vec<T>,
}

impl<T: Float> Parts<T> {
    fn new(scheme: &Composition, h: T) -> Self {
        let kicks: Vec<T> = scheme.gammas::<T>().into_iter().map(|g| g * h).collect();
        let half = T::ratio(1, 2);
        let at = |i: usize| kicks.get(i).copied().unwrap_or(T::int(0));
        let before = |i: usize| if i == 0 { T::int(0) } else { at(i - 1) };
        // Neighbouring half drifts are made as one.
        let drifts = (0..=kicks.len()).map(|i| half * (before(i) + at(i)));
        Parts {
            drifts: drifts.collect(),
            kicks,
        }
    }
}

/// A state with room for the force.
#[derive(Debug, Clone)]
struct State<T> {
    q: Vec<T>,
    p: Vec<T>,
    force: Vec<T>,
}

impl<T: Float> State<T> {
    fn new(q: &[f64], p: &[f64]) -> Self {
        let exact = |x: &[f64]| x.iter().map(|&x| T::exact(x)).collect::<Vec<_>>();
        State {
            q: exact(q),
            p: exact(p),
            force: vec![T::int(0); q.len()],
        }
    }

    fn kick(&mut self, problem: &impl Problem, by: T) {
        problem.force(&self.q, &mut self.force);
        for (p, &f) in self.p.iter_mut().zip(&self.force) {
            *p += by * f;
        }
    }

    /// `steps` steps; the last drift of a step and the first of the next one are made as one.
    fn advance(&mut self, problem: &impl Problem, parts: &Parts<T>, steps: u64) {
        let stages = parts.kicks.len();
        problem.drift(&mut self.q, &self.p, parts.drifts[0]);
        for step in 1..=steps {
            for i in 0..stages {
                self.kick(problem, parts.kicks[i]);
                let mut by = parts.drifts[i + 1];
                if i + 1 == stages && step < steps {
                    by += parts.drifts[0];
                }
                problem.drift(&mut self.q, &self.p, by);
            }
        }
    }
}

/// (q, p) at `end`, in double-double by the composition of order 10.
pub fn propagate<P: Problem>(
    problem: &P,
    (q, p): (&[f64], &[f64]),
    end: f64,
    steps: u64,
) -> Vec<DoubleDouble> {
    let h = DoubleDouble::exact(end) / DoubleDouble::int(steps as i64);
    let mut state = State::new(q, p);
    state.advance(problem, &Parts::new(&SOFRONIOU_SPALETTA, h), steps);
    [state.q, state.p].concat()
}

/// A composition on a task, in `f64`.
struct Composed<P> {
    problem: P,
    scheme: Composition,
    start: State<f64>,
    end: f64,
    ladder: Ladder,
}

/// The compositions that are worth running on a task.
pub fn contestants<P: Problem>(problem: &P, task: &Task) -> Vec<Box<dyn Contestant>> {
    let boxed = |scheme| {
        Box::new(Composed {
            problem: problem.clone(),
            scheme,
            start: State::new(&task.q, &task.p),
            end: task.end,
            ladder: Ladder::steps((2.0 * task.periods).ceil(), 64.0 * task.periods),
        }) as Box<dyn Contestant>
    };
    vec![boxed(SOFRONIOU_SPALETTA), boxed(KAHAN_LI)]
}

impl<P: Problem> Contestant for Composed<P> {
    fn program(&self) -> &str {
        "composition"
    }

    fn method(&self) -> String {
        self.scheme.name.into()
    }

    fn ladder(&self) -> Ladder {
        self.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        let parts = Parts::new(&self.scheme, self.end / setting);
        let steps = setting as u64;
        let (seconds, state) = turn(
            || self.start.clone(),
            |state| {
                state.advance(&self.problem, &parts, steps);
                Ok::<(), String>(())
            },
        )?;
        let end = state.q.iter().chain(&state.p);
        Ok(Ran {
            seconds,
            end: end.map(|&x| DoubleDouble::exact(x)).collect(),
            steps: Some(steps),
        })
    }
}
