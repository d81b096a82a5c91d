//! The size of the first step, before any step has been estimated.
//!
//! The first size lies between 1/64 of the turning time and the turning time, the time in which the motion
//! changes direction; the shorter one of positions and momenta counts. With f = y', f' = A f and f'' = A² f
//! at the start, A = ∂f/∂y, the turning time is the root t of
//!
//! $$ \lVert f'' \rVert t^2 = \lVert f \rVert + \lVert f' \rVert t . $$
//!
//! At a turning point, where f vanishes, and at a passage through the centre, where f' vanishes, t is the
//! same. If A² f vanishes, as in a free fall, t = ‖f‖/‖f'‖. Coordinates have an arbitrary origin, so they
//! choose within these bounds only: 1/10 of the time in which the state would change by its own size, |y|/|f|
//! and √(|y|/|f'|). The first step is then tried with other sizes, up to four turning times, until its error
//! fits. The bound is needed because the error of a free fall is zero for any size, and after a step far
//! beyond an event its root has the rounding error of the whole step.

use crate::control::policy::{MOST_CHANGE, SHORT};
use equip_autodiff::Evaluator;
use equip_scalar::Float;

/// Workspace for the first size.
#[derive(Debug)]
pub(crate) struct FirstSize<T> {
    f: Vec<T>,
    second: Vec<T>,
    third: Vec<T>,
}

impl<T: Float> FirstSize<T> {
    pub(crate) fn new(n: usize) -> Self {
        let zeros = || vec![T::int(0); n];
        FirstSize {
            f: zeros(),
            second: zeros(),
            third: zeros(),
        }
    }

    /// The size of the first attempt from `y`, 1 if nothing moves, and the largest size of the first step.
    pub(crate) fn sizes(&mut self, energy: &mut Evaluator<T>, y: &[T]) -> [f64; 2] {
        let n = y.len();
        let FirstSize { f, second, third } = self;
        energy.vector_field(y, f);
        energy.jacobian_vector(y, f, second);
        energy.jacobian_vector(y, second, third);
        let half = n / 2;
        let groups = [0..half, half..n].map(|group| {
            [&*f, &*second, &*third].map(|x| {
                let sizes = x[group.clone()].iter().map(|x| x.abs().to_f64());
                sizes.fold(0.0, f64::max)
            })
        });
        let shortest =
            |of: fn([f64; 3]) -> f64| groups.map(of).into_iter().fold(f64::INFINITY, f64::min);
        let turns = shortest(turning_time);
        let pace = || shortest(|[f, second, _]| if f > 0.0 { f / second } else { f64::INFINITY });
        let time = if turns < f64::INFINITY { turns } else { pace() };
        let mut own = f64::INFINITY;
        for (group, [f, second, _]) in [0..half, half..n].into_iter().zip(groups) {
            let size = y[group]
                .iter()
                .map(|x| x.abs().to_f64())
                .fold(0.0, f64::max);
            if size > 0.0 {
                own = own.min(size / f).min((size / second).sqrt());
            } else if f > 0.0 {
                own = own.min(f / second);
            }
        }
        let own = own / 10.0;
        if time > 0.0 && time < f64::INFINITY {
            return [own.clamp(time / SHORT as f64, time), MOST_CHANGE * time];
        }
        let size = if own > 0.0 && own < f64::INFINITY {
            own
        } else {
            1.0
        };
        [size, MOST_CHANGE * size]
    }
}

/// The root t of c t² = a + b t; infinite if nothing moves or c = 0.
fn turning_time([a, b, c]: [f64; 3]) -> f64 {
    // Scaled by the largest coefficient, since squares may overflow or underflow.
    let unit = a.max(b).max(c);
    if !(unit > 0.0 && unit.is_finite()) {
        return f64::INFINITY;
    }
    let (a, b, c) = (a / unit, b / unit, c / unit);
    let time = (b + (b * b + 4.0 * a * c).sqrt()) / (2.0 * c);
    if time > 0.0 { time } else { f64::INFINITY }
}
