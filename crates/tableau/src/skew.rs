//! K(α) in skew form: A(α) = K(α) B with B = diag(b).
//!
//! $$K(\alpha) = \tfrac12\,\mathbf 1\mathbf 1^T + U(\alpha), \qquad U(\alpha) = \sum_{k=1}^{s-1} (\xi_k + \alpha_k)\,T_k,
//! \qquad T_k = p_k p_{k-1}^T - p_{k-1} p_k^T.$$
//!
//! This is the paper's A = 𝒫 X_s 𝒫⁻¹, eqs. (3)–(6). The inverse 𝒫⁻¹ = 𝒫ᵀB is never formed, and there is an
//! α_k for every k instead of the last one only (docs/adr/0003). The condition b_i a_ij + b_j a_ji = b_i b_j
//! becomes K_ij + K_ji = 1. These identities hold exactly in floating point:
//!
//! | form | exact identity | range |
//! |---|---|---|
//! | U of [`Coefficients::antisymmetric_into`] | U_ji = −U_ij, U_ii = 0 | every finite α |
//! | K of [`Coefficients::matrix_into`] | K_ij + K_ji = 1, K_ii = ½ | \|U_ij\| ≤ 2⁵² |
//! | both | U and K unchanged under (i, j) → (s+1−j, s+1−i): the method is symmetric | as above |
//!
//! Adding ½ to U rounds: K has the absolute accuracy of an ulp of max(1, |U_ij|), U has the relative accuracy
//! of its sum. An integrator that needs the accuracy of U computes K L = ½ Σ_j L_j + U L. Beyond 2⁵² no two
//! numbers of that size add up to 1.
//!
//! Cost: s²/2 multiplications for each α_k ≠ 0. The `_into` forms do not allocate; α = 0 costs a copy.

use crate::coefficients::{Coefficients, Unperturbed, mirror};
use crate::rule::MAX_STAGES;
use equip_scalar::{Float, Pack};
use nalgebra::DMatrix;

impl<T: Float> Coefficients<T> {
    /// T_k, s × s in row-major order, for k = 1 … s − 1. It is exactly antisymmetric.
    ///
    /// # Panics
    /// If the method has no α_k.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(2)?;
    /// let t = gauss.skew_basis(1);
    /// assert_eq!((t[0], t[3], t[1]), (0.0, 0.0, -t[2]));
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn skew_basis(&self, k: usize) -> &[T] {
        let size = self.stages * self.stages;
        assert!(
            (1..=self.alphas()).contains(&k),
            "T_k exists for k = 1..s-1"
        );
        &self.basis[(k - 1) * size..k * size]
    }

    /// K(α), s × s in row-major order; entry k − 1 of `alphas` is α_k.
    ///
    /// # Panics
    /// If `alphas` does not have an entry for each α_k.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(3)?;
    /// let k = gauss.matrix(&[0.1, -2e3]);
    /// assert!((0..9).all(|ij| k[ij] + k[ij % 3 * 3 + ij / 3] == 1.0));
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn matrix(&self, alphas: &[T]) -> Vec<T> {
        let mut k = vec![T::int(0); self.stages * self.stages];
        self.matrix_into(alphas, &mut k);
        k
    }

    /// Writes [`matrix`](Self::matrix) into `k`, without allocation.
    ///
    /// If K is skew, the larger entry ½ + |U_ij| ≥ ½ of each pair is rounded. The smaller entry is 1 minus
    /// the larger one, which is exact.
    ///
    /// # Panics
    /// If `alphas` does not have an entry for each α_k, or `k` does not have s² entries.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(2)?;
    /// let mut k = [0.0; 4];
    /// gauss.matrix_into(&[0.3], &mut k);
    /// assert_eq!((k[0], k[1] + k[2], k[3]), (0.5, 1.0, 0.5));
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn matrix_into(&self, alphas: &[T], k: &mut [T]) {
        if let Unperturbed::Whole(matrix) = &self.unperturbed {
            assert!(alphas.is_empty(), "this method has no alphas");
            k.copy_from_slice(matrix);
            return;
        }
        self.antisymmetric_into(alphas, k);
        let (s, half, one) = (self.stages, T::ratio(1, 2), T::int(1));
        for i in 0..s {
            k[i * s + i] = half;
            for j in i + 1..s {
                let u = k[i * s + j];
                let large = half + u.abs();
                let small = one - large;
                let pair = if u < T::int(0) {
                    (small, large)
                } else {
                    (large, small)
                };
                (k[i * s + j], k[j * s + i]) = pair;
            }
        }
    }

