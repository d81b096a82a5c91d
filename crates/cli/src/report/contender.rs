//! The methods of the report, and how one run of each is made and measured.

use super::methods::composition::Composition;
use super::methods::dop853::Dop853;
use super::methods::flow::Flow;
use super::subject::Subject;
use cpu_time::ThreadTime;
use equip_autodiff::Evaluate;
use equip_integrate::{Certificate, Equip, Gauss, Invariant, Method, Record};
use equip_scalar::Float;
use equip_tableau::composition::{Composition as Scheme, KAHAN_LI, SOFRONIOU_SPALETTA, VERLET};

/// A method of the report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Contender {
    Equip(usize),
    Gauss(usize),
    /// EQUIP with variable steps.
    Variable(usize),
    Composition(Scheme),
    Dop853,
}

/// Which methods to run with which stages.
pub(super) fn contenders(stages: &[usize]) -> Vec<Contender> {
    let ours = stages.iter().map(|&s| Contender::Equip(s));
    let gauss = stages.iter().map(|&s| Contender::Gauss(s));
    let schemes = [VERLET, KAHAN_LI, SOFRONIOU_SPALETTA].map(Contender::Composition);
    // One is enough to see what steps of their own size are worth on a scene.
    let variable = stages.iter().filter(|s| **s == 8);
    ours.chain(variable.map(|&s| Contender::Variable(s)))
        .chain(gauss)
        .chain(schemes)
        .chain([Contender::Dop853])
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
    /// Newton iterations and sweeps, for methods that have them.
    pub(super) iterations: Option<u64>,
}

impl Contender {
    pub(super) fn name(&self) -> String {
        match self {
            Contender::Equip(s) => format!("EQUIP({s})"),
            Contender::Gauss(s) => format!("Gauss({s})"),
            Contender::Variable(s) => format!("EQUIP({s}) variable"),
            Contender::Composition(scheme) => scheme.name.into(),
            Contender::Dop853 => "DOP853".into(),
        }
    }

    pub(super) fn order(&self) -> usize {
        match self {
            Contender::Equip(s) | Contender::Variable(s) | Contender::Gauss(s) => 2 * s,
            Contender::Composition(scheme) => scheme.order as usize,
            Contender::Dop853 => 8,
        }
    }

    /// For methods of this library: which.
    fn method(&self) -> Option<Method> {
        match self {
            Contender::Equip(s) => Some(Equip::stages(*s)),
            Contender::Gauss(s) => Some(Gauss::stages(*s)),
            Contender::Variable(s) => Some(Equip::stages(*s)),
            _ => None,
        }
    }

    /// Whether its setting is a tolerance; else it is a number of steps.
    pub(super) fn adapts(&self) -> bool {
        matches!(self, Contender::Dop853 | Contender::Variable(_))
    }

    /// Whether it keeps the energy by itself.
    pub(super) fn keeps_energy(&self) -> bool {
        matches!(self, Contender::Equip(_) | Contender::Variable(_))
    }

    /// Setting number `k`, from coarse to fine.
    pub(super) fn setting<T: Float>(&self, subject: &Subject<T>, k: i32) -> f64 {
        let finer = 1.4_f64.powi(k);
        match self {
            Contender::Equip(s) | Contender::Gauss(s) => {
                (subject.fewest * 4.0 / *s as f64 * finer).ceil()
            }
            // As many gradients as a coarse Gauss run makes or fewer.
            Contender::Composition(scheme) if scheme.order == 2 => {
                (subject.fewest * 4.0 * finer * finer).ceil()
            }
            Contender::Composition(scheme) => {
                (subject.fewest * 20.0 / scheme.stages() as f64 * finer).ceil()
            }
            Contender::Dop853 | Contender::Variable(_) => 10_f64.powi(-4 - k),
        }
    }

