//! [`Tableau`]: the coefficients of any Runge–Kutta method.

use crate::coefficients::Coefficients;
use crate::error::TableauError;
use equip_scalar::Float;

/// A Runge–Kutta method: Y_i = y_0 + h Σ_j a_ij f(Y_j), y_1 = y_0 + h Σ_i b_i f(Y_i).
///
/// ```
/// use equip_tableau::{Tableau, order};
/// assert_eq!(order(&Tableau::<f64>::classic(), 1e-12), 4);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tableau<T> {
    /// A, s × s in row-major order: a_ij is `a[i * s + j]`.
    pub a: Vec<T>,
    /// The s weights.
    pub b: Vec<T>,
    /// The s nodes.
    pub c: Vec<T>,
}

impl<T: Float> Tableau<T> {
    /// The method with the given A (s × s, row-major) and b, and c_i = Σ_j a_ij.
    ///
    /// # Errors
    /// [`TableauError::ShapeMismatch`] when A does not have s² entries for the s entries of b.
    ///
    /// ```
    /// use equip_tableau::Tableau;
    /// let heun = Tableau::new(vec![0.0, 0.0, 1.0, 0.0], vec![0.5, 0.5])?;
    /// assert_eq!(heun.c, [0.0, 1.0]);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn new(a: Vec<T>, b: Vec<T>) -> Result<Self, TableauError> {
        let s = b.len();
        if s == 0 || a.len() != s * s {
            return Err(TableauError::ShapeMismatch {
                entries: a.len(),
                stages: s,
            });
        }
        let c = a.chunks_exact(s).map(sum).collect();
        Ok(Tableau { a, b, c })
    }

    /// The number s of stages.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Tableau::<f64>::classic().stages(), 4);
    /// ```
    pub fn stages(&self) -> usize {
        self.b.len()
    }

    /// Row i of A, counted from 0.
    ///
    /// # Panics
    /// If i ≥ s.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Tableau::<f64>::trapezoidal().row(1), [0.5, 0.5]);
    /// ```
    pub fn row(&self, i: usize) -> &[T] {
        &self.a[i * self.stages()..(i + 1) * self.stages()]
    }

    /// A v for a stage vector v of s entries.
    pub(crate) fn apply(&self, v: &[T]) -> Vec<T> {
        self.a
            .chunks_exact(self.stages())
            .map(|row| dot(row, v))
            .collect()
    }

    /// The explicit Euler method: order 1, neither symmetric nor symplectic.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Tableau::<f64>::explicit_euler().a, [0.0]);
    /// ```
    pub fn explicit_euler() -> Self {
        Self::from_ratios(&[(0, 1)], &[(1, 1)])
    }

    /// The trapezoidal rule (Lobatto IIIA with two stages): order 2, symmetric, not symplectic.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Tableau::<f64>::trapezoidal().c, [0.0, 1.0]);
    /// ```
    pub fn trapezoidal() -> Self {
        Self::from_ratios(&[(0, 1), (0, 1), (1, 2), (1, 2)], &[(1, 2), (1, 2)])
    }

    /// Radau IIA with two stages: order 3, neither symmetric nor symplectic.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Tableau::<f64>::radau_iia().c[1], 1.0);
    /// ```
    pub fn radau_iia() -> Self {
        Self::from_ratios(&[(5, 12), (-1, 12), (3, 4), (1, 4)], &[(3, 4), (1, 4)])
    }

    /// The classic Runge–Kutta method (Kutta 1901): order 4, explicit.
    ///
    /// ```
    /// assert_eq!(equip_tableau::Tableau::<f64>::classic().c, [0.0, 0.5, 0.5, 1.0]);
    /// ```
    pub fn classic() -> Self {
        let (zero, half, one) = ((0, 1), (1, 2), (1, 1));
        Self::from_ratios(
            &[
                [zero, zero, zero, zero],
                [half, zero, zero, zero],
                [zero, half, zero, zero],
                [zero, zero, one, zero],
            ]
            .concat(),
            &[(1, 6), (1, 3), (1, 3), (1, 6)],
        )
    }

    fn from_ratios(a: &[(i64, i64)], b: &[(i64, i64)]) -> Self {
        let numbers = |ratios: &[(i64, i64)]| -> Vec<T> {
            ratios.iter().map(|&(n, d)| T::ratio(n, d)).collect()
        };
        let (a, b) = (numbers(a), numbers(b));
        let c = a.chunks_exact(b.len()).map(sum).collect();
        Tableau { a, b, c }
    }
}

impl<T: Float> Coefficients<T> {
    /// The method A(α) = K(α) B with its b and c. Entry k − 1 of `alphas` is α_k. If all are zero, it is the
    /// unperturbed method.
    ///
    /// For a Gauss method A(α) is symplectic and symmetric at any fixed α. Its order is 2s for α = 0, else 2k
    /// for the first α_k ≠ 0. The c_i are the Gauss nodes; they are the row sums of A only if α_1 = 0.
    ///
    /// # Panics
    /// If `alphas` does not have an entry for each α_k.
    ///
    /// ```
    /// use equip_tableau::{Coefficients, order};
    /// let gauss = Coefficients::<f64>::gauss(3)?;
    /// assert_eq!(order(&gauss.tableau(&[0.0, 0.0]), 1e-12), 6);
    /// assert_eq!(order(&gauss.tableau(&[0.0, 0.1]), 1e-12), 4);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn tableau(&self, alphas: &[T]) -> Tableau<T> {
        let mut a = self.matrix(alphas);
        let b = self.weights().to_vec();
        for row in a.chunks_exact_mut(b.len()) {
            for (a_ij, &b_j) in row.iter_mut().zip(&b) {
                *a_ij *= b_j;
            }
        }
        Tableau {
            a,
            b,
            c: self.nodes().to_vec(),
        }
    }
}

/// Σ x_i.
fn sum<T: Float>(x: &[T]) -> T {
    x.iter().fold(T::int(0), |sum, &x| sum + x)
}

/// Σ x_i y_i.
pub(crate) fn dot<T: Float>(x: &[T], y: &[T]) -> T {
    x.iter().zip(y).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}
