//! Dense LU factorisation in place, by the elimination steps of nalgebra. Only the first one allocates.

use nalgebra::linalg::{gauss_step, gauss_step_swap};
use nalgebra::{ComplexField, DMatrix, DVector};

/// The matrix has no usable pivot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Singular;

/// P A = L U with partial pivoting; cost 2/3 N³ operations, each solve 2 N².
#[derive(Debug)]
pub struct DenseLu<T: ComplexField> {
    matrix: DMatrix<T>,
    pivots: Vec<usize>,
}

impl<T: ComplexField + Copy> DenseLu<T> {
    /// For matrices with `dimension` rows.
    pub fn new(dimension: usize) -> Self {
        DenseLu {
            matrix: DMatrix::zeros(dimension, dimension),
            pivots: vec![0; dimension],
        }
    }

    /// The matrix to be filled before [`factor`](Self::factor), which overwrites it.
    pub fn matrix_mut(&mut self) -> &mut DMatrix<T> {
        &mut self.matrix
    }

    /// # Errors
    /// [`Singular`] if there is no pivot.
    pub fn factor(&mut self) -> Result<(), Singular> {
        let a = &mut self.matrix;
        for i in 0..a.nrows() {
            let pivot = i + a.view_range(i.., i).icamax();
            let diagonal = a[(pivot, i)];
            if diagonal == T::zero() || !diagonal.is_finite() {
                return Err(Singular);
            }
            self.pivots[i] = pivot;
            if pivot == i {
                gauss_step(a, diagonal, i);
            } else {
                a.columns_range_mut(..i).swap_rows(i, pivot);
                gauss_step_swap(a, diagonal, i, pivot);
            }
        }
        Ok(())
    }

    /// x ← A⁻¹ x.
    pub fn solve(&self, x: &mut DVector<T>) {
        for (i, &pivot) in self.pivots.iter().enumerate() {
            x.swap_rows(i, pivot);
        }
        self.matrix
            .solve_lower_triangular_with_diag_mut(x, T::one());
        self.matrix.solve_upper_triangular_mut(x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_system() {
        let a = DMatrix::from_row_slice(3, 3, &[0.0, 2.0, 1.0, 4.0, -1.0, 0.5, 1.0, 3.0, -2.0]);
        let mut lu = DenseLu::new(3);
        lu.matrix_mut().copy_from(&a);
        lu.factor().unwrap();
        let x = DVector::from_vec(vec![1.0, -2.0, 3.0]);
        let mut b = &a * &x;
        lu.solve(&mut b);
        assert!((b - &x).amax() < 1e-14);
    }

    #[test]
    fn names_a_singular_matrix() {
        let mut lu = DenseLu::<f64>::new(2);
        lu.matrix_mut().fill(1.0);
        assert_eq!(lu.factor(), Err(Singular));
    }
}
