//! [`Row`]: a case as it was measured.

use super::case::{BuildFault, Case, Numbers, Reference, State, Trajectory};
use super::leg::{Leg, outcomes, run};
use super::measured::Measured;
use super::reference::{Cache, Truth, distance, truth};
use super::verdict::{Verdict, judge};
use equip_integrate::{Equip, Gauss};
use equip_scalar::{DoubleDouble, Float};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// A case, its figures and the verdict.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) theme: &'static str,
    pub(crate) name: String,
    pub(crate) setting: String,
    pub(crate) stages: usize,
    pub(crate) h: f64,
    pub(crate) omega: Option<f64>,
    pub(crate) numbers: &'static str,
    pub(crate) wanted: u64,
    pub(crate) measured: Measured,
    pub(crate) verdict: Verdict,
    /// With building, Gauss and reference.
    pub(crate) all_seconds: f64,
}

/// Runs a case; whatever happens in it ends in its row.
pub(crate) fn row(case: &Case, cache: &Cache) -> Row {
    let begun = Instant::now();
    let measure = || match case.numbers {
        Numbers::F64 => measure::<f64>(case, cache),
        Numbers::Dd => measure::<DoubleDouble>(case, cache),
    };
    let (measured, verdict) = match catch_unwind(AssertUnwindSafe(measure)) {
        Ok(Ok(measured)) => {
            let verdict = judge(&case.expect, case.steps, &measured);
            (measured, verdict)
        }
        Ok(Err(fault)) => (
            Measured::default(),
            Verdict::failed(format!("the problem could not be built: {fault}")),
        ),
        Err(_) => (
            Measured::default(),
            Verdict::failed("the integrator panicked".to_owned()),
        ),
    };
    Row {
        theme: case.theme,
        name: case.name.clone(),
        setting: case.setting(),
        stages: case.stages,
        h: case.h,
        omega: case.omega,
        numbers: match case.numbers {
            Numbers::F64 => f64::NAME,
            Numbers::Dd => DoubleDouble::NAME,
        },
        wanted: case.steps,
        measured,
        verdict,
        all_seconds: begun.elapsed().as_secs_f64(),
    }
}

fn measure<T: Float>(case: &Case, cache: &Cache) -> Result<Measured, BuildFault> {
    let problem = (case.problem)()?;
    let start = problem.initial::<T>();
    let h = T::exact(case.h);
    let equip = run(Equip::stages(case.stages), &problem, &start, h, case.steps);
    let method = Gauss::stages(case.stages);
    let gauss = run(method, &problem, &start, h, case.steps);
    let truth = truth(case, &problem, &start, cache)?;
    let scaled = matches!(case.reference, Reference::Scaled { .. });
    // Errors are compared over the time both were there.
    let both = equip.samples.len().min(gauss.samples.len());
    let compare = |leg: &Leg<T>| {
        let mut samples = leg.samples.clone();
        if scaled {
            samples = samples.in_own_units();
        } else {
            samples = samples.first(both);
        }
        Some(distance(case.judged, &samples, truth.as_ref()?))
    };
    let judged_by_ratio = matches!(
        case.expect.trajectory,
        Trajectory::Resolved | Trajectory::Slow
    );
    let noise = (truth.is_some() && judged_by_ratio).then(|| {
        let nudged = run(method, &problem, &nudge(&start), h, case.steps);
        let from = 0;
        let samples = gauss.samples.clone();
        distance(case.judged, &nudged.samples, &Truth { from, samples })
    });
    Ok(Measured {
        steps: equip.counts.steps,
        parts: equip.counts.steps + equip.counts.halvings,
        uncorrected: equip.counts.uncorrected(),
        outcomes: outcomes(&equip.counts)
            .map(|(o, n)| (o.label(), n))
            .collect(),
        energy: equip.energy,
        levels: equip.levels,
        independent_levels: equip.independent_levels,
        error: compare(&equip),
        noise,
        gauss_error: compare(&gauss).filter(|_| !scaled),
        gauss_energy: gauss.energy,
        gauss_ended: gauss.ended,
        invariants: equip.invariants,
        ended: equip.ended,
        impatient: equip.impatient,
        seconds: equip.seconds,
        gauss_seconds: gauss.seconds,
    })
}

/// The state with every component moved by one unit of relative rounding, away from and towards zero in turn.
fn nudge<T: Float>((q, p): &State<T>) -> State<T> {
    let move_one = |(i, &x): (usize, &T)| {
        let sign = if i % 2 == 0 { 1 } else { -1 };
        x * (T::int(1) + T::int(sign) * T::EPSILON)
    };
    (
        q.iter().enumerate().map(move_one).collect(),
        p.iter().enumerate().map(move_one).collect(),
    )
}
