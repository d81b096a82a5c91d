//! The members of the Gauss family that a step can be made with.

use equip_scalar::Constant;

/// Which α's are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Alphas {
    /// All of α_1 … α_{s−1}, moved so that the end point moves least.
    #[default]
    All,
    /// Only α_{s−1}, as in the paper. Where ∂g/∂α vanishes it has no solution; see the outcomes of the steps.
    Last,
}

/// What the α's of a method are.
#[derive(Debug, Clone, Copy, PartialEq)]
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
