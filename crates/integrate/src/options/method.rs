//! Which member of the Gauss family: [`Equip`], [`Gauss`], or one with a fixed α.

use equip_scalar::Constant;
use equip_solver::{Alphas, Family};
use std::fmt;

/// Energy and quadratic invariants preserving methods: Gauss methods whose α's are solved for at every step.
#[derive(Debug, Clone, Copy)]
pub struct Equip;

impl Equip {
    /// EQUIP with s stages, order 2s, s ≥ 2; s ≥ 3 is the sensible choice, since s = 2 has a single α.
    ///
    /// The first three of α_1 … α_{s−1} move by default, or as many as there is to keep; [`Method::alphas`]
    /// selects the single α of the paper.
    pub fn stages(stages: usize) -> Method {
        Method {
            stages,
            family: Family::Equip(Alphas::All),
        }
    }
}

/// Gauss–Legendre collocation: α = 0. Quadratic invariants are kept, the energy is not.
#[derive(Debug, Clone, Copy)]
pub struct Gauss;

impl Gauss {
    /// The Gauss method with s ≥ 1 stages, order 2s.
    pub fn stages(stages: usize) -> Method {
        Method {
            stages,
            family: Family::Gauss,
        }
    }
}

/// A method before it has a step: family and number of stages. Checked when the integration starts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Method {
    pub(crate) stages: usize,
    pub(crate) family: Family,
}

impl Method {
    /// The method with α_{s−1} held at `alpha` (dimensionless), s ≥ 2: symplectic, symmetric, of order 2s −
    /// 2.
    pub fn fixed_alpha(stages: usize, alpha: impl Into<Constant>) -> Method {
        Method {
            stages,
            family: Family::FixedAlpha(alpha.into()),
        }
    }

    /// Which α's EQUIP solves for; no effect on the other families.
    #[must_use]
    pub fn alphas(mut self, alphas: Alphas) -> Method {
        if let Family::Equip(_) = self.family {
            self.family = Family::Equip(alphas);
        }
        self
    }

    /// Number of stages s.
    pub fn stage_count(&self) -> usize {
        self.stages
    }

    /// The family.
    pub fn family(&self) -> Family {
        self.family
    }

    /// Order of the method: 2s, or 2s − 2 with a fixed α ≠ 0.
    pub fn order(&self) -> usize {
        match self.family {
            Family::FixedAlpha(alpha) if alpha.to::<f64>() != 0.0 => 2 * self.stages - 2,
            _ => 2 * self.stages,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (family, s, order) = (self.family, self.stages, self.order());
        write!(f, "{family}, {s} stages, order {order}")
    }
}
