//! The curve of a run between its steps, for the picture: dense output of the same steps, made once more.

use crate::draw::samples::Path;
use crate::run::integrator::Integrator;
use equip_integrate::{NoObserver, Run};
use equip_scalar::Float;
use equip_scenes::Instance;

/// Up to this many steps a line from step to step would show its corners.
pub(crate) const FEW: u64 = 1500;
/// Points of the curve in a step.
const PER_STEP: i64 = 12;

/// The paths of these components of y = (q, p) up to the end of `run`, if it has few steps.
pub(crate) fn curve<T: Float>(
    integrator: Integrator<T>,
    instance: &Instance,
    run: &Run<T>,
    components: Vec<usize>,
) -> Option<Path> {
    if components.is_empty() || run.certificate().counts.steps > FEW {
        return None;
    }
    let end = run.certificate().end;
    let again = integrator
        .dense()
        .integrate(instance, None, end, &mut NoObserver);
    // A run that ends with an error has a curve up to there.
    let run = match again {
        Ok(run) => run,
        Err(failure) => *failure.partial?,
    };
    let trajectory = run.trajectory()?;
    let mut path = Path::new(components);
    let mut index = 0;
    for pair in run.times().windows(2) {
        for k in 0..PER_STEP {
            let time = pair[0] + (pair[1] - pair[0]) * T::ratio(k, PER_STEP);
            let (q, p) = trajectory.at(time)?;
            path.see(index, |i| at(&q, &p, i));
            index += 1;
        }
    }
    let (_, q, p) = run.last();
    path.see(index.next_multiple_of(path.stride()), |i| at(q, p, i));
    Some(path)
}

/// Component i of y = (q, p) as a double.
fn at<T: Float>(q: &[T], p: &[T], i: usize) -> f64 {
    let y = if i < q.len() { q[i] } else { p[i - q.len()] };
    y.to_f64()
}
