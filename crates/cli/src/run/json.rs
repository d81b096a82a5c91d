//! The certificate as JSON: the words of the printed one, numbers with all their digits.

use crate::run::finished::{EndError, Finished};
use crate::write::csv::digits;
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

#[derive(Debug, Serialize)]
struct Quantity {
    name: String,
    start: Number,
    max: Number,
    end: Number,
}

#[derive(Debug, Serialize)]
struct Work {
    fixed_point_iterations: u64,
    taken_over: u64,
    newton_iterations: u64,
    factorisations: u64,
    simplified_factorisations: u64,
    gradients: u64,
    hessians: u64,
    energies: u64,
    directions: u64,
    alpha_updates: u64,
    local_errors: u64,
    halvings: u64,
    output_steps: u64,
    coarse_outputs: u64,
}

#[derive(Debug, Serialize)]
struct Sizes {
    tolerance: Number,
    smallest: Number,
    largest: Number,
    rejected: u64,
    failed: u64,
}

#[derive(Debug, Serialize)]
struct RoundOff {
    round_off: Number,
    time: Number,
    scale: Number,
    last: Number,
    recent_kinetic: Number,
    underflows: bool,
    is_small: bool,
}

#[derive(Debug, Serialize)]
struct Jumps {
    count: u64,
    largest: Number,
}

#[derive(Debug, Serialize)]
struct Phase {
    angle: f64,
    step: Number,
}

#[derive(Debug, Serialize)]
struct Chaos {
    lyapunov: Number,
    megno: Number,
}

#[derive(Debug, Serialize)]
struct AtEnd {
    q: Vec<Number>,
    p: Vec<Number>,
}

#[derive(Debug, Serialize)]
struct Against {
    against: String,
    q: Number,
    p: Number,
}

#[derive(Debug, Serialize)]
struct Document<'a> {
    energy_conserved_to_round_off: &'a str,
    scene: &'a str,
    parameters: BTreeMap<&'a str, &'a str>,
    precision: &'static str,
    method: String,
    stages: usize,
    order: usize,
    step: Number,
    variable_steps: Option<Sizes>,
    start: Number,
    end: Number,
    steps: u64,
    energy: Option<Quantity>,
    energy_in_round_off_levels: Option<Number>,
    energy_round_off: Option<RoundOff>,
    phase_per_step: Option<Phase>,
    motion_is_resolved: bool,
    energy_conserved_on_every_step: bool,
    invariants: Vec<Quantity>,
    outcomes: BTreeMap<&'static str, u64>,
    /// Steps whose energy error was left, for whatever reason.
    uncorrected: u64,
    switches_crossed: u64,
    energy_jumps: Option<Jumps>,
    alpha_range: Vec<[Number; 2]>,
    chaos: Option<Chaos>,
    work: Work,
    end_state: AtEnd,
    end_state_error: Option<Against>,
    seconds: f64,
    error: Option<String>,
}

/// The finished run as one JSON object over several lines.
pub(crate) fn document<T: Float>(finished: &Finished<'_, T>) -> serde_json::Result<String> {
    let certificate = finished.run.certificate();
    let counts = &certificate.counts;
    let (_, q, p) = finished.run.last();
    let document = Document {
        energy_conserved_to_round_off: &certificate.energy_conserved_to_round_off,
        scene: finished.instance.scene().name,
        parameters: finished.instance.parameters().collect(),
        precision: T::NAME,
        method: certificate.method.to_string(),
        stages: certificate.method.stage_count(),
        order: certificate.method.order(),
        step: Number::new(certificate.step),
        variable_steps: certificate.variable_steps.map(|steps| Sizes {
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
        energy_round_off: certificate.energy_round_off.map(|round_off| RoundOff {
            round_off: Number::new(round_off.round_off),
            time: Number::new(round_off.time),
            scale: Number::new(round_off.scale),
            last: Number::new(round_off.last),
            recent_kinetic: Number::new(round_off.recent_kinetic),
            underflows: round_off.underflows,
            is_small: round_off.is_small(),
        }),
        phase_per_step: certificate.phase_per_step.map(|phase| Phase {
            angle: phase.angle,
            step: Number::new(phase.step),
        }),
        motion_is_resolved: certificate.motion_is_resolved(),
        energy_conserved_on_every_step: certificate.energy_conserved_on_every_step(),
        invariants: certificate.invariants.iter().map(quantity).collect(),
        outcomes: Outcome::ALL
            .iter()
            .map(|o| (o.label(), counts.outcome(*o)))
            .collect(),
        uncorrected: counts.uncorrected(),
        switches_crossed: certificate.switches_crossed,
        energy_jumps: certificate.energy_jumps.map(|jumps| Jumps {
            count: jumps.count,
            largest: Number::new(jumps.largest),
        }),
        alpha_range: certificate
            .alpha_range
            .iter()
            .map(|&(low, high)| [Number::new(low), Number::new(high)])
            .collect(),
        chaos: certificate.chaos.map(|chaos| Chaos {
            lyapunov: Number::new(chaos.lyapunov),
            megno: Number::new(chaos.megno),
        }),
        work: Work {
            fixed_point_iterations: counts.fixed_point_iterations,
            taken_over: counts.taken_over,
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
        end_state: AtEnd {
            q: Number::all(q),
            p: Number::all(p),
        },
        end_state_error: finished
            .end_error
            .as_ref()
            .map(|EndError { against, q, p }| Against {
                against: against.clone(),
                q: Number::new(*q),
                p: Number::new(*p),
            }),
        seconds: certificate.seconds,
        error: finished.error.as_ref().map(ToString::to_string),
    };
    serde_json::to_string_pretty(&document)
}

fn quantity<T: Float>(conserved: &Conserved<T>) -> Quantity {
    Quantity {
        name: conserved.name.clone(),
        start: Number::new(conserved.start),
        max: Number::new(conserved.max),
        end: Number::new(conserved.end),
    }
}
