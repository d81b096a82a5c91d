//! [`Structure`]: what is known of H before any number is put in.

use super::pattern::Pattern;
use std::fmt;
use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

/// The pattern of ∇²H, found at the first request: of n bodies it has n² entries. It is a [`Pattern`]
/// by dereference.
#[derive(Clone)]
pub struct HessianPattern {
    dimension: usize,
    /// The block of these rows and columns.
    block: Arc<dyn Fn(Range<usize>) -> Pattern + Send + Sync>,
    found: Arc<OnceLock<Pattern>>,
}

impl HessianPattern {
    /// Of n rows, by what finds a block of them.
    pub(crate) fn new(
        dimension: usize,
        block: impl Fn(Range<usize>) -> Pattern + Send + Sync + 'static,
    ) -> Self {
        HessianPattern {
            dimension,
            block: Arc::new(block),
            found: Arc::default(),
        }
    }

    /// Of a matrix that may have all n² entries.
    pub(crate) fn full(dimension: usize) -> Self {
        Self::new(dimension, |rows| Pattern::full(rows.len()))
    }

    /// Rows (and columns) of the matrix, without finding the pattern.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// A copy of the pattern.
    pub fn to_pattern(&self) -> Pattern {
        (**self).clone()
    }

    /// The block of these rows and columns, counted from 0, without finding the rest.
    pub(crate) fn block(&self, variables: Range<usize>) -> Pattern {
        (self.block)(variables)
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
