//! Whether a run has conserved the energy to round-off: one sentence, the same in every form of a
//! [`Certificate`].

use crate::report::certificate::Certificate;
use crate::report::energy_round_off::EnergyRoundOff;
use crate::report::entries::EnergyJumps;
use crate::report::shown::shown;
use equip_scalar::Float;
use equip_solver::Outcome;

impl<T: Float> Certificate<T> {
    /// Whether every step conserved the energy to round-off. Every step must be solved, at the round-off
    /// level, or quadratic; a halved step has the outcome of its worse half. In addition neither the
    /// round-off level nor the final error may be large compared with the energies ([`EnergyRoundOff`]). An
    /// energy that was infinite or NaN, has jumped, or underflows was not conserved.
    pub fn energy_conserved_on_every_step(&self) -> bool {
        self.counts.outcome(Outcome::NotRequested) == 0 && self.reason().is_none()
    }

    /// This certificate with its first line.
    pub(crate) fn judged(mut self) -> Self {
        self.energy_conserved_to_round_off = self.verdict();
        self
    }

    fn verdict(&self) -> String {
        if self.counts.outcome(Outcome::NotRequested) > 0 {
            return format!("not requested; {}", self.largest_error());
        }
        match self.reason() {
            Some(reason) => format!("NO: {reason}"),
            None if self.counts.steps == 0 => "no step was made".to_owned(),
            None => "yes, on every step".to_owned(),
        }
    }

    fn largest_error(&self) -> String {
        match &self.energy {
            None => "its error was not measured".to_owned(),
            Some(energy) if energy.max.is_finite() => format!("largest error {:.1e}", energy.max),
            Some(_) => "H was infinite or NaN after a step".to_owned(),
        }
    }

    /// The first reason why the energy was not conserved; `None` if it was conserved.
    fn reason(&self) -> Option<String> {
        let (uncorrected, steps) = (self.counts.uncorrected(), self.counts.steps);
        if uncorrected > 0 {
            let error = self.largest_error();
            return Some(format!(
                "{uncorrected} of {steps} steps uncorrected, {error}"
            ));
        }
        if self.energy.as_ref().is_some_and(|e| !e.max.is_finite()) {
            return Some(self.largest_error());
        }
        if let Some(EnergyJumps { count, largest }) = self.energy_jumps {
            return Some(format!("H jumps {count} times, by up to {largest:.1e}"));
        }
        self.energy_round_off
            .as_ref()
            .and_then(|level| self.reason_of(level))
    }

    /// Why the energy was not conserved although its error was below the round-off level at every step.
    fn reason_of(&self, level: &EnergyRoundOff<T>) -> Option<String> {
        if level.underflows && level.scale == T::int(0) {
            return Some("H underflows to 0; choose units in which it does not".to_owned());
        }
        let EnergyRoundOff {
            round_off,
            time,
            scale,
            ..
        } = *level;
        let time = shown(time);
        if !level.is_small() {
            return Some(format!(
                "round-off level {round_off:.1e} at t = {time}; energies {scale:.1e}"
            ));
        }
        let energy = self.energy.as_ref()?;
        let is_conserved = level.is_small_at_end(energy.end, energy.start);
        (!is_conserved).then(|| {
            let error = energy.end.abs();
            format!("only to {error:.1e} after t = {time} (round-off level {round_off:.1e})")
        })
    }
}
