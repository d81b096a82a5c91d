//! The seam between an iteration and its preconditioner.

use equip_scalar::Float;

/// The end of the step that does not move where equations are linearised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// The start: Z = K L.
    Start,
    /// The end: Z = −Kᵀ L.
    End,
}

/// M of the iteration Z ← Z + M⁻¹ (K L(Z) − Z): an approximation of I − K ∂L/∂Z, or of I + Kᵀ ∂L/∂Z where the
/// end is held.
///
/// M changes how the solution is found and not the solution.
pub trait Preconditioner<T: Float> {
    /// rows ← M⁻¹ rows. Component c of stage i stands at `c·stride + i`, for all unknown components of the
    /// iteration.
    fn apply(&mut self, held: Held, rows: &mut [T]);
}
