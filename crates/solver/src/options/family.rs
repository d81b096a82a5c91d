//! The members of the Gauss family that a step can be made with.

use equip_scalar::Constant;
use std::fmt;

/// Which α's are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Alphas {
    /// α_1, α_2, α_3, as far as there are any, so that the end point moves least: the others, which would
    /// disturb the stages more for the same, stay zero.
    #[default]
    All,
    /// Only α_{s−1}, as in the paper. Where ∂g/∂α vanishes it has no solution; see the outcomes of the steps.
    Last,
}

/// What the α's of a method are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Family {
    /// α = 0.
    Gauss,
    /// α_{s−1} fixed: symplectic, order 2s − 2.
    FixedAlpha(Constant),
    /// α solved for at every step.
    Equip(Alphas),
}

impl Family {
    /// Fewest stages that a member has.
    pub fn fewest_stages(self) -> usize {
        match self {
            Family::Gauss => 1,
            Family::FixedAlpha(_) | Family::Equip(_) => 2,
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
            Family::Equip(Alphas::All) => f.write_str("EQUIP"),
            Family::Equip(Alphas::Last) => f.write_str("EQUIP with the last α only"),
        }
    }
}
