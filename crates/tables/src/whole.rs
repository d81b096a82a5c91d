//! [`floor`]: the largest integer not above x, for rounding, remainders and periodic boxes.
//!
//! The function is constant between integers. Its switching function between n and n + 1 is
//! g = ± 4 (x − n)(n + 1 − x), with + for even n: it changes its sign at every integer, and g and g′ are
//! continuous.

use crate::polynomial::words;
use equip_scalar::{DoubleDouble, Float, Num, Outside, Scalar};
use std::sync::{Arc, LazyLock};

/// What the bytes of tables begin with is the number of their axes: the floor has none.
const BYTES: [u8; 1] = [0];

#[derive(Debug)]
struct Floor;

#[derive(Debug)]
struct Waves;

static FLOOR: LazyLock<Arc<dyn Outside>> = LazyLock::new(|| Arc::new(Floor));
static WAVES: LazyLock<Arc<dyn Outside>> = LazyLock::new(|| Arc::new(Waves));

/// The largest integer not above x, in an energy. Its derivatives are 0. Steps end at its jumps.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_tables::floor;
///
/// // A pendulum in a periodic box of length 3: the distance to the nearest image of the origin.
/// let h = Hamiltonian::new(1, |q, p| {
///     let nearest = q[0] - 3 * floor(q[0] / 3 + 0.5);
///     p[0] * p[0] / 2 - nearest.cos()
/// })?;
/// assert_eq!(h.evaluator().value(&[3.25, 0.0]), -0.25_f64.cos());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[inline]
pub fn floor<S: Scalar>(x: Num<S>) -> Num<S> {
    Num(S::outside(&FLOOR, [0, 0], [x.0, x.0]))
}

pub(crate) fn outside() -> Arc<dyn Outside> {
    Arc::clone(&FLOOR)
}

pub(crate) fn is_floor(bytes: &[u8]) -> bool {
    bytes == BYTES
}

fn pair([hi, lo]: [f64; 2]) -> DoubleDouble {
    DoubleDouble::new(hi, lo)
}

impl Outside for Floor {
    fn variables(&self) -> usize {
        1
    }

    fn derivative(&self, [order, _]: [u8; 2], [x, _]: [f64; 2]) -> f64 {
        if order == 0 { x.floor() } else { 0.0 }
    }

    fn derivative_in_pairs(&self, [order, _]: [u8; 2], [x, _]: [[f64; 2]; 2]) -> [f64; 2] {
        match order {
            0 => words(pair(x).floor()),
            _ => [0.0; 2],
        }
    }

    fn to_bytes(&self) -> Option<Vec<u8>> {
        Some(BYTES.to_vec())
    }

    fn is_step(&self) -> bool {
        true
    }

    fn kinks(&self) -> Vec<Arc<dyn Outside>> {
        vec![Arc::clone(&WAVES)]
    }
}

/// The derivative of g at n + t for an n that is even or not.
fn wave<T: Float>(order: u8, t: T, is_even: bool) -> T {
    let sign = T::int(if is_even { 4 } else { -4 });
    match order {
        0 => sign * t * (T::int(1) - t),
        1 => sign * (T::int(1) - T::int(2) * t),
        2 => -(T::int(2) * sign),
        _ => T::int(0),
    }
}

impl Outside for Waves {
    fn variables(&self) -> usize {
        1
    }

    fn derivative(&self, [order, _]: [u8; 2], [x, _]: [f64; 2]) -> f64 {
        let whole = x.floor();
        wave(order, x - whole, whole % 2.0 == 0.0)
    }

    fn derivative_in_pairs(&self, [order, _]: [u8; 2], [x, _]: [[f64; 2]; 2]) -> [f64; 2] {
        let x = pair(x);
        let whole = x.floor();
        let is_even = (whole.hi() % 2.0 == 0.0) == (whole.lo() % 2.0 == 0.0);
        words(wave(order, x - whole, is_even))
    }
}
