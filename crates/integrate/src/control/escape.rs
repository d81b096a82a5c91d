//! Distinguishes a motion that escapes to infinity in finite time from a step that is too large.
//!
//! In a potential that decreases faster than −|q|² a particle reaches infinity at a finite time t*: q ~ (t* −
//! t)^{−β}. No step that extends beyond t* converges. Near t* the position moves outward, the force points
//! outward, and |q| grows by a factor within the step that fails. In a fall into a centre the force points
//! inward. In a collision |q| does not change by a factor.
//!
//! Cost: one gradient, after a step has finally failed.

use crate::control::policy::ESCAPING;
use equip_autodiff::Evaluator;
use equip_scalar::Float;

/// |q| at `y` if the motion reaches infinity within about one step of size `h`.
pub(crate) fn escapes<T: Float>(energy: &mut Evaluator<T>, y: &[T], h: T) -> Option<T> {
    let m = y.len() / 2;
    let mut f = vec![T::int(0); y.len()];
    energy.vector_field(y, &mut f);
    // Scaled by the largest position, since the squares may overflow.
    let largest = y[..m].iter().fold(T::int(0), |a, q| a.max(q.abs()));
    let (mut square, mut outward, mut pushed) = (T::int(0), T::int(0), T::int(0));
    for i in 0..m {
        let q = y[i] / largest;
        square += q * q;
        outward += q * (f[i] / largest);
        pushed += q * f[m + i];
    }
    let grows = T::int(ESCAPING) * h * outward >= square;
    (grows && pushed > T::int(0) && square.is_finite()).then(|| largest * square.sqrt())
}
