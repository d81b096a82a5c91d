//! Right-hand sides as preconditioners solve for them: stage by stage, in doubles and in units of the state.

use equip_iterate::Held;
use equip_scalar::Float;

/// How the stages of the unknown components lie, and the units they are measured in.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    pub(crate) s: usize,
    pub(crate) stride: usize,
    /// Components n = 2m of the state.
    pub(crate) n: usize,
    /// Size of each component.
    pub(crate) units: Vec<f64>,
}

impl Rows {
    /// Component c of stage i at `i·n + c` in units of the state, divided by the largest, which is returned;
    /// zero where a component is not unknown. Where the end is held the stages stand in reverse order: −Kᵀ is
    /// K of the step made backwards. `None` leaves nothing to solve.
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

    /// What [`gather`](Self::gather) has taken, put back.
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
