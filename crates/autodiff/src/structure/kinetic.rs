//! [`Kinetic`]: the quadratic T(p) of a separable H = T(p) + U(q), as numbers.
//!
//! T(p) = ½ pᵀ M⁻¹ p + bᵀ p + const, so ∇T(p) = M⁻¹ p + b needs no differentiation. Iterations with the
//! positions as the only unknowns use it. M⁻¹ is read from ∇²H, whose lower right block is constant, and b
//! from ∇H at p = 0.

use crate::Structure;
use crate::structure::colouring::Colouring;
use equip_scalar::Float;

/// M⁻¹ and b of T(p) = ½ pᵀ M⁻¹ p + bᵀ p + const.
#[derive(Debug, Clone, PartialEq)]
pub struct Kinetic<T> {
    shape: Shape<T>,
    offset: Vec<T>,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape<T> {
    Diagonal(Vec<T>),
    /// The entries of row i are at `row_starts[i]..row_starts[i + 1]`.
    Sparse {
        row_starts: Vec<usize>,
        entries: Vec<(usize, T)>,
    },
}

impl<T: Float> Kinetic<T> {
    /// For a separable H with a quadratic T, from ∇H and ∇²H·v at the origin, with one v for each colour of
    /// ∇²T. `None` if one of these is not finite.
    pub(crate) fn new(
        structure: &Structure,
        mut gradient: Vec<T>,
        mut hessian_vector: impl FnMut(&[T], &mut [T]),
    ) -> Option<Self> {
        let m = structure.degrees_of_freedom;
        let offset = gradient.split_off(m);
        let pattern = structure.hessian.block(m..2 * m);
        let mut entries = vec![T::int(0); pattern.len()];
        let (mut whole, mut row) = (vec![T::int(0); 2 * m], vec![T::int(0); 2 * m]);
        let product_into = |v: &[T], product: &mut [T]| {
            whole[m..].copy_from_slice(v);
            hessian_vector(&whole, &mut row);
            product.copy_from_slice(&row[m..]);
        };
        Colouring::new(&pattern).entries(&pattern, product_into, &mut entries);
        let columns = pattern.columns.iter().copied();
        let entries: Vec<(usize, T)> = columns.zip(entries).collect();
        let row_starts = pattern.row_starts;
        let finite = |x: &T| x.is_finite();
        if !offset.iter().all(finite) || !entries.iter().all(|(_, x)| finite(x)) {
            return None;
        }
        let is_diagonal = entries.len() == m && entries.iter().map(|e| e.0).eq(0..m);
        let shape = if is_diagonal {
            Shape::Diagonal(entries.into_iter().map(|e| e.1).collect())
        } else {
            Shape::Sparse {
                row_starts,
                entries,
            }
        };
        Some(Kinetic { shape, offset })
    }

    /// T(p) = ½ Σ_c w_c p_c², with the w_c of the iterator.
    pub(crate) fn diagonal_of(inverse_masses: impl Iterator<Item = T>) -> Self {
        let diagonal: Vec<T> = inverse_masses.collect();
        let offset = vec![T::int(0); diagonal.len()];
        Kinetic {
            shape: Shape::Diagonal(diagonal),
            offset,
        }
    }

    /// The diagonal of M⁻¹, if all other entries are zero.
    pub fn diagonal(&self) -> Option<&[T]> {
        match &self.shape {
            Shape::Diagonal(diagonal) => Some(diagonal),
            Shape::Sparse { .. } => None,
        }
    }

    /// b.
    pub fn offset(&self) -> &[T] {
        &self.offset
    }

    /// Columns and values of row i of M⁻¹.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, T)> + '_ {
        let (diagonal, sparse) = match &self.shape {
            Shape::Diagonal(diagonal) => (Some((i, diagonal[i])), [].as_slice()),
            Shape::Sparse {
                row_starts,
                entries,
            } => (None, &entries[row_starts[i]..row_starts[i + 1]]),
        };
        diagonal.into_iter().chain(sparse.iter().copied())
    }

    /// Writes ∇T(p) = M⁻¹ p + b to `velocity`, both of length m.
    pub fn velocity(&self, p: &[T], velocity: &mut [T]) {
        self.velocities_by_component(p, velocity, 1);
    }

    /// ∇T at `stride` points: component c of point i is at `c·stride + i`.
    #[inline]
    pub fn velocities_by_component(&self, p: &[T], velocities: &mut [T], stride: usize) {
        let rows = velocities.chunks_exact_mut(stride).zip(&self.offset);
        match &self.shape {
            Shape::Diagonal(diagonal) => {
                for (((v, &b), p), &w) in rows.zip(p.chunks_exact(stride)).zip(diagonal) {
                    for (v, &p) in v.iter_mut().zip(p) {
                        *v = w * p + b;
                    }
                }
            }
            Shape::Sparse {
                row_starts,
                entries,
            } => {
                for ((v, &b), range) in rows.zip(row_starts.windows(2)) {
                    v.fill(b);
                    for &(column, w) in &entries[range[0]..range[1]] {
                        let p = &p[column * stride..][..stride];
                        for (v, &p) in v.iter_mut().zip(p) {
                            *v += w * p;
                        }
                    }
                }
            }
        }
    }
}
