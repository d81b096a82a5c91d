//! [`Coefficients`]: a Runge–Kutta method of the family as data, in the notation of the paper.
//!
//! The method has k nodes with weights b. P_0 … P_{s−1} are the orthonormal shifted Legendre polynomials, s
//! is the degree.
//!
//! $$ A(\alpha) = K(\alpha) B, \qquad K(0)_{ij} = \sum_{l<s} \int_0^{c_i} P_l \; P_l(c_j), \qquad B = \mathrm{diag}(b). $$
//!
//! | method | nodes | degree | order |
//! |---|---|---|---|
//! | [`gauss`](Coefficients::gauss), and with its α_k EQUIP | s Gauss nodes | s | 2s |
//! | [`hbvm`](Coefficients::hbvm)(k, s) | k ≥ s Gauss nodes | s | 2s |
//! | [`averaged_vector_field`](Coefficients::hbvm) = HBVM(k, 1) | k Gauss nodes | 1 | 2 |
//! | [`trapezoidal`](Coefficients::trapezoidal)(k) | k ≥ 2 equidistant nodes, both ends among them | 1 | 2 |
//!
//! HBVM and trapezoidal methods (L. Brugnano, F. Iavernaro, D. Trigiante, "Hamiltonian boundary value
//! methods", JNAIAM 5 (2010); F. Iavernaro, B. Pace, "s-stage trapezoidal methods for the conservation of
//! Hamiltonian functions of polynomial type", AIP Conf. Proc. 936 (2007)) are symmetric. They conserve a
//! polynomial H if their quadrature integrates ∇H along the step exactly; on Gauss nodes it does for degrees
//! ν ≤ 2k/s. They conserve any other H up to the quadrature error. They do not conserve quadratic invariants.
//!
//! | letter | here |
//! |---|---|
//! | c_i, b_i | [`Coefficients::nodes`], [`Coefficients::weights`] |
//! | columns of 𝒫 | [`Coefficients::legendre`], p_k = (P_k(c_1), …, P_k(c_s))ᵀ |
//! | ξ_k = 1/(2√(4k² − 1)) | [`Coefficients::xi`] |
//! | A(α) = 𝒫 X_s(α) 𝒫⁻¹, eqs. (3)–(6) | [`Coefficients::tableau`], from K(α) in `skew.rs` |

use crate::error::TableauError;
use crate::legendre::legendre_integrals_at;
use crate::rule::{Rule, check_stages};
use equip_scalar::Float;

/// Nodes, weights, degree and the matrix K(α) of a method. Only Gauss methods have parameters α_k.
///
/// Construction costs O(s³) operations; the result holds s³ + O(s²) numbers.
///
/// ```
/// use equip_tableau::Coefficients;
///
/// let gauss = Coefficients::<f64>::gauss(2)?;
/// assert_eq!(gauss.nodes()[0], 0.5 - 3f64.sqrt() / 6.0);
/// assert_eq!(gauss.weights(), [0.5, 0.5]);
/// # Ok::<(), equip_tableau::TableauError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Coefficients<T> {
    pub(crate) stages: usize,
    degree: usize,
    rule: Rule<T>,
    /// The matrices T_1 … T_{s−1}, each s × s, concatenated; empty if there are no α_k.
    pub(crate) basis: Vec<T>,
    pub(crate) unperturbed: Unperturbed<T>,
}

/// K(0).
#[derive(Debug, Clone)]
pub(crate) enum Unperturbed<T> {
    /// The antisymmetric part Σ ξ_k T_k of K(0), where K_ij + K_ji = 1.
    Skew(Vec<T>),
    /// K(0) itself.
    Whole(Vec<T>),
}

