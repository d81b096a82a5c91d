//! EQUIP(s) with fixed steps, by closure, by trait, and with the gradient by hand.

use crate::clock::turn;
use crate::contestant::{Contestant, Ladder, Ran};
use crate::task::Task;
use equip::prelude::*;
use std::rc::Rc;

/// EQUIP(s) on a task, for one way to give H and one number type.
pub struct Ours<H, T> {
    system: Rc<H>,
    route: &'static str,
    stages: usize,
    ladder: Ladder,
    q: Vec<T>,
    p: Vec<T>,
    end: T,
}

impl<H: System, T: Float> Ours<H, T> {
    pub fn new(system: &Rc<H>, route: &'static str, stages: usize, task: &Task) -> Self {
        let exact = |x: &Vec<f64>| x.iter().map(|&x| T::exact(x)).collect();
        // A method of order 2s needs no fewer evaluations a natural period than about a dozen.
        let fewest = (task.periods * 8.0 / stages as f64).max(2.0).ceil();
        let most = fewest * task.finest;
        Ours {
            system: Rc::clone(system),
            route,
            stages,
            ladder: Ladder::steps(fewest, most),
            q: exact(&task.q),
            p: exact(&task.p),
            end: T::exact(task.end),
        }
    }
}

impl<H: System, T: Float> Contestant for Ours<H, T> {
    fn program(&self) -> &str {
        "equip"
    }

    fn method(&self) -> String {
        format!("{}, s = {}", self.route, self.stages)
    }

    fn ladder(&self) -> Ladder {
        self.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        let steps = setting as u64;
        let h = self.end / T::exact(setting);
        let integrator = Equip::stages(self.stages)
            .step(h)
            .stage_solver(StageSolver::Sweeps);
        let prepare = || integrator.start(&*self.system, &self.q, &self.p, T::int(0));
        let (seconds, state) = turn(prepare, |stepper| {
            let stepper = stepper.as_mut().map_err(|e| e.to_string())?;
            (0..steps).try_for_each(|_| stepper.advance().map(drop).map_err(|e| e.to_string()))
        })?;
        let stepper = state.map_err(|e| e.to_string())?;
        let view = stepper.view();
        let wide = |&x: &T| DoubleDouble::from_expansion(x.expansion());
        Ok(Ran {
            seconds,
            end: view.q.iter().chain(view.p).map(wide).collect(),
            steps: Some(steps),
        })
    }
}
