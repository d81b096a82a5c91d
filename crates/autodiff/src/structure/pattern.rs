//! [`Pattern`]: the sparsity pattern of a symmetric matrix.

/// Structural non-zeros of a symmetric matrix, row by row: both triangles, columns ascending in each row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// The entries of row i are at `row_starts[i]..row_starts[i + 1]`; length n + 1.
    pub row_starts: Vec<usize>,
    /// The column of each entry.
    pub columns: Vec<usize>,
}

impl Pattern {
    /// The pattern of a matrix that may have all n² entries.
    pub(crate) fn full(n: usize) -> Self {
        Pattern {
            row_starts: (0..=n).map(|i| i * n).collect(),
            columns: (0..n * n).map(|k| k % n).collect(),
        }
    }

    /// The number of rows (and columns) of the matrix.
    pub fn dimension(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// The number of structural non-zeros.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether the matrix is identically zero.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The index of an entry in the order of the entries, if it is in the pattern.
    pub(crate) fn place(&self, row: usize, column: usize) -> Option<usize> {
        let start = self.row_starts[row];
        let columns = &self.columns[start..self.row_starts[row + 1]];
        columns.binary_search(&column).ok().map(|k| start + k)
    }

    /// Indices (in the order of the entries) and columns of row i.
    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (usize, usize)> + '_ {
        let range = self.row_starts[i]..self.row_starts[i + 1];
        range.clone().zip(self.columns[range].iter().copied())
    }
}
