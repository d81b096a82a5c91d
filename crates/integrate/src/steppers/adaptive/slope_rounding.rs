//! What rounding makes of ∇H: a state is known to its last place, and where ∇²H is large next to the force
//! itself, as of a stiff spring near its length, the force is known to few digits. What coefficients have of
//! that is no motion, and no shorter step resolves it.
//!
//! ∇H is evaluated [`MOVES`] times more, at the state moved by some units of its last place, of each
//! component by another part of them, scattered: by regular ones sums and second differences, as along a
//! chain, may move by nothing.

use crate::control::policy::ROUNDING;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// How often the state is moved: the one of 2000 forces that a move leaves as it is, another does not. //
/// moves; docs/adr/0024; of 228 ordinary runs gradients are 1.002 times as many as without any.
pub(super) const MOVES: u64 = 3;

/// Workspace for it.
#[derive(Debug)]
pub(super) struct SlopeRounding<T> {
    moved: Vec<T>,
    slope: Vec<T>,
    most: Vec<T>,
}

impl<T: Float> SlopeRounding<T> {
    /// Of states with n components.
    pub(super) fn new(n: usize) -> Self {
        let zeros = || vec![T::int(0); n];
        SlopeRounding {
            moved: zeros(),
            slope: zeros(),
            most: zeros(),
        }
    }

    /// By how much each component of ∇H at `y`, which is `slope`, may be off; by nothing where that is not
    /// finite.
    pub(super) fn at<E: Evaluate<T>>(&mut self, energy: &mut E, y: &[T], slope: &[T]) -> &[T] {
        let units = T::int(ROUNDING) * T::EPSILON;
        self.most.fill(T::int(0));
        let mut place = 0;
        for _ in 0..MOVES {
            for (moved, &y) in self.moved.iter_mut().zip(y) {
                *moved = y + T::exact(scattered(place)) * units * y;
                place += 1;
            }
            energy.gradient(&self.moved, &mut self.slope);
            for (most, (&moved, &slope)) in self.most.iter_mut().zip(self.slope.iter().zip(slope)) {
                let off = (moved - slope).abs();
                *most = if off.is_finite() {
                    most.max(off)
                } else {
                    T::INFINITY
                };
            }
        }
        for most in self.most.iter_mut().filter(|most| !most.is_finite()) {
            *most = T::int(0);
        }
        &self.most
    }
}

/// A number within ±1 for each place in a sequence, without any pattern (SplitMix64; Steele, Lea, Flood
/// 2014).
fn scattered(place: u64) -> f64 {
    let mut x = place.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_autodiff::{Hamiltonian, System};

    /// A spring of stiffness k at q = 1 has a force known to k ε, and the edge of a domain hides nothing.
    #[test]
    fn forces_are_off_by_what_the_state_is() {
        let stiff = Hamiltonian::new(2, |q, _| {
            let x = q[0] - q[1];
            5e5 * x * x + (1.0 - q[1]).powf(1.5)
        });
        let mut energy = stiff.unwrap().evaluator::<f64>();
        let (mut rounding, mut slope) = (SlopeRounding::new(4), vec![0.0; 4]);
        for (y, least, most) in [
            ([0.5, 0.5, 0.0, 0.0], 1e-10, 1e-8),
            ([1.0, 1.0, 0.0, 0.0], 0.0, 1e-8),
        ] {
            energy.gradient(&y, &mut slope);
            let off = rounding.at(&mut energy, &y, &slope);
            assert!(
                off[..2].iter().all(|x| (least..most).contains(x)),
                "{off:?}"
            );
            assert_eq!(off[2..], [0.0; 2]);
        }
    }
}