    /// Whether the method can do the scene.
    pub(super) fn suits<T: Float>(&self, subject: &Subject<T>) -> bool {
        match self {
            Contender::Composition(_) => {
                Flow::inverse_masses(subject.instance.hamiltonian(), &subject.start).is_some()
            }
            _ => true,
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
        let mut watch = Watch::new(subject);
        let (mut outcome, end) = self.run(subject, setting, |y| watch.see(y))?;
        outcome.error = subject.error(&end);
        if !outcome.error.is_finite() {
            return Err("the end state is not finite".into());
        }
        if self.method().is_none() {
            (outcome.energy, outcome.invariants) = (watch.energy, watch.invariants);
        }
        Ok(outcome)
    }

    /// Seconds of CPU time of one run without anything watched.
    ///
    /// # Errors
    /// What ended the run, in words.
    pub(super) fn time<T: Float>(&self, subject: &Subject<T>, setting: f64) -> Result<f64, String> {
        if self.method().is_some() {
            return self
                .ours(subject, setting, false)
                .map(|(_, _, seconds)| seconds);
        }
        let begun = ThreadTime::now();
        self.run(subject, setting, |_: &[T]| {})?;
        Ok(begun.elapsed().as_secs_f64())
    }

    fn run<T: Float>(
        &self,
        subject: &Subject<T>,
        setting: f64,
        mut see: impl FnMut(&[T]),
    ) -> Result<(Outcome, Vec<T>), String> {
        let system = subject.instance.hamiltonian();
        let y = subject.start.clone();
        match self {
            Contender::Equip(_) | Contender::Variable(_) | Contender::Gauss(_) => {
                let ran = self.ours(subject, setting, true);
                ran.map(|(outcome, y, _)| (outcome, y))
            }
            Contender::Composition(scheme) => {
                let masses = Flow::inverse_masses(system, &y).ok_or("H is not Σ p²/(2m) + U(q)")?;
                let h = subject.end / T::exact(setting);
                let mut run = Composition::new(scheme, Flow::new(system), masses, y, h);
                let steps = setting as u64;
                for _ in 0..steps {
                    run.advance();
                    see(&run.y);
                }
                let gradients = run.gradients;
                Ok((
                    Outcome {
                        steps,
                        gradients,
                        ..Outcome::default()
                    },
                    run.y,
                ))
            }
            Contender::Dop853 => {
                let h = subject.end / T::exact(16.0 * subject.fewest);
                let mut run = Dop853::new(Flow::new(system), y, h, T::exact(setting));
                while run.advance(subject.end)? {
                    see(&run.y);
                }
                let (steps, gradients) = (run.steps, run.gradients);
                Ok((
                    Outcome {
                        steps,
                        gradients,
                        ..Outcome::default()
                    },
                    run.y,
                ))
            }
        }
    }
}

/// What a run of the library's own came to: outcome, end state, seconds of the steps.
type Ours<T> = (Outcome, Vec<T>, f64);

impl Contender {
    fn ours<T: Float>(
        &self,
        subject: &Subject<T>,
        setting: f64,
        watched: bool,
    ) -> Result<Ours<T>, String> {
        let method = self.method().ok_or("not a method of this library")?;
        if self.adapts() {
            variable(method, subject, setting, watched)
        } else {
            fixed(method, subject, setting, watched)
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
) -> Result<Ours<T>, String> {
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
) -> Result<Ours<T>, String> {
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
        iterations: Some(certificate.counts.newton_iterations + certificate.counts.sweeps),
    }
}

/// Largest defects of energy and invariants along a run.
struct Watch<T: Float> {
    quantities: Vec<(
        <equip_autodiff::Hamiltonian as equip_autodiff::System>::Evaluator<T>,
        T,
    )>,
    energy: f64,
    invariants: Vec<f64>,
}

impl<T: Float> Watch<T> {
    fn new(subject: &Subject<T>) -> Self {
        use equip_autodiff::System;
        let instance = &subject.instance;
        let invariants = instance.invariants().iter().map(|i| &i.quantity);
        let quantities = [instance.hamiltonian()]
            .into_iter()
            .chain(invariants)
            .map(|h| {
                let mut evaluator = h.evaluator::<T>();
                let start = evaluator.compensated_value(&subject.start);
                (evaluator, start)
            });
        Watch {
            quantities: quantities.collect(),
            energy: 0.0,
            invariants: vec![0.0; instance.invariants().len()],
        }
    }

    fn see(&mut self, y: &[T]) {
        for (i, (evaluator, start)) in self.quantities.iter_mut().enumerate() {
            let defect = (evaluator.compensated_value(y) - *start).to_f64().abs();
            let worst = if i == 0 {
                &mut self.energy
            } else {
                &mut self.invariants[i - 1]
            };
            if !(defect <= *worst) {
                *worst = defect;
            }
        }
    }
}
