//! Tells a motion that runs away to infinity from a step that is too large.
//!
//! A potential that falls faster than −|q|² throws a particle to infinity in finite time t*: q ~ (t* −
//! t)^{−β}, and no step converges that reaches beyond t*. Near it the position moves outward, is pushed
//! outward, and grows by a factor within the very step that fails. A fall into a centre is pulled inward, a
//! collision does not change |q| by a factor.
//!
//! Cost: one gradient, after a step has failed for good.

use crate::control::policy::ESCAPING;
use equip_autodiff::Evaluator;
use equip_scalar::Float;

/// |q| at `y` if the motion from there reaches infinity within about a step of `h`.
pub(crate) fn escapes<T: Float>(energy: &mut Evaluator<T>, y: &[T], h: T) -> Option<T> {
    let m = y.len() / 2;
    let mut f = vec![T::int(0); y.len()];
    energy.vector_field(y, &mut f);
    // In units of the largest position: squares of what runs away leave the range of the float type.
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
