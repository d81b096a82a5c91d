//! The methods of the report, and how one run of each is made and measured.

use super::subject::Subject;
use cpu_time::ThreadTime;
use equip_integrate::{Certificate, Equip, Gauss, Invariant, Method, Record};
use equip_scalar::Float;

/// A method of the report, with its stages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Contender {
    Equip(usize),
    Gauss(usize),
    /// EQUIP with variable steps.
    Variable(usize),
}

/// Which methods to run with which stages.
pub(super) fn contenders(stages: &[usize]) -> Vec<Contender> {
    let ours = stages.iter().map(|&s| Contender::Equip(s));
    let gauss = stages.iter().map(|&s| Contender::Gauss(s));
    // One is enough to see what steps of their own size are worth on a scene.
    let variable = stages.iter().filter(|s| **s == 8);
    ours.chain(variable.map(|&s| Contender::Variable(s)))
        .chain(gauss)
        .collect()
}

/// What a run did, all in `f64`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Outcome {
    pub(super) error: f64,
    /// Largest |H − H(0)| over the steps.
    pub(super) energy: f64,
    /// Largest defect of each invariant.
    pub(super) invariants: Vec<f64>,
    pub(super) steps: u64,
    pub(super) gradients: u64,
    /// Newton and fixed-point iterations.
    pub(super) iterations: u64,
}

/// What a run came to: outcome, end state, seconds of the steps.
type Ran<T> = (Outcome, Vec<T>, f64);

impl Contender {
    pub(super) fn name(&self) -> String {
        match self {
            Contender::Equip(s) => format!("EQUIP({s})"),
            Contender::Gauss(s) => format!("Gauss({s})"),
            Contender::Variable(s) => format!("EQUIP({s}) variable"),
        }
    }

    pub(super) fn order(&self) -> usize {
        self.method().order()
    }

    fn method(&self) -> Method {
        match *self {
            Contender::Equip(s) | Contender::Variable(s) => Equip::stages(s),
            Contender::Gauss(s) => Gauss::stages(s),
        }
    }

    /// Whether its setting is a tolerance; else it is a number of steps.
    pub(super) fn adapts(&self) -> bool {
        matches!(self, Contender::Variable(_))
    }

    /// Whether it keeps the energy by itself.
    pub(super) fn keeps_energy(&self) -> bool {
        !matches!(self, Contender::Gauss(_))
    }

    /// Setting number `k`, from coarse to fine.
    pub(super) fn setting<T: Float>(&self, subject: &Subject<T>, k: i32) -> f64 {
        match self {
            Contender::Equip(s) | Contender::Gauss(s) => {
                (subject.fewest * 4.0 / *s as f64 * 1.4_f64.powi(k)).ceil()
            }
            Contender::Variable(_) => 10_f64.powi(-4 - k),
        }
    }

    /// One run that watches energy and invariants; its time does not count.
    ///
    /// # Errors
    /// What ended the run, in words.
    pub(super) fn watch<T: Float>(
        &self,
        subject: &Subject<T>,
        setting: f64,
    ) -> Result<Outcome, String> {
        let (mut outcome, end, _) = self.run(subject, setting, true)?;
        outcome.error = subject.error(&end);
        if !outcome.error.is_finite() {
            return Err("the end state is not finite".into());
        }
        Ok(outcome)
    }

    /// Seconds of CPU time of one run without anything watched.
    ///
    /// # Errors
    /// What ended the run, in words.
    pub(super) fn time<T: Float>(&self, subject: &Subject<T>, setting: f64) -> Result<f64, String> {
        let (_, _, seconds) = self.run(subject, setting, false)?;
        Ok(seconds)
    }

    fn run<T: Float>(
        &self,
        subject: &Subject<T>,
        setting: f64,
        watched: bool,
    ) -> Result<Ran<T>, String> {
        if self.adapts() {
            variable(self.method(), subject, setting, watched)
        } else {
            fixed(self.method(), subject, setting, watched)
        }
    }
}

fn invariants<T: Float>(subject: &Subject<T>, watched: bool) -> Vec<Invariant> {
    let all = subject.instance.invariants().iter();
    let named = all.map(|i| Invariant::new(i.name, i.quantity.clone()));
    named.filter(|_| watched).collect()
}

fn fixed<T: Float>(
    method: Method,
    subject: &Subject<T>,
    steps: f64,
    watched: bool,
) -> Result<Ran<T>, String> {
    let (q, p) = subject.start.split_at(subject.start.len() / 2);
    let mut integrator = method
        .step(subject.end / T::exact(steps))
        .measure_energy(watched);
    for invariant in invariants(subject, watched) {
        integrator = integrator.invariant(invariant);
    }
    let fault = |e: equip_integrate::IntegrateError<T>| e.to_string();
    let begun = ThreadTime::now();
    let mut stepper = integrator
        .start(subject.instance.hamiltonian(), q, p, T::int(0))
        .map_err(fault)?;
    for _ in 0..steps as u64 {
        stepper.advance().map_err(fault)?;
    }
    let seconds = begun.elapsed().as_secs_f64();
    let view = stepper.view();
    let end = [view.q, view.p].concat();
    Ok((outcome(&stepper.certificate()), end, seconds))
}

/// Steps after which a run by tolerance is given up.
const MOST_STEPS: u64 = 200_000;

fn variable<T: Float>(
    method: Method,
    subject: &Subject<T>,
    tolerance: f64,
    watched: bool,
) -> Result<Ran<T>, String> {
    let (q, p) = subject.start.split_at(subject.start.len() / 2);
    let mut integrator = method
        .tolerance(T::exact(tolerance))
        .measure_energy(watched)
        .record(Record::Ends)
        .max_steps(MOST_STEPS);
    for invariant in invariants(subject, watched) {
        integrator = integrator.invariant(invariant);
    }
    let begun = ThreadTime::now();
    let run = integrator
        .integrate(
            subject.instance.hamiltonian(),
            q,
            p,
            T::int(0)..=subject.end,
        )
        .map_err(|e| e.to_string())?;
    let seconds = begun.elapsed().as_secs_f64();
    let (_, q, p) = run.last();
    Ok((outcome(run.certificate()), [q, p].concat(), seconds))
}

fn outcome<T: Float>(certificate: &Certificate<T>) -> Outcome {
    let invariants = certificate.invariants.iter();
    Outcome {
        error: f64::NAN,
        energy: certificate
            .energy
            .as_ref()
            .map_or(f64::NAN, |e| e.max.to_f64()),
        invariants: invariants.map(|i| i.max.to_f64()).collect(),
        steps: certificate.counts.steps,
        gradients: certificate.counts.gradients,
        iterations: certificate.counts.newton_iterations
            + certificate.counts.fixed_point_iterations,
    }
}
