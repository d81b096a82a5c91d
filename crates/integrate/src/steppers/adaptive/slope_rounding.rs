//! What rounding makes of ∇H: a state is known to its last place, and where ∇²H is large next to the force
//! itself, as of a stiff spring near its length, the force is known to few digits. What coefficients have of
//! that is no motion, and no shorter step resolves it.
//!
//! ∇H is evaluated once more, at the state moved by some units of its last place, of each component another
//! part of them, so that moves do not cancel where only differences of positions matter.

use crate::control::policy::ROUNDING;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// Workspace for it.
#[derive(Debug)]
pub(super) struct SlopeRounding<T> {
    moved: Vec<T>,
    slope: Vec<T>,
}

impl<T: Float> SlopeRounding<T> {
    /// Of states with n components.
    pub(super) fn new(n: usize) -> Self {
        let zeros = || vec![T::int(0); n];
        SlopeRounding {
            moved: zeros(),
            slope: zeros(),
        }
    }

    /// By how much each component of ∇H at `y`, which is `slope`, may be off; by nothing where that is not
    /// finite.
    pub(super) fn at<E: Evaluate<T>>(&mut self, energy: &mut E, y: &[T], slope: &[T]) -> &[T] {
        let most = T::int(ROUNDING) * T::EPSILON;
        let golden = (1.0 + 5_f64.sqrt()) / 2.0;
        for (c, (moved, &y)) in self.moved.iter_mut().zip(y).enumerate() {
            // Multiples of the golden ratio modulo 1 are spread evenly over [0, 1).
            let part = (c as f64 * golden).fract();
            *moved = y + T::exact(2.0 * part - 1.0) * most * y;
        }
        energy.gradient(&self.moved, &mut self.slope);
        for (off, &slope) in self.slope.iter_mut().zip(slope) {
            *off = (*off - slope).abs();
            if !off.is_finite() {
                *off = T::int(0);
            }
        }
        &self.slope
    }
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
