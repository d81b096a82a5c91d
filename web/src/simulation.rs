//! [`Simulation`]: EQUIP and Gauss with the same system, stages and steps.

use crate::error::SimulationError;
use crate::expression::Expression;
use crate::track::Track;
use equip::integrate::{IntegrateError, StepView, Stepper};
use equip::prelude::{Certificate, Equip, Gauss, Hamiltonian, Method};

/// Most degrees of freedom.
const MOST_DEGREES: usize = 64;

/// Two runs of one system from one initial condition: EQUIP and Gauss. Of one stage there is Gauss alone.
#[derive(Debug)]
pub struct Simulation {
    equip: Option<Stepper<f64>>,
    gauss: Stepper<f64>,
    initial_energy: f64,
    round_off_level: f64,
    failure: Option<String>,
}

/// The steps made by [`Simulation::advance`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Progress {
    /// Times at the ends of the steps.
    pub times: Vec<f64>,
    /// Steps of EQUIP; none of one stage.
    pub equip: Track,
    /// Steps of Gauss.
    pub gauss: Track,
    /// Why the step after these failed, and of which method.
    pub failure: Option<String>,
}

impl Simulation {
    /// Reads H, with as many degrees of freedom as there are positions, and prepares both runs at t = 0.
    ///
    /// # Errors
    /// [`SimulationError`]: what is wrong with H, the initial condition, the stages or the step.
    ///
    /// ```
    /// use equip_web::Simulation;
    /// let mut pendulum = Simulation::new("p^2/2 - cos(q)", &[0.0], &[1.5], 3, 0.2)?;
    /// let progress = pendulum.advance(100);
    /// assert_eq!(progress.times.len(), 100);
    /// assert!(progress.equip.energy_errors.iter().all(|&error| error < 1e-14));
    /// # Ok::<(), equip_web::SimulationError>(())
    /// ```
    pub fn new(
        energy: &str,
        q: &[f64],
        p: &[f64],
        stages: usize,
        step: f64,
    ) -> Result<Self, SimulationError> {
        let (positions, momenta) = (q.len(), p.len());
        if positions != momenta {
            return Err(SimulationError::Lengths { positions, momenta });
        }
        if !(1..=MOST_DEGREES).contains(&positions) {
            return Err(SimulationError::DegreesOfFreedom {
                found: positions,
                most: MOST_DEGREES,
            });
        }
        let system = Expression::read(energy, positions)?.hamiltonian()?;
        let value = system.evaluator::<f64>().value(&[q, p].concat());
        if !value.is_finite() {
            return Err(SimulationError::EnergyNotFinite { value });
        }
        let start =
            |method: Method, system: &Hamiltonian| method.step(step).start(system, q, p, 0.0);
        let equip = match stages {
            1 => None,
            stages => Some(start(Equip::stages(stages), &system)?),
        };
        Ok(Simulation {
            equip,
            gauss: start(Gauss::stages(stages), &system)?,
            initial_energy: value,
            round_off_level: f64::EPSILON,
            failure: None,
        })
    }

    /// Makes so many steps of both methods, or fewer if one fails. After a failure no further steps are made.
    pub fn advance(&mut self, steps: usize) -> Progress {
        let mut progress = Progress::default();
        while self.failure.is_none() && progress.times.len() < steps {
            if let Err(failure) = self.step(&mut progress) {
                self.failure = Some(failure);
            }
        }
        progress.failure.clone_from(&self.failure);
        progress
    }

    fn step(&mut self, progress: &mut Progress) -> Result<(), String> {
        let scale = self.energy_scale();
        let equip = self.equip.as_mut().map(|equip| made("EQUIP", equip));
        let equip = equip.transpose()?;
        let gauss = made("Gauss", &mut self.gauss)?;
        if let Some(equip) = equip {
            let level = equip.energy_round_off.unwrap_or(0.0) / scale;
            self.round_off_level = self.round_off_level.max(level);
            progress.equip.push(&equip, scale);
        }
        progress.gauss.push(&gauss, scale);
        progress.times.push(gauss.time);
        Ok(())
    }

    /// What energy errors are divided by: |H0|, or 1 if that is 0.
    pub fn energy_scale(&self) -> f64 {
        match self.initial_energy {
            0.0 => 1.0,
            energy => energy.abs(),
        }
    }

    /// H at the initial condition.
    pub fn initial_energy(&self) -> f64 {
        self.initial_energy
    }

    /// The largest round-off level of H so far, divided as energy errors are; at least ε of doubles.
    pub fn round_off_level(&self) -> f64 {
        self.round_off_level
    }

    /// The certificate of EQUIP so far; none of one stage.
    pub fn equip_certificate(&self) -> Option<Certificate<f64>> {
        self.equip.as_ref().map(Stepper::certificate)
    }

    /// The certificate of Gauss so far.
    pub fn gauss_certificate(&self) -> Certificate<f64> {
        self.gauss.certificate()
    }

    /// Decimal digits to which a run conserved the energy: −log₁₀ of the largest error, at most 16.
    pub fn digits(&self, certificate: &Certificate<f64>) -> f64 {
        let largest = certificate.energy.as_ref().map_or(f64::NAN, |e| e.max);
        let relative = largest / self.energy_scale();
        match relative {
            0.0 => 16.0,
            relative => -relative.log10().max(-16.0),
        }
    }
}

/// The next step of a method, or the message of its failure.
fn made<'a>(name: &str, run: &'a mut Stepper<f64>) -> Result<StepView<'a, f64>, String> {
    run.advance()
        .map_err(|error: IntegrateError<f64>| format!("{name}: {error}"))
}
