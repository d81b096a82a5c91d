//! Sparse LU factorisation of complex matrices with a common pattern, by the simplicial elimination of faer.
//!
//! COLAMD orders the columns once, for little fill with any pivots; rows are exchanged by partial pivoting.
//! Cost for a chain or ring of n sites: proportional to n, in time and memory. The first factorisation
//! allocates the factors. A later one allocates only if other pivots need more fill.

use crate::dense_lu::Singular;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::PermRef;
use faer::sparse::linalg::colamd;
use faer::sparse::linalg::lu::simplicial::{self, SimplicialLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use nalgebra::Complex;

/// The pattern by columns and the order of the columns, common to all matrices of a run.
#[derive(Debug)]
pub struct Symbolic {
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    order: Vec<usize>,
    order_inverse: Vec<usize>,
    memory: Memory,
}

/// Workspace of faer.
struct Memory(MemBuffer);

impl std::fmt::Debug for Memory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Memory")
    }
}

/// Row exchanges and factors of one matrix.
#[derive(Debug)]
pub struct SparseLu {
    row_order: Vec<usize>,
    row_order_inverse: Vec<usize>,
    lu: SimplicialLu<usize, Complex<f64>>,
}

impl Symbolic {
    /// Rows ascend within each column. `None` if there is not enough memory.
    pub fn new(column_starts: Vec<usize>, rows: Vec<usize>) -> Option<Self> {
        let n = column_starts.len() - 1;
        let (mut order, mut order_inverse) = (vec![0; n], vec![0; n]);
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &column_starts, None, &rows);
        let mut ordering =
            MemBuffer::try_new(colamd::order_scratch::<usize>(n, n, rows.len())).ok()?;
        colamd::order(
            &mut order,
            &mut order_inverse,
            pattern,
            colamd::Control::default(),
            MemStack::new(&mut ordering),
        )
        .ok()?;
        let needed = StackReq::any_of(&[
            simplicial::factorize_simplicial_numeric_lu_scratch::<usize, Complex<f64>>(n, n),
            simplicial::solve_in_place_scratch::<usize, Complex<f64>>(n, 1, Par::Seq),
        ]);
        Some(Symbolic {
            column_starts,
            rows,
            order,
            order_inverse,
            memory: Memory(MemBuffer::try_new(needed).ok()?),
        })
    }

    /// The number of rows of the matrix.
    pub fn dimension(&self) -> usize {
        self.order.len()
    }

    /// Number of structural non-zeros.
    pub fn non_zeros(&self) -> usize {
        self.rows.len()
    }

    /// Factorises the matrix with the given entries, column by column.
    pub fn factor(&mut self, lu: &mut SparseLu, entries: &[Complex<f64>]) -> Result<(), Singular> {
        let n = self.dimension();
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &self.column_starts, None, &self.rows);
        simplicial::factorize_simplicial_numeric_lu(
            &mut lu.row_order,
            &mut lu.row_order_inverse,
            &mut lu.lu,
            SparseColMatRef::new(pattern, entries),
            PermRef::new_checked(&self.order, &self.order_inverse, n),
            MemStack::new(&mut self.memory.0),
        )
        .map_err(|_| Singular)?;
        // A pivot that is zero or not finite is not reported.
        let u = lu.lu.u_factor_unsorted();
        let regular = (0..n).all(|j| {
            let pivot = u.val_of_col(j).last();
            pivot.is_some_and(|x| x.re.is_finite() && x.im.is_finite() && x.norm_sqr() != 0.0)
        });
        if regular { Ok(()) } else { Err(Singular) }
    }

    /// x ← A⁻¹ x.
    pub fn solve(&mut self, lu: &SparseLu, x: &mut [Complex<f64>]) {
        let n = self.dimension();
        let rows = PermRef::new_checked(&lu.row_order, &lu.row_order_inverse, n);
        let columns = PermRef::new_checked(&self.order, &self.order_inverse, n);
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        let stack = MemStack::new(&mut self.memory.0);
        lu.lu
            .solve_in_place_with_conj(rows, columns, Conj::No, x, Par::Seq, stack);
    }
}

impl SparseLu {
    /// For matrices of n rows.
    pub fn new(n: usize) -> Self {
        SparseLu {
            row_order: vec![0; n],
            row_order_inverse: vec![0; n],
            lu: SimplicialLu::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring: 4 on the diagonal, −1 − i/2 above, 1 below, both closed around the corner.
    fn ring(n: usize) -> (Vec<usize>, Vec<usize>, Vec<Complex<f64>>) {
        let (mut starts, mut rows, mut entries) = (vec![0], vec![], vec![]);
        for j in 0..n {
            let mut column = [
                ((j + n - 1) % n, Complex::new(-1.0, -0.5)),
                (j, Complex::new(4.0, 0.0)),
                ((j + 1) % n, Complex::new(1.0, 0.0)),
            ];
            column.sort_by_key(|x| x.0);
            rows.extend(column.iter().map(|x| x.0));
            entries.extend(column.iter().map(|x| x.1));
            starts.push(rows.len());
        }
        (starts, rows, entries)
    }

    #[test]
    fn solves_a_ring() {
        let n = 100;
        let (starts, rows, entries) = ring(n);
        let x: Vec<_> = (0..n)
            .map(|j| Complex::new(j as f64, 1.0 - j as f64 / 7.0))
            .collect();
        let mut ax = vec![Complex::new(0.0, 0.0); n];
        for j in 0..n {
            for k in starts[j]..starts[j + 1] {
                ax[rows[k]] += entries[k] * x[j];
            }
        }
        let mut symbolic = Symbolic::new(starts, rows).unwrap();
        let mut lu = SparseLu::new(n);
        symbolic.factor(&mut lu, &entries).unwrap();
        symbolic.solve(&lu, &mut ax);
        let error = ax.iter().zip(&x).map(|(b, x)| (b - x).norm());
        assert!(error.fold(0.0, f64::max) < 1e-12);
    }

    #[test]
    fn names_a_singular_matrix() {
        let (starts, rows, entries) = ring(100);
        let mut symbolic = Symbolic::new(starts, rows).unwrap();
        let zero = vec![Complex::new(0.0, 0.0); entries.len()];
        let mut lu = SparseLu::new(100);
        assert_eq!(symbolic.factor(&mut lu, &zero), Err(Singular));
    }
}
