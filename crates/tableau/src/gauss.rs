//! [`Gauss`]: the Gauss–Legendre collocation method with s stages, in the letters of the paper.
//!
//! | letter | here |
//! |---|---|
//! | c_i, b_i | [`Gauss::nodes`], [`Gauss::weights`] |
//! | columns of 𝒫 | [`Gauss::legendre`], p_k = (P_k(c_1), …, P_k(c_s))ᵀ |
//! | ξ_k = 1/(2√(4k² − 1)) | [`Gauss::xi`] |
//! | A(α) = 𝒫 X_s(α) 𝒫⁻¹, eqs. (3)–(6) | [`Gauss::tableau`], from K(α) in `skew.rs` |

use crate::error::TableauError;
use crate::rule::{Rule, check_stages};
use equip_scalar::Float;

/// Gauss–Legendre quadrature on [0, 1] with s nodes, the orthonormal shifted Legendre polynomials at them,
/// and the matrix K(α) of the EQUIP methods.
///
/// Making one costs O(s³) operations; it then holds s³ + O(s²) numbers.
///
/// ```
/// use equip_tableau::Gauss;
///
/// let gauss = Gauss::<f64>::new(2)?;
/// assert_eq!(gauss.nodes()[0], 0.5 - 3f64.sqrt() / 6.0);
/// assert_eq!(gauss.weights(), [0.5, 0.5]);
/// # Ok::<(), equip_tableau::TableauError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Gauss<T> {
    pub(crate) stages: usize,
    rule: Rule<T>,
    /// T_1 … T_{s−1}, each s × s, one after the other.
    pub(crate) basis: Vec<T>,
    /// Σ ξ_k T_k, s × s.
    pub(crate) unperturbed: Vec<T>,
}

impl<T: Float> Gauss<T> {
    /// The method with 1 ≤ `stages` ≤ [`MAX_STAGES`](crate::MAX_STAGES) stages, of order 2s at α = 0.
    ///
    /// # Errors
    /// [`TableauError::StagesOutOfRange`] for any other number.
    ///
    /// ```
    /// use equip_tableau::Gauss;
    /// assert!(Gauss::<f64>::new(4).is_ok());
    /// assert!(Gauss::<f64>::new(0).is_err());
    /// ```
    pub fn new(stages: usize) -> Result<Self, TableauError> {
        check_stages(stages)?;
        let rule = Rule::new(stages, stages);
        let mut basis = vec![T::int(0); (stages - 1) * stages * stages];
        for (k, t_k) in basis.chunks_exact_mut(stages * stages).enumerate() {
            let [before, this] = [k, k + 1].map(|k| &rule.legendre[k * stages..][..stages]);
            commutator(this, before, t_k);
        }
        let mut unperturbed = vec![T::int(0); stages * stages];
        // From the smallest ξ_k to the largest.
        for (index, t_k) in basis.chunks_exact(stages * stages).enumerate().rev() {
            let xi = xi::<T>(index + 1);
            for (sum, &t) in unperturbed.iter_mut().zip(t_k) {
                *sum += xi * t;
            }
        }
        Ok(Gauss {
            stages,
            rule,
            basis,
            unperturbed,
        })
    }

    /// The number s of stages.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Gauss::<f64>::new(3)?.stages(), 3);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn stages(&self) -> usize {
        self.stages
    }

    /// The nodes c_1 < … < c_s in (0, 1).
    ///
    /// c_i + c_{s+1−i} = 1 exactly, as numbers and not only after rounding: c_{s+1−i} is rounded first and
    /// the small one is 1 − c_{s+1−i}, which is representable. Both are therefore accurate to an ulp of 1,
    /// not of c_i; the weights and polynomials are those of the unrounded node.
    ///
    /// ```
    /// let gauss = equip_tableau::Gauss::<f64>::new(5)?;
    /// let c = gauss.nodes();
    /// assert!((0..5).all(|i| c[i] == 1.0 - c[4 - i]));
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn nodes(&self) -> &[T] {
        &self.rule.nodes
    }

    /// The weights b_i = 1 / Σ_{k<s} P_k(c_i)², with b_i = b_{s+1−i} to the last bit and sum 1 up to
    /// rounding.
    ///
    /// ```
    /// let gauss = equip_tableau::Gauss::<f64>::new(3)?;
    /// assert!((gauss.weights()[1] - 4.0 / 9.0).abs() < 1e-16);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn weights(&self) -> &[T] {
        &self.rule.weights
    }

    /// p_k = (P_k(c_1), …, P_k(c_s)) for k = 0 … s − 1; even or odd under i → s + 1 − i to the last bit.
    ///
    /// # Panics
    /// When k ≥ s.
    ///
    /// ```
    /// let gauss = equip_tableau::Gauss::<f64>::new(2)?;
    /// assert_eq!(gauss.legendre(0), [1.0, 1.0]);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn legendre(&self, k: usize) -> &[T] {
        &self.rule.legendre[k * self.stages..(k + 1) * self.stages]
    }

    /// ξ_k = 1/(2√(4k² − 1)) for any k ≥ 1, also beyond s; NaN for k = 0.
    ///
    /// ```
    /// let gauss = equip_tableau::Gauss::<f64>::new(2)?;
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

/// p qᵀ − q pᵀ: the upper triangle computed, the lower one its negative.
fn commutator<T: Float>(p: &[T], q: &[T], t: &mut [T]) {
    let s = p.len();
    for i in 0..s {
        for j in i + 1..s {
            t[i * s + j] = p[i] * q[j] - q[i] * p[j];
        }
    }
    mirror(s, t);
}

/// Makes the lower triangle the negative of the upper one.
pub(crate) fn mirror<T: Float>(s: usize, u: &mut [T]) {
    for i in 0..s {
        for j in i + 1..s {
            u[j * s + i] = -u[i * s + j];
        }
    }
}
