//! Runs of EQUIP as it comes and of Gauss, as the tests of cases from outside make them: the only file of
//! those tests that uses the solver.

use crate::Start;
use cpu_time::ThreadTime;
use equip_autodiff::Hamiltonian;
use equip_integrate::{Certificate, Equip, Gauss, Method, Record};
use equip_scalar::Float;

/// Who makes the steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Who {
    /// EQUIP as it comes.
    Equip,
    /// Gauss.
    Gauss,
}

/// A start of a system, and a number of stages.
#[derive(Debug, Clone, Copy)]
pub struct Trial<'a, T> {
    /// H.
    pub hamiltonian: &'a Hamiltonian,
    /// q(0).
    pub q: &'a [T],
    /// p(0).
    pub p: &'a [T],
    /// Stages s.
    pub stages: usize,
}

/// What a run left.
#[derive(Debug, Clone)]
pub struct Made<T> {
    /// (q, p) at the end.
    pub state: Vec<T>,
    /// Steps made.
    pub steps: u64,
    /// Steps whose energy defect is left to later ones.
    pub uncorrected: u64,
    /// Evaluations of ∇H.
    pub gradients: u64,
    /// Evaluations of ∇²H.
    pub hessians: u64,
    /// Operations of ∇²H over those of ∇H.
    pub hessian_cost: f64,
    /// CPU time of the run, seconds.
    pub seconds: f64,
    /// Whether the certificate says that the steps do not resolve the motion.
    pub says_unresolved: bool,
}

impl<T> Made<T> {
    /// Work in gradients, a Hessian counting as its operations.
    pub fn work(&self) -> f64 {
        self.gradients as f64 + self.hessian_cost * self.hessians as f64
    }
}

impl<'a, T: Float> Trial<'a, T> {
    /// A trial of a system from a start.
    pub fn new(hamiltonian: &'a Hamiltonian, start: &'a Start<T>, stages: usize) -> Self {
        Trial {
            hamiltonian,
            q: &start.q,
            p: &start.p,
            stages,
        }
    }

    fn method(&self, who: Who) -> Method {
        match who {
            Who::Equip => Equip::stages(self.stages),
            Who::Gauss => Gauss::stages(self.stages),
        }
    }

    /// `steps` steps of size `h`; `each` sees the state after every step.
    ///
    /// # Errors
    /// The text of the solver's error.
    pub fn steps(
        &self,
        who: Who,
        (h, steps): (T, u64),
        mut each: impl FnMut(u64, &[T], &[T]),
    ) -> Result<Made<T>, String> {
        let options = self.method(who).step(h);
        let start = options.start(self.hamiltonian, self.q, self.p, T::int(0));
        let mut stepper = start.map_err(|error| error.to_string())?;
        let begun = ThreadTime::now();
        for index in 1..=steps {
            let view = stepper.advance().map_err(|error| error.to_string())?;
            each(index, view.q, view.p);
        }
        let seconds = begun.elapsed().as_secs_f64();
        let view = stepper.view();
        Ok(made(
            self.hamiltonian,
            [view.q, view.p].concat(),
            &stepper.certificate(),
            seconds,
        ))
    }

    /// EQUIP's and Gauss's run of `steps` steps of size `h`.
    pub fn both(&self, h: T, steps: u64) -> [Result<Made<T>, String>; 2] {
        [Who::Equip, Who::Gauss].map(|who| self.steps(who, (h, steps), |_, _, _| ()))
    }

    /// EQUIP's and Gauss's run by a tolerance.
    pub fn both_by_tolerance(&self, tolerance: T, end: T) -> [Result<Made<T>, String>; 2] {
        [Who::Equip, Who::Gauss].map(|who| self.tolerance(who, tolerance, end))
    }

    /// Steps chosen for `tolerance`, from 0 to `end`.
    ///
    /// # Errors
    /// The text of the solver's error.
    pub fn tolerance(&self, who: Who, tolerance: T, end: T) -> Result<Made<T>, String> {
        let options = self.method(who).tolerance(tolerance).record(Record::Ends);
        let begun = ThreadTime::now();
        let run = options.integrate(self.hamiltonian, self.q, self.p, T::int(0)..=end);
        let run = run.map_err(|error| error.to_string())?;
        let seconds = begun.elapsed().as_secs_f64();
        let (_, q, p) = run.last();
        Ok(made(
            self.hamiltonian,
            [q, p].concat(),
            run.certificate(),
            seconds,
        ))
    }
}

fn made<T: Float>(
    hamiltonian: &Hamiltonian,
    state: Vec<T>,
    certificate: &Certificate<T>,
    seconds: f64,
) -> Made<T> {
    let counts = &certificate.counts;
    Made {
        state,
        steps: counts.steps,
        uncorrected: counts.uncorrected(),
        gradients: counts.gradients,
        hessians: counts.hessians,
        hessian_cost: hamiltonian.hessian_operations() as f64
            / hamiltonian.gradient_operations() as f64,
        seconds,
        says_unresolved: certificate.to_string().contains("wrong phase"),
    }
}