impl<T: Float> Coefficients<T> {
    /// The Gauss method with 1 ≤ `stages` ≤ [`MAX_STAGES`](crate::MAX_STAGES) stages and s − 1 parameters
    /// α_k. Its order is 2s at α = 0.
    ///
    /// # Errors
    /// [`TableauError::StagesOutOfRange`] for any other number.
    ///
    /// ```
    /// use equip_tableau::Coefficients;
    /// assert!(Coefficients::<f64>::gauss(4).is_ok());
    /// assert!(Coefficients::<f64>::gauss(0).is_err());
    /// ```
    pub fn gauss(stages: usize) -> Result<Self, TableauError> {
        check_stages(stages)?;
        let rule = Rule::new(stages, stages);
        let mut basis = vec![T::int(0); (stages - 1) * stages * stages];
        for (k, t_k) in basis.chunks_exact_mut(stages * stages).enumerate() {
            let [before, this] = [k, k + 1].map(|k| &rule.legendre[k * stages..][..stages]);
            commutator(this, before, t_k);
        }
        let mut unperturbed = vec![T::int(0); stages * stages];
        // Summed from the smallest ξ_k to the largest.
        for (index, t_k) in basis.chunks_exact(stages * stages).enumerate().rev() {
            let xi = xi::<T>(index + 1);
            for (sum, &t) in unperturbed.iter_mut().zip(t_k) {
                *sum += xi * t;
            }
        }
        Ok(Coefficients {
            stages,
            degree: stages,
            rule,
            basis,
            unperturbed: Unperturbed::Skew(unperturbed),
        })
    }

