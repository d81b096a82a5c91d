//! The start of a run: checks, references, workspace.

use crate::error::IntegrateError;
use crate::options::fixed_step::FixedStep;
use crate::report::defect::{Defect, Watched};
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_solver::{Constraint, Core, MAX_STAGES, Outcome, State};
use equip_tableau::Gauss;
use std::time::Instant;

impl<T: Float> FixedStep<T> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, without making a step.
    ///
    /// # Errors
    /// Every fault of options, step and initial values, and an H that is not finite at the start.
    pub fn start<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<Stepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let settings = self.validate()?;
        check_initial(system.degrees_of_freedom(), q0, p0)?;
        if t0 + self.h == t0 || !t0.is_finite() {
            return Err(IntegrateError::StepBelowTimeResolution {
                step: self.h,
                time: t0,
            });
        }
        let stages = settings.stages;
        let gauss = Gauss::new(stages).map_err(|_| IntegrateError::StagesOutOfRange {
            stages,
            min: 1,
            max: MAX_STAGES,
        })?;
        let y = State::new(q0, p0);
        let mut evaluator = system.evaluator::<T>();
        let mut gradient = vec![T::int(0); y.hi.len()];
        let h_ref = evaluator.gradient_with_compensated_value(&y.hi, &mut gradient);
        if !h_ref.is_finite() || gradient.iter().any(|g| !g.is_finite()) {
            return Err(IntegrateError::EnergyNotFinite { energy: h_ref });
        }
        for invariant in self.invariants.iter().chain(&self.kept) {
            let (expected, found) = (
                system.degrees_of_freedom(),
                invariant.function().degrees_of_freedom(),
            );
            if expected != found {
                return Err(IntegrateError::WrongLength {
                    what: "an invariant",
                    expected,
                    found,
                });
            }
        }
        let has_target = settings.first_alpha.is_some() && !system.structure().is_quadratic();
        let mut constraints = Vec::new();
        if has_target {
            constraints.push(Constraint::energy(h_ref, y.hi.len()));
        }
        constraints.extend(self.kept.iter().map(|i| Constraint::invariant(i, &y.hi)));
        let free = settings.first_alpha.map_or(0, |first| stages - first);
        if constraints.len() > free {
            let (kept, alphas) = (constraints.len(), free);
            return Err(IntegrateError::TooFewAlphas { kept, alphas });
        }
        let alphas = if constraints.is_empty() {
            0
        } else {
            stages - 1
        };
        let core = Core::new(system, evaluator, settings, gauss, constraints);
        let measured = has_target || self.measure_energy;
        Ok(Stepper {
            method: self.method,
            has_target,
            t0,
            h: self.h,
            h_ref,
            index: 0,
            time: t0,
            next: y.clone(),
            measure_energy: self.measure_energy,
            energy: measured.then(|| Defect::new("energy", h_ref)),
            in_floors: has_target.then(|| T::int(0)),
            watched: self
                .kept
                .iter()
                .chain(&self.invariants)
                .map(|i| Watched::new(i, &y.hi))
                .collect(),
            alpha_range: vec![(T::int(0), T::int(0)); alphas],
            last: (T::int(0), Outcome::NotAsked),
            floor: None,
            variable: None,
            begun: Instant::now(),
            fingerprint: self.fingerprint(),
            y,
            core,
        })
    }
}

fn check_initial<T: Float>(m: usize, q0: &[T], p0: &[T]) -> Result<(), IntegrateError<T>> {
    for (what, values) in [("q0", q0), ("p0", p0)] {
        if values.len() != m {
            let found = values.len();
            return Err(IntegrateError::WrongLength {
                what,
                expected: m,
                found,
            });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, x)| !x.is_finite()) {
            return Err(IntegrateError::InitialNotFinite { what, index, value });
        }
    }
    Ok(())
}
