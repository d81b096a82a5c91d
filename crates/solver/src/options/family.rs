//! The families of methods for a step.

use equip_iterate::MAX_STAGES;
use equip_scalar::{Constant, Float};
use equip_tableau::{Coefficients, TableauError};
use std::fmt;

/// Which α_k are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Alphas {
    /// The first max(3, c) of the α_k, c being the number of constraints, or all of them if there are fewer,
    /// such that both ends of the step change least. The other α_k stay zero, because they would change the
    /// stages more for the same effect.
    #[default]
    Several,
    /// Only α_{s−1}, as in the paper. If ∂g/∂α vanishes there is no solution; see the outcomes of the steps.
    Last,
}

/// The family of a method, without its number of stages.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Family {
    /// α = 0.
    Gauss,
    /// α_{s−1} fixed: symplectic, order 2s − 2 if it is not zero.
    FixedAlpha(Constant),
    /// α solved for in every step whose energy error with α = 0 exceeds the round-off level.
    Equip(Alphas),
    /// HBVM(k, s) of this degree s, on k Gauss nodes, k being the number of stages. Its order is 2s. It
    /// conserves H up to the quadrature error of ∇H along a step, and no quadratic invariant.
    Hbvm {
        /// The degree s, from 1 to the number of stages.
        degree: usize,
    },
    /// HBVM(k, 1) whose stages integrate ∇H along a step to round-off: k stages for H of degree 2k, otherwise
    /// the given number.
    AveragedVectorField,
    /// The trapezoidal method on 2 to 8 equidistant nodes: order 2.
    Trapezoidal,
}

impl Family {
    /// The method with this number of stages.
    ///
    /// # Errors
    /// [`TableauError`] if there is none.
    pub fn coefficients<T: Float>(self, stages: usize) -> Result<Coefficients<T>, TableauError> {
        match self {
            Family::Gauss => Coefficients::gauss(stages),
            Family::FixedAlpha(_) | Family::Equip(_) if (2..=MAX_STAGES).contains(&stages) => {
                Coefficients::gauss(stages)
            }
            Family::FixedAlpha(_) | Family::Equip(_) => Err(TableauError::StagesOutOfRange {
                stages,
                min: 2,
                max: MAX_STAGES,
            }),
            Family::Hbvm { degree } => Coefficients::hbvm(stages, degree),
            Family::AveragedVectorField => Coefficients::hbvm(stages, 1),
            Family::Trapezoidal => Coefficients::trapezoidal(stages),
        }
    }

    /// The degree of a step with this number of stages: half its order unless α ≠ 0 is fixed.
    pub fn degree(self, stages: usize) -> usize {
        match self {
            Family::Hbvm { degree } => degree,
            Family::AveragedVectorField | Family::Trapezoidal => 1,
            _ => stages,
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Family::Gauss => f.write_str("Gauss"),
            Family::FixedAlpha(alpha) => {
                write!(f, "Gauss family, fixed α = {}", alpha.to::<f64>())
            }
            Family::Equip(Alphas::Several) => f.write_str("EQUIP"),
            Family::Equip(Alphas::Last) => f.write_str("EQUIP with the last α only"),
            Family::Hbvm { degree } => write!(f, "HBVM of degree {degree}"),
            Family::AveragedVectorField => f.write_str("averaged vector field"),
            Family::Trapezoidal => f.write_str("trapezoidal"),
        }
    }
}