    /// HBVM(k, s): degree s on k Gauss nodes, order 2s. For large k, HBVM(k, 1) approaches the averaged
    /// vector field method, and HBVM(k, s) the energy-preserving collocation method of Hairer (2010).
    ///
    /// # Errors
    /// [`TableauError::StagesOutOfRange`] when k or s is not in 1 … [`MAX_STAGES`](crate::MAX_STAGES),
    /// [`TableauError::TooFewNodes`] when k < s.
    ///
    /// ```
    /// use equip_tableau::{Coefficients, order};
    ///
    /// let method = Coefficients::<f64>::hbvm(6, 2)?; // conserves polynomial energies up to degree 6
    /// assert_eq!((method.stages(), method.degree(), method.alphas()), (6, 2, 0));
    /// assert_eq!(order(&method.tableau(&[]), 1e-12), 4);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn hbvm(k: usize, s: usize) -> Result<Self, TableauError> {
        check_stages(k)?;
        check_stages(s)?;
        if k < s {
            return Err(TableauError::TooFewNodes {
                nodes: k,
                degree: s,
            });
        }
        Ok(Self::without_alphas(Rule::new(k, s), s))
    }

    /// The trapezoidal method y1 = y0 + h Σ b_i f(y0 + c_i (y1 − y0)) with k equidistant nodes from 0 to 1
    /// and the weights of the closed Newton–Cotes rule. Its order is 2.
    ///
    /// # Errors
    /// [`TableauError::StagesOutOfRange`] for k < 2 and for k > 8: for k > 8 some weights are negative.
    ///
    /// ```
    /// let method = equip_tableau::Coefficients::<f64>::trapezoidal(3)?;
    /// assert_eq!(method.nodes(), [0.0, 0.5, 1.0]);
    /// assert!((method.weights()[1] - 4.0 / 6.0).abs() < 1e-15);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn trapezoidal(k: usize) -> Result<Self, TableauError> {
        if !(2..=8).contains(&k) {
            return Err(TableauError::StagesOutOfRange {
                stages: k,
                min: 2,
                max: 8,
            });
        }
        Ok(Self::without_alphas(Rule::newton_cotes(k), 1))
    }

    fn without_alphas(rule: Rule<T>, degree: usize) -> Self {
        let k = rule.nodes.len();
        let mut matrix = vec![T::int(0); k * k];
        let mut integrals = vec![T::int(0); degree];
        for (row, &c) in matrix.chunks_exact_mut(k).zip(&rule.nodes) {
            legendre_integrals_at(c, &mut integrals);
            for (&integral, p) in integrals.iter().zip(rule.legendre.chunks_exact(k)) {
                row.iter_mut()
                    .zip(p)
                    .for_each(|(sum, &p)| *sum += integral * p);
            }
        }
        Coefficients {
            stages: k,
            degree,
            rule,
            basis: Vec::new(),
            unperturbed: Unperturbed::Whole(matrix),
        }
    }

    /// The number of stages, equal to the number of nodes.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Coefficients::<f64>::gauss(3)?.stages(), 3);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn stages(&self) -> usize {
        self.stages
    }

    /// The degree s of the polynomial that approximates the solution over a step: half the order at α = 0.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Coefficients::<f64>::hbvm(6, 2)?.degree(), 2);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Whether K_ij + K_ji = 1, so that quadratic invariants are conserved. It holds for Gauss methods with
    /// any α_k.
    ///
    /// ```
    /// assert!(!equip_tableau::Coefficients::<f64>::hbvm(6, 2)?.is_skew());
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn is_skew(&self) -> bool {
        matches!(self.unperturbed, Unperturbed::Skew(_))
    }

    /// The number of parameters α_k: s − 1 for a Gauss method, 0 for the others.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Coefficients::<f64>::gauss(4)?.alphas(), 3);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn alphas(&self) -> usize {
        self.basis.len() / (self.stages * self.stages)
    }

    /// The nodes c_1 < … < c_s in [0, 1].
    ///
    /// c_i + c_{s+1−i} = 1 holds exactly in floating point. The node c_{s+1−i} ≥ ½ is rounded, and the
    /// smaller one is computed as 1 − c_{s+1−i}, which is representable. Both are therefore accurate to an
    /// ulp of 1, not of c_i. Weights and polynomial values belong to the unrounded nodes.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(5)?;
    /// let c = gauss.nodes();
    /// assert!((0..5).all(|i| c[i] == 1.0 - c[4 - i]));
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn nodes(&self) -> &[T] {
        &self.rule.nodes
    }

    /// The weights. On Gauss nodes b_i = 1 / Σ_{k<s} P_k(c_i)², b_i = b_{s+1−i} exactly, and Σ b_i = 1 up to
    /// rounding.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(3)?;
    /// assert!((gauss.weights()[1] - 4.0 / 9.0).abs() < 1e-16);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn weights(&self) -> &[T] {
        &self.rule.weights
    }

    /// p_k = (P_k(c_1), …, P_k(c_s)) for k below the degree. It is exactly even or odd under i → s + 1 − i.
    ///
    /// # Panics
    /// If k is not below the degree.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(2)?;
    /// assert_eq!(gauss.legendre(0), [1.0, 1.0]);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn legendre(&self, k: usize) -> &[T] {
        &self.rule.legendre[k * self.stages..(k + 1) * self.stages]
    }

    /// ξ_k = 1/(2√(4k² − 1)) for any k ≥ 1, including k ≥ s; NaN for k = 0.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(2)?;
    /// assert!((gauss.xi(1) - 3f64.sqrt() / 6.0).abs() < 1e-16);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn xi(&self, k: usize) -> T {
        xi(k)
    }
}

/// ξ_k = 1/(2√(4k² − 1)).
pub(crate) fn xi<T: Float>(k: usize) -> T {
    if k == 0 {
        return T::NAN;
    }
    let k = k as i64;
    T::int(1) / (T::int(2) * T::int(4 * k * k - 1).sqrt())
}

/// p qᵀ − q pᵀ. The upper triangle is computed, the lower one is its negative.
fn commutator<T: Float>(p: &[T], q: &[T], t: &mut [T]) {
    let s = p.len();
    for i in 0..s {
        for j in i + 1..s {
            t[i * s + j] = p[i] * q[j] - q[i] * p[j];
        }
    }
    mirror(s, t);
}

/// Sets the lower triangle to the negative of the upper one.
pub(crate) fn mirror<T: Float>(s: usize, u: &mut [T]) {
    for i in 0..s {
        for j in i + 1..s {
            u[j * s + i] = -u[i * s + j];
        }
    }
}
