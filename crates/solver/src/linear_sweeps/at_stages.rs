//! ∇²H at the stages, for the linearised sweeps.
//!
//! In `f64` as quotients of differences of ∇H, all stages at once, one for each group of columns that do not meet: right to √ε, or to ε^(2/3) for
//! twice the price, which is enough for what only has to point the right way. In wider numbers itself, stage by stage.
//!
//! Cost: a gradient at all stages for each group of columns, two of the accurate kind; or s Hessians.

use super::LinearSweeps;
use crate::outcome::Counts;
use crate::sweep::Iterate;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;

/// A column of ∇²H, with its entries on and above the diagonal: row, place, and place of the mirror image.
#[derive(Debug)]
pub(super) struct Column {
    c: usize,
    entries: Vec<(usize, usize, usize)>,
}

impl Column {
    pub(super) fn of(pattern: &Pattern, c: usize) -> Self {
        // Row c has the rows of column c.
        let rows = pattern.row(c).take_while(|&(_, row)| row <= c);
        let entries = rows.filter_map(|(mirrored, row)| {
            let (entry, _) = pattern.row(row).find(|&(_, column)| column == c)?;
            Some((row, entry, mirrored))
        });
        Column {
            c,
            entries: entries.collect(),
        }
    }
}

impl<T: Float> LinearSweeps<T> {
    /// Takes ∇²H at the stages of an iterate that has converged, in `f64` by `accurate` differences or simple ones. Returns whether it is finite.
    pub(crate) fn take<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        accurate: bool,
        counts: &mut Counts,
    ) -> bool {
        self.is_accurate = accurate;
        if T::IS_DOUBLE {
            self.take_quotients(iterate, energy, counts);
        } else {
            self.take_exactly(iterate, energy, counts);
        }
        let mut sum = T::int(0);
        for entry in self.entries.chunks_exact_mut(self.stride) {
            for (x, &hb) in entry.iter_mut().zip(&*iterate.hb) {
                *x *= hb;
                sum += *x;
            }
        }
        sum.is_finite()
    }

    /// How well ∇²H is known, and so all that is solved for: √ε, or ε^(2/3) by central differences; 0 if to rounding.
    pub(crate) fn accuracy(&self) -> T {
        if !T::IS_DOUBLE {
            T::int(0)
        } else if self.is_accurate {
            T::EPSILON.cbrt() * T::EPSILON.cbrt()
        } else {
            T::EPSILON.sqrt() / T::int(16)
        }
    }

    /// ∇²H at the stages one by one: of wide numbers quotients would lose a third of the digits, and with them the α's of the step made backwards.
    fn take_exactly<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        counts: &mut Counts,
    ) {
        let (s, stride) = (self.s, self.stride);
        counts.hessians += s as u64;
        for i in 0..s {
            for (c, x) in self.state.iter_mut().enumerate() {
                *x = iterate.points[c * stride + i];
            }
            energy.hessian(&self.state, &mut self.hessian);
            let places = self.entries.chunks_exact_mut(stride);
            for (entry, &x) in places.zip(&self.hessian) {
                entry[i] = x;
            }
        }
    }

    fn take_quotients<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        counts: &mut Counts,
    ) {
        let (s, stride) = (self.s, self.stride);
        self.entries.fill(T::int(0));
        let rows = match &iterate.kinetic {
            // T is known: what is left are the forces.
            Some(kinetic) => {
                let weights = kinetic.diagonal().unwrap_or_default();
                for (c, &w) in weights.iter().enumerate() {
                    for (entry, column) in self.pattern.row(self.m + c) {
                        if column == self.m + c {
                            self.entries[entry * stride..][..s].fill(w);
                        }
                    }
                }
                self.m
            }
            None => 2 * self.m,
        };
        let len = rows * stride;
        let mut evaluate = |points: &[T], gradients: &mut [T]| {
            counts.gradients += s as u64;
            match iterate.kinetic {
                Some(_) => energy.forces_by_component(points, gradients, stride, s),
                None => energy.gradients_by_component(points, gradients, stride, s),
            }
        };
        self.points[..len].copy_from_slice(&iterate.points[..len]);
        // The gradients that others are compared with: at the stages themselves, or to the other side of them.
        if !self.is_accurate {
            evaluate(&self.points[..len], &mut self.beside[..len]);
        }
        let eps = T::EPSILON;
        let step = if self.is_accurate {
            eps.cbrt()
        } else {
            eps.sqrt()
        };
        for group in &self.groups {
            let columns = || group.iter().filter(|column| column.c < rows);
            if columns().next().is_none() {
                continue;
            }
            if self.is_accurate {
                for &Column { c, .. } in columns() {
                    for at in c * stride..(c + 1) * stride {
                        self.points[at] = iterate.points[at] - step * iterate.scale[c];
                    }
                }
                evaluate(&self.points[..len], &mut self.beside[..len]);
            }
            for &Column { c, .. } in columns() {
                for at in c * stride..(c + 1) * stride {
                    let moved = iterate.points[at] + step * iterate.scale[c];
                    self.shifts[at] = moved - self.points[at];
                    self.points[at] = moved;
                }
            }
            evaluate(&self.points[..len], &mut self.gradients[..len]);
            for Column { c, entries } in columns() {
                let at = c * stride..(c + 1) * stride;
                self.points[at.clone()].copy_from_slice(&iterate.points[at]);
                for &(row, entry, mirrored) in entries {
                    for i in 0..s {
                        let place = row * stride + i;
                        let change = self.gradients[place] - self.beside[place];
                        let x = change / self.shifts[c * stride + i];
                        self.entries[entry * stride + i] = x;
                        self.entries[mirrored * stride + i] = x;
                    }
                }
            }
        }
    }

    /// Σ_i h b_i ∇²H(Y_i), entry by entry.
    pub(crate) fn mean_into(&self, mean: &mut [T]) {
        for (mean, entry) in mean.iter_mut().zip(self.entries.chunks_exact(self.stride)) {
            *mean = entry.iter().fold(T::int(0), |sum, &x| sum + x);
        }
    }
}
