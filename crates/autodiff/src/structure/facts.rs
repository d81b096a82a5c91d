//! [`Structure`]: the properties of H that hold at every state.

use super::pattern::Pattern;
use std::fmt;
use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

/// The pattern of ∇²H, computed on first use: for n bodies it has n² entries. It dereferences to a
/// [`Pattern`].
#[derive(Clone)]
pub struct HessianPattern {
    dimension: usize,
    /// Computes the diagonal block with these rows and columns.
    block: Arc<dyn Fn(Range<usize>) -> Pattern + Send + Sync>,
    found: Arc<OnceLock<Pattern>>,
}

impl HessianPattern {
    /// A pattern with n rows, given a function that computes its diagonal blocks.
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

    /// The pattern of a matrix that may have all n² entries.
    pub(crate) fn full(dimension: usize) -> Self {
        Self::new(dimension, |rows| Pattern::full(rows.len()))
    }

    /// The pattern of diag(∇²U, M⁻¹) with a ∇²U that may have all m² entries and a diagonal M.
    pub(crate) fn of_potential(m: usize) -> Self {
        Self::new(2 * m, move |rows| {
            let row = |i: usize| if i < m { 0..m } else { i..i + 1 };
            let inside = |i: usize| row(i).filter(|j| rows.contains(j)).map(|j| j - rows.start);
            let columns: Vec<usize> = rows.clone().flat_map(inside).collect();
            let lengths = rows.clone().scan(0, |sum, i| {
                *sum += inside(i).count();
                Some(*sum)
            });
            let row_starts = std::iter::once(0).chain(lengths).collect();
            Pattern {
                row_starts,
                columns,
            }
        })
    }

    /// The number of rows (and columns) of the matrix, without computing the pattern.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// A copy of the pattern.
    pub fn to_pattern(&self) -> Pattern {
        (**self).clone()
    }

    /// The diagonal block with these rows and columns, counted from 0, without computing the rest.
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

/// Properties of H read from its trace. A property that cannot be proved is absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// The number m of degrees of freedom; the state has 2m components.
    pub degrees_of_freedom: usize,
    /// Whether H = T(p) + U(q).
    pub separable: bool,
    /// The degree of H as a polynomial in (q, p) together; `None` if it is not known to be a polynomial.
    pub degree: Option<u32>,
    /// The degree in q with p fixed.
    pub degree_in_q: Option<u32>,
    /// The degree in p with q fixed.
    pub degree_in_p: Option<u32>,
    /// The entries of ∇²H that can be non-zero.
    pub hessian: HessianPattern,
}

impl Structure {
    /// Whether H has degree at most 2. Every Gauss method then conserves H, and no α is needed.
    pub fn is_quadratic(&self) -> bool {
        self.degree.is_some_and(|d| d <= 2)
    }
}
