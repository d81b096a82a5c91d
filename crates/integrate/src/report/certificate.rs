//! The certificate of a run: what the run conserved, as measured.

use crate::options::method::Method;
use crate::report::conserved::Conserved;
use crate::report::energy_round_off::EnergyRoundOff;
use crate::report::entries::{ChaosIndicators, EnergyJumps, PhasePerStep, VariableSteps};
use crate::report::shown::{LARGE, shown};
use equip_scalar::Float;
use equip_solver::{Counts, Outcome};
use std::fmt;

/// The measured record of a run: errors of energy and invariants, outcomes of the steps, counts of work.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Certificate<T> {
    /// The content of the first line: `yes, on every step`, `NO: ` with the reasons, or `not requested` with
    /// the largest error, as for the Gauss method.
    /// [`energy_conserved_on_every_step`](Certificate::energy_conserved_on_every_step) is the same as a
    /// boolean.
    pub energy_conserved_to_round_off: String,
    /// The method.
    pub method: Method,
    /// The fixed step, or the mean of variable steps. Negative for a run backward in time.
    pub step: T,
    /// Statistics of variable steps; `None` if the steps were fixed.
    pub variable_steps: Option<VariableSteps<T>>,
    /// The number of crossings of switches of H
    /// ([`Hamiltonian::switches`](equip_autodiff::Hamiltonian::switches)) at which a step, or a part of a
    /// step of the grid, ended. Switches whose effect is below the tolerance are ignored and not counted.
    pub discontinuities_crossed: u64,
    /// The crossings at which the value of H jumps; `None` if there are none.
    pub energy_jumps: Option<EnergyJumps<T>>,
    /// How often the state was changed, by events or by [`set_state`](crate::Stepper::set_state). Errors are
    /// relative to the values after each change.
    pub state_changes: u64,
    /// The time at the start.
    pub start: T,
    /// The time reached.
    pub end: T,
    /// H_ref, which is H at the start or after the last change of the state, and H − H_ref over the run. If
    /// H depends on time, the energy supplied from outside is subtracted. `None` if the energy was not
    /// measured.
    pub energy: Option<Conserved<T>>,
    /// The largest |H − H_ref| in units of its round-off level, over all steps that solve for the energy,
    /// corrected or not.
    pub energy_in_round_off_levels: Option<T>,
    /// The largest round-off level of H in the run, with the energies it is compared with. `None` if the
    /// method does not conserve H or the energy was not measured.
    pub energy_round_off: Option<EnergyRoundOff<T>>,
    /// The largest hω of the fastest motion. hω is estimated only in steps 1, 2, 4, 8, …, and only if the
    /// iteration converged slowly or used ∇²H. `None`: no such step.
    pub phase_per_step: Option<PhasePerStep<T>>,
    /// The errors of the invariants.
    pub invariants: Vec<Conserved<T>>,
    /// The smallest and largest α_1 … α_{s−1} of the run; empty if none was solved for. Parameters that were
    /// always zero have no line in the text.
    pub alpha_range: Vec<(T, T)>,
    /// Lyapunov exponent and MEGNO, if a tangent vector was propagated.
    pub chaos: Option<ChaosIndicators<T>>,
    /// Counts of work and of outcomes.
    pub counts: Counts,
    /// Extra steps for output times. Their work is not included in `counts`.
    pub output_steps: u64,
    /// The number of steps whose outputs, dense output and events use the polynomial of their own stages, of
    /// order s, because the stages of the refined polynomial of order 2s did not converge.
    pub coarse_outputs: u64,
    /// Wall-clock time in seconds; 0 on a platform without a clock (WebAssembly in a browser).
    pub seconds: f64,
}

impl<T: Float> Certificate<T> {
    /// Whether the steps resolve the fastest motion: hω ≤ s in all steps examined.
    pub fn motion_is_resolved(&self) -> bool {
        let stages = self.method.degree();
        (self.phase_per_step).is_none_or(|phase| phase.is_resolved(stages))
    }
}

impl<T: Float> fmt::Display for Certificate<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = &self.energy_conserved_to_round_off;
        writeln!(f, "energy conserved to round-off: {verdict}")?;
        let lines = self.lines();
        let width = lines
            .iter()
            .map(|(label, _)| label.chars().count())
            .max()
            .unwrap_or(0)
            + 2;
        for (i, (label, text)) in lines.iter().enumerate() {
            let end = if i + 1 < lines.len() { "\n" } else { "" };
            write!(f, "{label:<width$}{text}{end}")?;
        }
        Ok(())
    }
}

