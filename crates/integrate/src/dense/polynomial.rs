//! [`Polynomial`]: u(τ) = y0 + Σ_k h γ_k ∫₀^τ P_k, the polynomial of a step.

use equip_scalar::Float;
use equip_solver::{MAX_STAGES, State};
use equip_tableau::legendre_integrals_at;

/// The polynomial of a step from its start, τ = 0, to its end, τ = 1. Beyond both it goes on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polynomial<T> {
    pub(crate) start: State<T>,
    /// h γ_k, one after the other.
    pub(crate) coefficients: Vec<T>,
}

impl<T: Float> Polynomial<T> {
    /// ∫₀^τ P_k; as many as there are γ_k are needed.
    pub(crate) fn integrals(&self, place: T) -> [T; MAX_STAGES] {
        let mut integrals = [T::int(0); MAX_STAGES];
        let count = self.coefficients.len() / self.start.hi.len();
        legendre_integrals_at(place, &mut integrals[..count]);
        integrals
    }

    /// Component j of u where the integrals of the P_k are these.
    pub(crate) fn component(&self, j: usize, integrals: &[T]) -> T {
        let n = self.start.hi.len();
        let count = self.coefficients.len() / n;
        let terms = self.coefficients[j..].iter().step_by(n);
        // From the smallest to the largest.
        let sum = terms.zip(&integrals[..count]).rev();
        let sum = sum.fold(self.start.lo[j], |sum, (&g, &i)| sum + g * i);
        self.start.hi[j] + sum
    }
}
