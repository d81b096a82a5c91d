//! The methods of the report, and how one run of each is made and measured.

use super::subject::Subject;
use crate::run::integrator::equip_or_gauss;
use cpu_time::ThreadTime;
use equip_integrate::{Certificate, Invariant, Method, Record};
use equip_scalar::Float;

/// A method of the report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contender {
    /// EQUIP or Gauss.
    pub(super) is_equip: bool,
    pub(super) stages: usize,
    /// Whether the step controller selects the steps; else they are fixed.
    pub(super) adapts: bool,
}

/// Which methods to run with which stages.
pub(super) fn contenders(stages: &[usize]) -> Vec<Contender> {
    let of = |is_equip| {
        let one = move |stages, adapts| Contender {
            is_equip,
            stages,
            adapts,
        };
        let fixed = stages.iter().map(move |&s| one(s, false));
        // One shows what step control changes on a scene.
        fixed.chain(stages.contains(&8).then(|| one(8, true)))
    };
    of(true).chain(of(false)).collect()
}

/// What a run did, all in `f64`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Outcome {
    pub(super) error: f64,
    /// Largest |ΔH| over the steps.
    pub(super) energy: f64,
    /// |H₀|, and the largest round-off level of H if EQUIP computed it.
    pub(super) start: f64,
    pub(super) round_off: Option<f64>,
    /// Steps whose energy error was not removed.
    pub(super) uncorrected: u64,
    /// Largest error of each invariant.
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
        let method = if self.is_equip { "EQUIP" } else { "Gauss" };
        let control = if self.adapts { " step control" } else { "" };
        format!("{method}({}){control}", self.stages)
    }

    pub(super) fn order(&self) -> usize {
        self.method().order()
    }

    fn method(&self) -> Method {
        equip_or_gauss(self.is_equip, self.stages)
    }

    /// Setting number `k`, from coarse to fine.
    pub(super) fn setting<T: Float>(&self, subject: &Subject<T>, k: i32) -> f64 {
        if self.adapts {
            10_f64.powi(-4 - k)
        } else {
            (subject.fewest * 4.0 / self.stages as f64 * 1.4_f64.powi(k)).ceil()
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
        let (q, p) = subject.start.split_at(subject.start.len() / 2);
        let setting = T::exact(setting);
        let integrator = match self.adapts {
            true => self.method().tolerance(setting).max_steps(MOST_STEPS),
            false => self.method().step(subject.end / setting),
        };
        let mut integrator = integrator.measure_energy(watched).record(Record::Ends);
        for invariant in subject.instance.invariants().iter().filter(|_| watched) {
            let invariant = Invariant::new(invariant.name, invariant.quantity.clone());
            integrator = integrator.invariant(invariant);
        }
        let (h, interval) = (subject.instance.hamiltonian(), T::int(0)..=subject.end);
        let begun = ThreadTime::now();
        let run = integrator.integrate(h, q, p, interval);
        let run = run.map_err(|e| e.to_string())?;
        let seconds = begun.elapsed().as_secs_f64();
        let (_, q, p) = run.last();
        Ok((outcome(run.certificate()), [q, p].concat(), seconds))
    }
}

/// Steps after which a run by tolerance is given up.
const MOST_STEPS: u64 = 200_000;

fn outcome<T: Float>(certificate: &Certificate<T>) -> Outcome {
    let invariants = certificate.invariants.iter();
    let energy = certificate.energy.as_ref();
    let round_off = certificate
        .energy_round_off
        .map(|level| level.round_off.to_f64());
    Outcome {
        error: f64::NAN,
        energy: energy.map_or(f64::NAN, |e| e.max.to_f64()),
        start: energy.map_or(f64::NAN, |e| e.start.to_f64().abs()),
        round_off: round_off.filter(|round_off| *round_off > 0.0 && round_off.is_finite()),
        uncorrected: certificate.counts.uncorrected(),
        invariants: invariants.map(|i| i.max.to_f64()).collect(),
        steps: certificate.counts.steps,
        gradients: certificate.counts.gradients,
        iterations: certificate.counts.newton_iterations
            + certificate.counts.fixed_point_iterations,
    }
}