impl<T: Float> Certificate<T> {
    /// Label and text of every line that applies to the run.
    fn lines(&self) -> Vec<(String, String)> {
        let counts = &self.counts;
        let mut lines = Vec::new();
        let mut line = |label: &str, text: String| lines.push((label.to_owned(), text));
        line("method", format!("{} in {}", self.method, T::NAME));
        line(
            "time",
            format!("{} to {}", shown(self.start), shown(self.end)),
        );
        match &self.variable_steps {
            None => line("steps", format!("{} of {}", counts.steps, shown(self.step))),
            Some(steps) => {
                let range = format!("{:.2e} to {:.2e}", steps.smallest, steps.largest);
                line("steps", format!("{} of {range}", counts.steps));
                line("tolerance", format!("{:.1e}", steps.tolerance));
                let (rejected, failed) = (steps.rejected, steps.failed);
                line(
                    "steps rejected",
                    format!(
                        "{rejected} for their error, {failed} because the stages or α were not found"
                    ),
                );
            }
        }
        if self.state_changes > 0 {
            line(
                "changes of the state",
                format!(
                    "{}; errors are relative to the values after each",
                    self.state_changes
                ),
            );
        }
        if self.discontinuities_crossed > 0 {
            line(
                "discontinuities",
                format!("{} crossed", self.discontinuities_crossed),
            );
        }
        if let Some(EnergyJumps { count, largest }) = self.energy_jumps {
            line(
                "H jumps",
                format!("at {count} of them, by up to {largest:.2e}: a jump exerts no force"),
            );
            let remedy = "a continuous H";
            line("  remedy", remedy.to_owned());
        }
        if let Some(energy) = &self.energy {
            let start = energy.start;
            let is_plain =
                start == T::int(0) || (T::ratio(1, 1000)..T::int(LARGE)).contains(&start.abs());
            let label = match self.state_changes {
                0 => "energy at start",
                _ => "energy after change",
            };
            line(
                label,
                if is_plain {
                    format!("{start}")
                } else {
                    format!("{start:e}")
                },
            );
            line("energy error", range_of(energy));
        }
        if let Some(levels) = self.energy_in_round_off_levels {
            let text = if levels < T::int(100) {
                format!("max {levels:.2}")
            } else {
                format!("max {levels:.1e}")
            };
            line("  in round-off levels", text);
        }
        if let Some(EnergyRoundOff {
            round_off, scale, ..
        }) = self.energy_round_off.filter(|f| !f.is_small())
        {
            line(
                "  round-off level",
                format!(
                    "up to {round_off:.2e}; |H| and the kinetic energy are at most {scale:.2e}"
                ),
            );
            let remedy = "H without cancellation, smaller angles, an earlier end, double-double";
            line("  remedy", remedy.to_owned());
        }
        if let Some(phase) = self.phase_per_step
            && !self.motion_is_resolved()
        {
            let stages = self.method.degree();
            let (angle, step, most) = (phase.angle, phase.step, stages as f64);
            line(
                "  not resolved",
                format!("h ω = {angle:.3} in a step of {step:.2e}, above {most}: wrong phase"),
            );
            let step = phase.resolving_step(stages);
            line(
                "  remedy",
                format!("steps of {step:.1e}, more stages, or an averaged H"),
            );
        }
        for conserved in &self.invariants {
            line(&format!("{} error", conserved.name), range_of(conserved));
        }
        if let Some(ChaosIndicators { lyapunov, megno }) = self.chaos {
            line(
                "Lyapunov exponent",
                format!("{lyapunov:.3e} per unit of time"),
            );
            line("MEGNO", format!("{megno:.3}"));
        }
        for outcome in Outcome::ALL {
            let count = counts.outcome(outcome);
            if count > 0 {
                line("steps by outcome", format!("{count} {}", outcome.label()));
            }
        }
        let unmoved = (T::int(0), T::int(0));
        for (k, range) in self.alpha_range.iter().enumerate() {
            if *range == unmoved {
                continue;
            }
            let (low, high) = range;
            line(
                &format!("α_{} range", k + 1),
                format!("{low:.2e} to {high:.2e}"),
            );
        }
        if counts.fixed_point_iterations > 0 {
            line(
                "fixed-point iterations",
                counts.fixed_point_iterations.to_string(),
            );
        }
        if counts.newton_iterations > 0 {
            let (full, frozen) = (counts.factorisations, counts.simplified_factorisations);
            line(
                "preconditioned",
                format!(
                    "{} iterations; factorisations: {full} of full, {frozen} of simplified Newton",
                    counts.newton_iterations
                ),
            );
        }
        if counts.preconditioner_changes > 0 {
            line(
                "preconditioner changed",
                format!("{} times", counts.preconditioner_changes),
            );
        }
        if counts.directions > 0 {
            line(
                "search directions",
                format!(
                    "{}, {} updates of α",
                    counts.directions, counts.alpha_updates
                ),
            );
        }
        line(
            "evaluations",
            format!(
                "{} ∇H, {} ∇²H, {} H",
                counts.gradients, counts.hessians, counts.energies
            ),
        );
        if counts.local_errors > 0 {
            line("local error estimates", counts.local_errors.to_string());
        }
        if counts.halvings > 0 {
            line("halvings", counts.halvings.to_string());
        }
        if self.output_steps > 0 {
            line("steps for output", self.output_steps.to_string());
        }
        if self.coarse_outputs > 0 {
            let count = self.coarse_outputs;
            line("outputs of order s", format!("of {count} steps"));
        }
        line("wall-clock time", format!("{:.3} s", self.seconds));
        lines
    }
}

/// The largest and the last error of a quantity.
fn range_of<T: Float>(conserved: &Conserved<T>) -> String {
    if conserved.max.is_finite() {
        format!("max {:.2e}, end {:.2e}", conserved.max, conserved.end)
    } else {
        "infinite or NaN after a step".to_owned()
    }
}
