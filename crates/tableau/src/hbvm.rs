//! HBVM(k, s): Hamiltonian boundary value methods, the energy-preserving relatives of Gauss.
//!
//! $$A = \mathcal I_s \mathcal P_s^T B, \qquad (\mathcal I_s)_{ij} = \int_0^{c_i} P_j, \quad (\mathcal P_s)_{ij} = P_j(c_i),
//! \quad i = 1..k,\ j = 0..s-1,$$
//!
//! on k ≥ s Gauss nodes (L. Brugnano, F. Iavernaro, D. Trigiante, "Hamiltonian boundary value methods",
//! JNAIAM 5 (2010)). Order 2s and symmetric for every k; HBVM(s, s) is Gauss; for k > s it is not symplectic.
//! It keeps a polynomial H of degree ν ≤ 2k/s exactly, others up to the quadrature error, O(h^{2k+1}) per
//! step.
//!
//! The limit k → ∞ keeps every H: ∞-HBVM, the energy-preserving collocation methods of Hairer (2010), and for
//! s = 1 the averaged vector field method y_1 = y_0 + h ∫₀¹ J∇H(y_0 + c (y_1 − y_0)) dc. In floating point k
//! is large enough when the quadrature is exact to rounding, so no tableau of its own is offered.
//!
//! Cost: O(k² s) operations.

use crate::error::TableauError;
use crate::legendre::legendre_integrals_at;
use crate::rule::{Rule, check_stages};
use crate::tableau::Tableau;
use equip_scalar::Float;

/// The tableau of HBVM(k, s), with k stages of which A has rank s.
///
/// # Errors
/// [`TableauError::StagesOutOfRange`] when k or s is not in 1 … [`MAX_STAGES`](crate::MAX_STAGES),
/// [`TableauError::TooFewNodes`] when k < s.
///
/// ```
/// use equip_tableau::{hbvm, order};
///
/// let method = hbvm::<f64>(6, 2)?; // keeps polynomial energies up to degree 6
/// assert_eq!(method.stages(), 6);
/// assert_eq!(order(&method, 1e-12), 4);
/// # Ok::<(), equip_tableau::TableauError>(())
/// ```
pub fn hbvm<T: Float>(k: usize, s: usize) -> Result<Tableau<T>, TableauError> {
    check_stages(k)?;
    check_stages(s)?;
    if k < s {
        return Err(TableauError::TooFewNodes {
            nodes: k,
            degree: s,
        });
    }
    let rule = Rule::new(k, s);
    let mut a = vec![T::int(0); k * k];
    let mut integrals = vec![T::int(0); s];
    for (row, &c_i) in a.chunks_exact_mut(k).zip(&rule.nodes) {
        legendre_integrals_at(c_i, &mut integrals);
        for (&integral, p) in integrals.iter().zip(rule.legendre.chunks_exact(k)) {
            for (a_il, (&p_l, &b_l)) in row.iter_mut().zip(p.iter().zip(&rule.weights)) {
                *a_il += integral * p_l * b_l;
            }
        }
    }
    Ok(Tableau {
        a,
        b: rule.weights,
        c: rule.nodes,
    })
}
