//! Which components are on springs, by ∇²U in a state.

use super::Springs;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;
use equip_tableau::Gauss;

/// A spring is so many times as large as the rest of its row of ∇²U, in units of equal masses. Of a spring pendulum with k = 1e6 that turns away from its
/// axis, where rounding is foreseen along the axis only, the energy comes out 2e-15 off; with 8 it was 3e-14.
pub(super) const OUTWEIGHS: i64 = 64;
/// Springs with h² w κ below 1 over this are none.
pub(super) const SOFT: i64 = 4;
/// α's are found by sweeps where hω is no more than this times the stages: some 16 stages a period of the spring. By slopes with
/// 12 stages and hω = 8 they keep the energy and ruin the trajectory (FPU, T = 200: 1e-1, where halved steps give 1e-7), by responses a
/// spring pendulum with hω = 20 is three times as far off as Gauss.
const RESOLVED: [i64; 2] = [2, 5];
/// A spring that is not is named if hω is above this: less than a third of a period in a step is stiff to nobody.
const FAST: i64 = 2;

/// Largest hω with which α's are found by sweeps.
pub fn most_resolved<T: Float>(stages: usize) -> T {
    T::ratio(stages as i64 * RESOLVED[0], RESOLVED[1])
}

impl<T: Float> Springs<T> {
    /// Those of steps of size `h` from `y`; if α's are wanted those that are resolved well enough to find them, and the largest hω of the others. `entries` is room for
    /// ∇²H.
    pub(crate) fn find<E: Evaluate<T>>(
        gauss: &Gauss<T>,
        energy: &mut E,
        (pattern, w, wants_alphas): (&Pattern, &[T], bool),
        (y, h): (&[T], T),
        (entries, mut earlier): (&mut Vec<T>, Option<Self>),
    ) -> (Option<Self>, Option<T>) {
        let most = most_resolved(gauss.stages());
        entries.resize(pattern.len(), T::int(0));
        energy.hessian(y, entries);
        let (mut found, mut fastest) = (Self::room(&mut earlier), T::int(0));
        for c in 0..w.len() {
            let Some(kappa) = standing_out(pattern, w, entries, c) else {
                continue;
            };
            let angle = h * (w[c] * kappa).sqrt();
            if wants_alphas && angle > most {
                fastest = fastest.max(angle);
            } else if T::int(SOFT) * angle * angle >= T::int(1) {
                found.push((c, kappa));
            }
        }
        let unresolved = (fastest > T::int(FAST)).then_some(fastest);
        (Self::new((pattern, w, h), found, earlier), unresolved)
    }
}

/// κ_c, if it is positive and outweighs the rest of its row.
pub(super) fn standing_out<T: Float>(
    pattern: &Pattern,
    w: &[T],
    entries: &[T],
    c: usize,
) -> Option<T> {
    let (mut kappa, mut rest) = (T::int(0), T::int(0));
    for (place, j) in pattern.row(c) {
        if j == c {
            kappa = entries[place];
        } else if j < w.len() {
            rest += entries[place].abs() * (w[j] / w[c]).sqrt();
        }
    }
    (kappa > T::int(0) && kappa >= T::int(OUTWEIGHS) * rest).then_some(kappa)
}
