//! The curve of a run between its steps, for the picture: dense output of the same steps, made once more.

use crate::draw::samples::Path;
use crate::run::integrator::integrate;
use equip_integrate::{Integrator, NoObserver, Record, Run};
use equip_scalar::Float;
use equip_scenes::Instance;

/// Runs of more steps are drawn by their steps alone.
const MOST_STEPS: u64 = 12_000;
/// Numbers of all stages of the run at most, which dense output keeps: 64 MB.
const MOST_NUMBERS: u64 = 4_000_000;
/// Points of the curve in a step, and coordinates of all points at most: fewer are kept where there are many
/// steps or bodies.
const PER_STEP: i64 = 12;
const MOST_COORDINATES: usize = 90_000;

/// The paths of these components of y = (q, p) up to the end of `run`, if it has few steps.
pub(crate) fn curve<T: Float>(
    integrator: Integrator<T>,
    instance: &Instance,
    run: &Run<T>,
    components: Vec<usize>,
) -> Option<Path> {
    let certificate = run.certificate();
    let steps = certificate.counts.steps;
    let (stages, unknowns) = (certificate.method.stage_count(), 2 * run.last().1.len());
    let numbers = steps.saturating_mul((stages * unknowns) as u64);
    if components.is_empty() || steps > MOST_STEPS || numbers > MOST_NUMBERS {
        return None;
    }
    let end = certificate.end;
    let dense = integrator.dense().record(Record::All);
    let again = integrate(&dense, instance, None, end, &mut NoObserver);
    // A run that ends with an error has a curve up to there.
    let run = match again {
        Ok(run) => run,
        Err(failure) => *failure.partial?,
    };
    let trajectory = run.trajectory()?;
    let mut path = Path::with_room(components, MOST_COORDINATES);
    let mut index = 0;
    for pair in run.times().windows(2) {
        for k in 0..PER_STEP {
            let time = pair[0] + (pair[1] - pair[0]) * T::ratio(k, PER_STEP);
            let (q, p) = trajectory.at(time)?;
            path.see_state(index, &q, &p);
            index += 1;
        }
    }
    let (_, q, p) = run.last();
    path.see_state(index.next_multiple_of(path.stride()), q, p);
    Some(path)
}
