//! Runge–Kutta tableaux of the Gauss, EQUIP and HBVM families in any [`Float`](equip_scalar::Float) type, and
//! the conditions that they satisfy, as functions.
//!
//! | item | meaning |
//! |---|---|
//! | [`Coefficients`] | a method as data: nodes, weights, degree, Legendre vectors p_k and the matrix K(α) |
//! | [`legendre_at`], [`legendre_integrals_at`], [`legendre_derivatives_at`] | the polynomials P_k at any c |
//! | [`Tableau`] | A, b, c of any Runge–Kutta method; [`Coefficients::tableau`] constructs them |
//! | [`conditions`] | residuals of B(p), C(η), D(ζ), symplecticity, symmetry |
//! | [`trees`], [`order()`] | rooted trees, order conditions, the order of a tableau |
//!
//! No coefficient of the Gauss family is a stored decimal: each is computed in the floating-point type in
//! which it is used.
//!
//! The formulas are those of L. Brugnano, F. Iavernaro, D. Trigiante, "Energy and quadratic invariants
//! preserving integrators of Gaussian type", AIP Conf. Proc. 1281 (2010) ("the paper") and its long version
//! arXiv:1005.1930. The paper counts polynomials from 1, this crate counts from 0: P_0 = 1.
//!
//! ```
//! use equip_tableau::{Coefficients, conditions};
//!
//! let gauss = Coefficients::<f64>::gauss(3)?;
//! let perturbed = gauss.tableau(&[0.0, 0.05]);
//! assert!(conditions::symplecticity_residual(&perturbed) < 1e-15);
//! # Ok::<(), equip_tableau::TableauError>(())
//! ```
#![forbid(unsafe_code)]

mod coefficients;
pub mod conditions;
mod error;
mod legendre;
mod order;
mod rule;
mod skew;
mod tableau;
pub mod trees;

pub use coefficients::Coefficients;
pub use error::TableauError;
pub use legendre::{legendre_at, legendre_derivatives_at, legendre_integrals_at};
pub use order::order;
pub use rule::MAX_STAGES;
pub use tableau::Tableau;
