//! Placeholders without the feature `sparse`: no pattern is accepted, so all factorisations are dense.

use crate::dense_lu::Singular;
use nalgebra::Complex;
use std::convert::Infallible;

/// The pattern of a sparse matrix; has no values.
#[derive(Debug)]
pub struct Symbolic(Infallible);

/// The factors of a sparse matrix; never computed.
#[derive(Debug)]
pub struct SparseLu;

impl Symbolic {
    /// `None`.
    pub fn new(_column_starts: Vec<usize>, _rows: Vec<usize>) -> Option<Self> {
        None
    }

    /// The number of rows of the matrix.
    pub fn dimension(&self) -> usize {
        match self.0 {}
    }

    /// Number of structural non-zeros.
    pub fn non_zeros(&self) -> usize {
        match self.0 {}
    }

    /// Factorises the matrix with the given entries.
    pub fn factor(
        &mut self,
        _lu: &mut SparseLu,
        _entries: &[Complex<f64>],
    ) -> Result<(), Singular> {
        match self.0 {}
    }

    /// x ← A⁻¹ x.
    pub fn solve(&mut self, _lu: &SparseLu, _x: &mut [Complex<f64>]) {
        match self.0 {}
    }
}

impl SparseLu {
    /// For matrices of n rows.
    pub fn new(_n: usize) -> Self {
        SparseLu
    }
}
