//! The certificate as JSON: the words of the printed one, numbers with all their digits.

use crate::run::finished::Finished;
use crate::run::signals;
use crate::write::csv::digits;
use crate::write::json::object;
use equip_integrate::{Conserved, Outcome};
use equip_scalar::Float;
use serde::Serialize;
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// A number in the precision of the run, with the digits to read it back; `null` if it is not finite.
#[derive(Debug, Serialize)]
#[serde(transparent)]
struct Number(Option<Box<RawValue>>);

impl Number {
    fn new<T: Float>(x: T) -> Self {
        let text = x.is_finite().then(|| digits(x));
        Number(text.and_then(|text| RawValue::from_string(text).ok()))
    }

    fn all<T: Float>(values: &[T]) -> Vec<Self> {
        values.iter().map(|&x| Number::new(x)).collect()
    }
}

/// The finished run as one JSON object over several lines.
pub(crate) fn document<T: Float>(finished: &Finished<'_, T>) -> serde_json::Result<String> {
    let certificate = finished.run.certificate();
    let counts = &certificate.counts;
    let (_, q, p) = finished.run.last();
    let parameters: BTreeMap<_, _> = finished.instance.parameters().collect();
    let outcomes: BTreeMap<_, _> = (Outcome::ALL.iter())
        .map(|o| (o.label(), counts.outcome(*o)))
        .collect();
    let alpha_range: Vec<_> = (certificate.alpha_range.iter())
        .map(|&(low, high)| [low, high].map(Number::new))
        .collect();
    serde_json::to_string_pretty(&object! {
        energy_conserved_to_round_off: &certificate.energy_conserved_to_round_off,
        scene: finished.instance.scene().name,
        parameters: parameters,
        precision: T::NAME,
        method: certificate.method.to_string(),
        stages: certificate.method.stage_count(),
        order: certificate.method.order(),
        step: Number::new(certificate.step),
        variable_steps: certificate.variable_steps.map(|steps| object! {
            tolerance: Number::new(steps.tolerance),
            smallest: Number::new(steps.smallest),
            largest: Number::new(steps.largest),
            rejected: steps.rejected,
            failed: steps.failed,
        }),
        start: Number::new(certificate.start),
        end: Number::new(certificate.end),
        steps: counts.steps,
        energy: certificate.energy.as_ref().map(quantity),
        energy_in_round_off_levels: certificate.energy_in_round_off_levels.map(Number::new),
        energy_round_off: certificate.energy_round_off.map(|level| object! {
            round_off: Number::new(level.round_off),
            time: Number::new(level.time),
            scale: Number::new(level.scale),
            last: Number::new(level.last),
            recent_kinetic: Number::new(level.recent_kinetic),
            underflows: level.underflows,
            is_small: level.is_small(),
        }),
        phase_per_step: certificate.phase_per_step.map(|phase| object! {
            angle: phase.angle,
            step: Number::new(phase.step),
        }),
        motion_is_resolved: certificate.motion_is_resolved(),
        energy_conserved_on_every_step: certificate.energy_conserved_on_every_step(),
        invariants: certificate.invariants.iter().map(quantity).collect::<Vec<_>>(),
        outcomes: outcomes,
        // Steps whose energy error was left, for whatever reason.
        uncorrected: counts.uncorrected(),
        state_changes: certificate.state_changes,
        discontinuities_crossed: certificate.discontinuities_crossed,
        energy_jumps: certificate.energy_jumps.map(|jumps| object! {
            count: jumps.count,
            largest: Number::new(jumps.largest),
        }),
        alpha_range: alpha_range,
        chaos: certificate.chaos.map(|chaos| object! {
            lyapunov: Number::new(chaos.lyapunov),
            megno: Number::new(chaos.megno),
        }),
        work: object! {
            fixed_point_iterations: counts.fixed_point_iterations,
            preconditioner_changes: counts.preconditioner_changes,
            newton_iterations: counts.newton_iterations,
            factorisations: counts.factorisations,
            simplified_factorisations: counts.simplified_factorisations,
            gradients: counts.gradients,
            hessians: counts.hessians,
            energies: counts.energies,
            directions: counts.directions,
            alpha_updates: counts.alpha_updates,
            local_errors: counts.local_errors,
            halvings: counts.halvings,
            output_steps: certificate.output_steps,
            coarse_outputs: certificate.coarse_outputs,
        },
        end_state: object! {
            q: Number::all(q),
            p: Number::all(p),
        },
        end_state_error: finished.end_error.as_ref().map(|error| object! {
            against: &error.against,
            q: Number::new(error.q),
            p: Number::new(error.p),
        }),
        seconds: certificate.seconds,
        error: (finished.error.as_ref().map(ToString::to_string))
            .or_else(|| {
                let signal = signals::caught().filter(|_| finished.run.stopped())?;
                Some(format!("ended by signal {signal}"))
            }),
    })
}

fn quantity<T: Float>(conserved: &Conserved<T>) -> impl Serialize + '_ {
    object! {
        name: &conserved.name,
        start: Number::new(conserved.start),
        max: Number::new(conserved.max),
        end: Number::new(conserved.end),
    }
}
