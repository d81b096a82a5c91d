//! [`Row`]: a case as it was measured.

use super::case::{BuildFault, Case, Numbers, Reference, State, Trajectory};
use super::leg::{Samples, run};
use super::measured::Measured;
use super::reference::{Cache, Truth, distance, truth};
use super::verdict::{Verdict, judge};
use equip_integrate::{Equip, Gauss};
use equip_scalar::{DoubleDouble, Float};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// A case, its figures and the verdict.
pub(crate) struct Row<'a> {
    pub(crate) case: &'a Case,
    pub(crate) measured: Measured,
    pub(crate) verdict: Verdict,
    /// With building, Gauss and reference.
    pub(crate) all_seconds: f64,
}

/// Runs a case; whatever happens in it ends in its row.
pub(crate) fn row<'a>(case: &'a Case, cache: &Cache) -> Row<'a> {
    let begun = Instant::now();
    let measure = || match case.numbers {
        Numbers::F64 => measure::<f64>(case, cache),
        Numbers::Dd => measure::<DoubleDouble>(case, cache),
    };
    let failed = |reason| (Measured::default(), Verdict::failed(reason));
    let (measured, verdict) = match catch_unwind(AssertUnwindSafe(measure)) {
        Ok(Ok(measured)) => {
            let verdict = judge(&case.expect, case.steps, &measured);
            (measured, verdict)
        }
        Ok(Err(fault)) => failed(format!("the problem could not be built: {fault}")),
        Err(_) => failed("the integrator panicked".to_owned()),
    };
    Row {
        case,
        measured,
        verdict,
        all_seconds: begun.elapsed().as_secs_f64(),
    }
}

fn measure<T: Float>(case: &Case, cache: &Cache) -> Result<Measured, BuildFault> {
    let problem = (case.problem)()?;
    let start = problem.initial::<T>();
    let run = |method, start: &State<T>| run(method, &problem, start, T::exact(case.h), case.steps);
    let (equip, equip_samples) = run(Equip::stages(case.stages), &start);
    let method = Gauss::stages(case.stages);
    let (gauss, gauss_samples) = run(method, &start);
    let truth = truth(case, &problem, &start, cache)?;
    let scaled = matches!(case.reference, Reference::Scaled { .. });
    // Errors are compared over the time both were there.
    let both = equip_samples.len().min(gauss_samples.len());
    let compare = |samples: &Samples<T>| {
        let samples = samples.clone();
        let compared = match scaled {
            true => samples.in_own_units(),
            false => samples.first(both),
        };
        Some(distance(case.judged, &compared, truth.as_ref()?))
    };
    let (error, gauss_error) = (compare(&equip_samples), compare(&gauss_samples));
    let judged_by_ratio = matches!(
        case.expect.trajectory,
        Trajectory::Resolved | Trajectory::Slow
    );
    let noise = (truth.is_some() && judged_by_ratio).then(|| {
        let (_, nudged) = run(method, &nudge(&start));
        let (from, samples) = (0, gauss_samples);
        distance(case.judged, &nudged, &Truth { from, samples })
    });
    Ok(Measured {
        equip,
        gauss,
        error,
        gauss_error: gauss_error.filter(|_| !scaled),
        noise,
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
