//! The methods: [`Equip`], [`Gauss`], Gauss with a fixed α, HBVM and trapezoidal methods.

use equip_scalar::Constant;
use equip_solver::{Alphas, Family};
use std::fmt;

/// The number of nodes of the averaged vector field method if H is not a polynomial. // nodes; with 100 steps
/// a period the energy error is round-off in 13 of 16 scenes with 8, in 14 with 16, in 15 with 32; one has a
/// close encounter
const MOST_NODES: usize = 16;

/// Energy and quadratic invariants preserving methods: Gauss methods with free parameters α_k. Each step
/// first computes the Gauss step (α = 0). If its energy error exceeds the round-off level, the solver
/// determines the α_k so that H(y₁) = H_ref.
#[derive(Debug, Clone, Copy)]
pub struct Equip;

impl Equip {
    /// EQUIP with s ≥ 2 stages, order 2s. Use s ≥ 3: with s = 2 there is a single α.
    ///
    /// By default the first max(3, c) of α_1 … α_{s−1} are solved for, c being the number of conserved
    /// quantities.
    /// [`Method::alphas`] selects the single α of the paper.
    pub fn stages(stages: usize) -> Method {
        Method {
            stages,
            family: Family::Equip(Alphas::Several),
        }
    }
}

/// Gauss–Legendre collocation, α = 0. Quadratic invariants are conserved, the energy is not.
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

/// A method without a step size: family and number of stages. Checked when the integration starts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Method {
    pub(crate) stages: usize,
    pub(crate) family: Family,
}

impl Method {
    /// The method with α_{s−1} fixed at `alpha` (dimensionless), s ≥ 2: symplectic, symmetric, of order 2s −
    /// 2 if `alpha` is not zero.
    pub fn fixed_alpha(stages: usize, alpha: impl Into<Constant>) -> Method {
        Method {
            stages,
            family: Family::FixedAlpha(alpha.into()),
        }
    }

    /// HBVM(k, s) with k Gauss nodes and degree s, 1 ≤ s ≤ k, of order 2s (Brugnano, Iavernaro, Trigiante
    /// 2010). It conserves a polynomial H of degree ν ≤ 2k/s, and any other H up to the quadrature error of
    /// ∇H along a step. It conserves no quadratic invariants.
    ///
    /// ```
    /// use equip_integrate::Method;
    /// assert_eq!(Method::hbvm(6, 2).order(), 4);
    /// ```
    pub fn hbvm(k: usize, s: usize) -> Method {
        Method {
            stages: k,
            family: Family::Hbvm { degree: s },
        }
    }

    /// The averaged vector field method of order 2: y1 = y0 + h ∫₀¹ J∇H(y0 + c (y1 − y0)) dc. It is
    /// HBVM(k, 1) with k = ⌈ν/2⌉ for a polynomial H of degree ν, at most 16, and with k = 16 otherwise.
    pub fn averaged_vector_field() -> Method {
        Method {
            stages: MOST_NODES,
            family: Family::AveragedVectorField,
        }
    }

    /// The trapezoidal method with k equidistant nodes, 2 ≤ k ≤ 8, of order 2 (Iavernaro, Pace 2007): the
    /// averaged vector field by the closed Newton–Cotes rule.
    pub fn trapezoidal(k: usize) -> Method {
        Method {
            stages: k,
            family: Family::Trapezoidal,
        }
    }

    /// The method with this name and its numbers: `hbvm=k,s`, `avf` or `trapezoidal=k`; `None` for any other
    /// name.
    ///
    /// ```
    /// use equip_integrate::Method;
    /// assert_eq!(Method::named("hbvm=6,2"), Some(Method::hbvm(6, 2)));
    /// assert_eq!(Method::named("hbvm=6"), None);
    /// ```
    pub fn named(name: &str) -> Option<Method> {
        let (family, numbers) = name.split_once('=').unwrap_or((name, ""));
        let numbers = numbers.split(',').filter(|number| !number.is_empty());
        let numbers: Option<Vec<usize>> =
            numbers.map(|number| number.trim().parse().ok()).collect();
        match (family, numbers?.as_slice()) {
            ("hbvm", &[k, s]) => Some(Method::hbvm(k, s)),
            ("avf", []) => Some(Method::averaged_vector_field()),
            ("trapezoidal", &[k]) => Some(Method::trapezoidal(k)),
            _ => None,
        }
    }

    /// The method for an energy of this polynomial degree, `None` if it is not a polynomial.
    pub(crate) fn for_degree(mut self, degree: Option<u32>) -> Method {
        if let (Family::AveragedVectorField, Some(degree)) = (self.family, degree) {
            self.stages = (degree as usize).div_ceil(2).clamp(1, MOST_NODES);
        }
        self
    }

    /// Selects the α_k that EQUIP solves for. No effect on the other families.
    #[must_use]
    pub fn alphas(mut self, alphas: Alphas) -> Method {
        if let Family::Equip(_) = self.family {
            self.family = Family::Equip(alphas);
        }
        self
    }

    /// The number of stages.
    pub fn stage_count(&self) -> usize {
        self.stages
    }

    /// The family.
    pub fn family(&self) -> Family {
        self.family
    }

    /// The degree s of the polynomial of a step: the number of stages, except for HBVM and trapezoidal
    /// methods.
    pub fn degree(&self) -> usize {
        self.family.degree(self.stages)
    }

    /// The order of the method: 2s, or 2s − 2 with a fixed α ≠ 0.
    pub fn order(&self) -> usize {
        match self.family {
            Family::FixedAlpha(alpha) if alpha.to::<f64>() != 0.0 => 2 * self.stages - 2,
            _ => 2 * self.degree(),
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (family, s, order) = (self.family, self.stages, self.order());
        write!(f, "{family}, {s} stages, order {order}")
    }
}