    /// The Moore–Penrose inverse of K(α), s × s in row-major order, in doubles: K⁻¹ if the method has as many
    /// stages as its degree. It costs O(s³) operations and allocates.
    ///
    /// # Panics
    /// If `alphas` does not have an entry for each α_k.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(2)?;
    /// // b_i (A⁻¹)_ij, with the A⁻¹ of Hairer, Wanner, Solving ODEs II, section IV.8
    /// let inverse = gauss.pseudo_inverse(&[0.0]);
    /// assert!((inverse[0] - 1.5).abs() < 1e-14);
    /// assert!((inverse[1] - (3f64.sqrt() - 1.5)).abs() < 1e-14);
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn pseudo_inverse(&self, alphas: &[T]) -> Vec<f64> {
        let (s, k) = (self.stages, self.matrix(alphas));
        let k = DMatrix::from_fn(s, s, |i, j| k[i * s + j].to_f64());
        // The smallest singular value of K is above 1e-2 up to 64 stages, but for zeros.
        let inverse = k
            .pseudo_inverse(1e-9)
            .unwrap_or_else(|_| DMatrix::zeros(s, s));
        inverse.transpose().as_slice().to_vec()
    }

    /// Writes the antisymmetric part U(α) = K(α) − ½, s × s in row-major order, into `u`: U_ji = −U_ij
    /// exactly.
    ///
    /// # Panics
    /// If K is not skew, `alphas` does not have s − 1 entries, or `u` does not have s² entries.
    ///
    /// ```
    /// let gauss = equip_tableau::Coefficients::<f64>::gauss(2)?;
    /// let mut u = [0.0; 4];
    /// gauss.antisymmetric_into(&[1e300], &mut u);
    /// assert_eq!((u[0], u[1]), (0.0, -u[2]));
    /// # Ok::<(), equip_tableau::TableauError>(())
    /// ```
    pub fn antisymmetric_into(&self, alphas: &[T], u: &mut [T]) {
        let s = self.stages;
        let Unperturbed::Skew(unperturbed) = &self.unperturbed else {
            panic!("K is skew of Gauss methods only");
        };
        assert_eq!(alphas.len(), s - 1, "one alpha for each k = 1..s-1");
        assert_eq!(u.len(), s * s, "room for s x s entries");
        let basis = self.basis.chunks_exact(s * s).zip(alphas);
        let moved = basis.filter(|&(_, &alpha)| alpha != T::int(0));
        if T::IS_DOUBLE {
            u.copy_from_slice(unperturbed);
            for (t_k, &alpha) in moved {
                u.iter_mut().zip(t_k).for_each(|(u, &t)| *u += alpha * t);
            }
            return;
        }
        u.fill(T::int(0));
        let mut matrices = [&**unperturbed; MAX_STAGES];
        let mut factors = [T::int(1); MAX_STAGES];
        let mut count = 1;
        for (t_k, &alpha) in moved {
            (matrices[count], factors[count]) = (t_k, alpha);
            count += 1;
        }
        // In other types than `f64` each entry is one dot product.
        for i in 0..s {
            for j in i + 1..s {
                let term = |k: usize| T::Pack::<1>::of(&[matrices[k][i * s + j]]);
                [u[i * s + j]] = T::Pack::dot(term, &factors[..count]).numbers();
            }
        }
        mirror(s, u);
    }
}
