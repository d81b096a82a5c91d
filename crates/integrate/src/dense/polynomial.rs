//! [`Polynomial`]: u(τ) = y0 + Σ_k h γ_k ∫₀^τ P_k, the polynomial of a step.

use equip_scalar::Float;
use equip_solver::{MAX_STAGES, State};
use equip_tableau::legendre_integrals_at;

/// The polynomial of a step from its start, τ = 0, to its end, τ = 1. It extrapolates beyond both.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polynomial<T> {
    pub(crate) start: State<T>,
    /// The h γ_k, concatenated.
    pub(crate) coefficients: Vec<T>,
}

impl<T: Float> Polynomial<T> {
    /// ∫₀^τ P_k, one for each γ_k.
    pub(crate) fn integrals(&self, place: T) -> [T; MAX_STAGES] {
        let mut integrals = [T::int(0); MAX_STAGES];
        let count = self.coefficients.len() / self.start.hi.len();
        legendre_integrals_at(place, &mut integrals[..count]);
        integrals
    }

    /// Component j of u, from these integrals of P_k.
    pub(crate) fn component(&self, j: usize, integrals: &[T]) -> T {
        let n = self.start.hi.len();
        let count = self.coefficients.len() / n;
        let terms = self.coefficients[j..].iter().step_by(n);
        // Summed from the smallest to the largest term.
        let sum = terms.zip(&integrals[..count]).rev();
        let sum = sum.fold(self.start.lo[j], |sum, (&g, &i)| sum + g * i);
        self.start.hi[j] + sum
    }
}
