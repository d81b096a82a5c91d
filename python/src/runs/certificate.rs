//! The certificate of a run as a dict.

use equip::integrate::Conserved;
use equip::prelude::{Certificate, Outcome};
use equip::scalar::Float;
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) fn certificate<'py, T: Float>(
    py: Python<'py>,
    certificate: &Certificate<T>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let set = |name: &str, x: T| dict.set_item(name, x.to_f64());
    dict.set_item("text", certificate.to_string())?;
    let verdict = &certificate.energy_conserved_to_round_off;
    dict.set_item("energy_conserved_to_round_off", verdict)?;
    dict.set_item("precision", T::NAME)?;
    dict.set_item("method", certificate.method.to_string())?;
    set("step", certificate.step)?;
    set("start", certificate.start)?;
    set("end", certificate.end)?;
    dict.set_item("energy", certificate.energy.as_ref().map(conserved))?;
    dict.set_item(
        "energy_in_round_off_levels",
        certificate.energy_in_round_off_levels.map(T::to_f64),
    )?;
    let round_off = certificate.energy_round_off;
    let round_off = round_off.map(|of| [of.round_off, of.time, of.scale].map(T::to_f64));
    dict.set_item("energy_round_off", round_off)?;
    let jumps = certificate.energy_jumps;
    let jumps = jumps.map(|of| (of.count, of.largest.to_f64()));
    dict.set_item("energy_jumps", jumps)?;
    let phase = certificate.phase_per_step;
    let phase = phase.map(|of| (of.angle, of.step.to_f64()));
    dict.set_item("phase_per_step", phase)?;
    dict.set_item("motion_is_resolved", certificate.motion_is_resolved())?;
    let invariants: Vec<_> = certificate.invariants.iter().map(conserved).collect();
    dict.set_item("invariants", invariants)?;
    let ranges = certificate.alpha_range.iter();
    let ranges: Vec<_> = ranges
        .map(|(low, high)| (low.to_f64(), high.to_f64()))
        .collect();
    dict.set_item("alpha_range", ranges)?;
    let steps = certificate.variable_steps.map(|steps| {
        let sizes = (steps.tolerance, steps.smallest, steps.largest);
        let sizes = (sizes.0.to_f64(), sizes.1.to_f64(), sizes.2.to_f64());
        (sizes.0, sizes.1, sizes.2, steps.rejected, steps.failed)
    });
    dict.set_item("variable_steps", steps)?;
    let chaos = certificate.chaos;
    dict.set_item("lyapunov", chaos.map(|chaos| chaos.lyapunov.to_f64()))?;
    dict.set_item("megno", chaos.map(|chaos| chaos.megno.to_f64()))?;
    let counts = &certificate.counts;
    let all = [
        ("steps", counts.steps),
        ("uncorrected", counts.uncorrected()),
        ("fixed_point_iterations", counts.fixed_point_iterations),
        ("newton_iterations", counts.newton_iterations),
        ("preconditioner_changes", counts.preconditioner_changes),
        ("factorisations", counts.factorisations),
        (
            "simplified_factorisations",
            counts.simplified_factorisations,
        ),
        ("gradients", counts.gradients),
        ("hessians", counts.hessians),
        ("energies", counts.energies),
        ("directions", counts.directions),
        ("alpha_updates", counts.alpha_updates),
        ("local_errors", counts.local_errors),
        ("halvings", counts.halvings),
        ("output_steps", certificate.output_steps),
        ("coarse_outputs", certificate.coarse_outputs),
        ("state_changes", certificate.state_changes),
        (
            "discontinuities_crossed",
            certificate.discontinuities_crossed,
        ),
    ];
    for (name, count) in all {
        dict.set_item(name, count)?;
    }
    let outcomes = Outcome::ALL.map(|outcome| (outcome.label(), counts.outcome(outcome)));
    dict.set_item("outcomes", outcomes.to_vec())?;
    let kept = certificate.energy_conserved_on_every_step();
    dict.set_item("energy_conserved_on_every_step", kept)?;
    dict.set_item("seconds", certificate.seconds)?;
    Ok(dict)
}

/// Name, start, largest and last difference.
fn conserved<T: Float>(conserved: &Conserved<T>) -> (String, f64, f64, f64) {
    let (start, max, end) = (conserved.start, conserved.max, conserved.end);
    (
        conserved.name.clone(),
        start.to_f64(),
        max.to_f64(),
        end.to_f64(),
    )
}
