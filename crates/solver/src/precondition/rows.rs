//! Right-hand sides in the layout of the preconditioners: stage by stage, in `f64`, scaled by the sizes of
//! the components.

use equip_iterate::Held;
use equip_scalar::Float;

/// The layout of the stages, and the units of the components.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    pub(crate) s: usize,
    pub(crate) stride: usize,
    /// The number of components for which the preconditioner solves.
    pub(crate) n: usize,
    /// The size of each component.
    pub(crate) units: Vec<f64>,
}

impl Rows {
    /// Writes component c of stage i, in its unit, to `out` at `i·n + c`, divided by the largest entry.
    /// Components that are not unknowns are zero. If the end is held, the stages are in reverse order, since
    /// −Kᵀ is K of the reversed step. Returns the largest entry; `None` if all entries are zero or one is not
    /// finite.
    pub(crate) fn gather<T: Float>(&self, held: Held, rows: &[T], out: &mut [f64]) -> Option<T> {
        let unknown = rows.len() / self.stride;
        let mut size = T::int(0);
        for c in 0..unknown {
            let row = &rows[c * self.stride..][..self.s];
            let unit = T::exact(self.units[c]);
            size = row.iter().fold(size, |a, &x| a.max((x / unit).abs()));
        }
        if size == T::int(0) || !size.is_finite() {
            return None;
        }
        out.fill(0.0);
        for c in 0..unknown {
            let row = &rows[c * self.stride..][..self.s];
            let unit = T::exact(self.units[c]);
            for (i, &x) in row.iter().enumerate() {
                out[self.place(held, i) * self.n + c] = (x / unit / size).to_f64();
            }
        }
        Some(size)
    }

    /// Writes the entries back, in the order of [`gather`](Self::gather).
    pub(crate) fn scatter<T: Float>(&self, held: Held, from: &[f64], size: T, rows: &mut [T]) {
        let unknown = rows.len() / self.stride;
        for c in 0..unknown {
            let unit = size * T::exact(self.units[c]);
            let row = &mut rows[c * self.stride..][..self.s];
            for (i, x) in row.iter_mut().enumerate() {
                *x = T::exact(from[self.place(held, i) * self.n + c]) * unit;
            }
        }
    }

    fn place(&self, held: Held, i: usize) -> usize {
        match held {
            Held::Start => i,
            Held::End => self.s - 1 - i,
        }
    }
}
