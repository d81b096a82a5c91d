//! What is known of H before any number is put in.

use crate::colouring::Colouring;
use crate::graph::Graph;
use crate::sparsity;
use std::fmt;
use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

/// Structural non-zeros of a symmetric matrix, row by row: both triangles, columns ascending in each row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// Entries of row i stand at `row_starts[i]..row_starts[i + 1]`; length n + 1.
    pub row_starts: Vec<usize>,
    /// Column of each entry.
    pub columns: Vec<usize>,
}

impl Pattern {
    /// Every entry of an n×n matrix.
    pub fn dense(n: usize) -> Self {
        Pattern {
            row_starts: (0..=n).map(|i| i * n).collect(),
            columns: (0..n * n).map(|k| k % n).collect(),
        }
    }

    /// Rows (and columns) of the matrix.
    pub fn dimension(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Number of structural non-zeros.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether the matrix is identically zero.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Groups of columns no two of which have a row in common, with every column that has entries in one of
    /// them: all columns of a group can be computed from one direction (Curtis, Powell, Reid 1974).
    pub fn column_groups(&self) -> Vec<Vec<usize>> {
        let Colouring { colours, of_column } = Colouring::new(self);
        let mut groups = vec![Vec::new(); colours];
        for (column, colour) in of_column.into_iter().enumerate() {
            if let Some(colour) = colour {
                groups[colour].push(column);
            }
        }
        groups
    }

    /// Positions (in the order of the entries) and columns of row i.
    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (usize, usize)> + '_ {
        let range = self.row_starts[i]..self.row_starts[i + 1];
        range.clone().zip(self.columns[range].iter().copied())
    }
}

/// The pattern of ∇²H, found when it is first asked for: of n bodies it has n² entries. It is a [`Pattern`]
/// by dereference.
#[derive(Clone)]
pub struct HessianPattern {
    energy: Arc<Graph>,
    found: Arc<OnceLock<Pattern>>,
}

impl HessianPattern {
    pub(crate) fn new(energy: Arc<Graph>) -> Self {
        HessianPattern {
            energy,
            found: Arc::default(),
        }
    }

    /// Rows (and columns) of the matrix, without finding the pattern.
    pub fn dimension(&self) -> usize {
        self.energy.inputs
    }

    /// A copy of the pattern.
    pub fn to_pattern(&self) -> Pattern {
        (**self).clone()
    }

    /// The block of these rows and columns, counted from 0, without finding the rest.
    pub(crate) fn block(&self, variables: Range<usize>) -> Pattern {
        sparsity::hessian_pattern(&self.energy, variables)
    }
}

impl Deref for HessianPattern {
    type Target = Pattern;

    fn deref(&self) -> &Pattern {
        self.found.get_or_init(|| self.block(0..self.dimension()))
    }
}

impl PartialEq for HessianPattern {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for HessianPattern {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("HessianPattern")
            .field("dimension", &self.dimension())
            .field("found", &self.found.get())
            .finish()
    }
}

/// Facts about H read off its recording; each one that cannot be proved is absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// Degrees of freedom m; the state has 2m components.
    pub degrees_of_freedom: usize,
    /// H = T(p) + U(q).
    pub separable: bool,
    /// Degree of H as a polynomial in (q, p) together; `None` if it is not known to be one.
    pub degree: Option<u32>,
    /// Degree in q with p held fixed.
    pub degree_in_q: Option<u32>,
    /// Degree in p with q held fixed.
    pub degree_in_p: Option<u32>,
    /// Entries of ∇²H that can be non-zero.
    pub hessian: HessianPattern,
}

impl Structure {
    /// H has degree at most 2: every Gauss method keeps it, and no α is needed.
    pub fn is_quadratic(&self) -> bool {
        self.degree.is_some_and(|d| d <= 2)
    }
}
