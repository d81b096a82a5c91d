//! The interface between an iteration and its preconditioner.

use equip_scalar::Float;

/// Which end of the step is fixed in the linearised equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// The start: Z = K L.
    Start,
    /// The end: Z = −Kᵀ L.
    End,
}

/// M of the iteration Z ← Z + M⁻¹ (K L(Z) − Z): an approximation of I − K ∂L/∂Z, or of I + Kᵀ ∂L/∂Z if the
/// end is fixed.
///
/// M affects the convergence, not the solution.
pub trait Preconditioner<T: Float> {
    /// rows ← M⁻¹ rows. Component c of stage i is at `c·stride + i`, for all unknown components of the
    /// iteration.
    fn apply(&mut self, held: Held, rows: &mut [T]);
}
