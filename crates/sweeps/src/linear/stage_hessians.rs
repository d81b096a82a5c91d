//! ∇²H at the stages, and δL_i = h b_i J∇²H(Y_i) X_i.
//!
//! Where few digits are asked for, in `f64`, by differences of ∇H at all stages at once, one for each group
//! of columns that do not meet (Curtis, Powell, Reid 1974): right to √ε, or central ones, to ε^(2/3). Else
//! itself, stage by stage.
//!
//! Cost: a gradient at all stages and one more for each group of columns, or two for each group; or s
//! Hessians.

use crate::iterate::iterate::Iterate;
use crate::layout::conjugate::turned;
use crate::layout::row::{by_groups, fused_each, scaled, stride_for};
use crate::linear::power_iteration::PowerIteration;
use crate::policy::QUOTIENTS;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::{Float, InstructionSet, Kernel};

/// A column of ∇²H, with its entries on and above the diagonal: row, place, and place of the mirror image.
#[derive(Debug)]
pub(crate) struct Column {
    c: usize,
    entries: Vec<(usize, usize, usize)>,
}

impl Column {
    pub(crate) fn of(pattern: &Pattern, c: usize) -> Self {
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

/// Evaluations at one point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Of ∇H.
    pub gradients: u64,
    /// Of ∇²H.
    pub hessians: u64,
}

/// h b_i ∇²H(Y_i).
#[derive(Debug)]
pub(crate) struct StageHessians<T: Float> {
    s: usize,
    stride: usize,
    m: usize,
    set: InstructionSet,
    pub(crate) pattern: Pattern,
    groups: Vec<Vec<Column>>,
    /// Entry e at `e·stride + i`; the padding is zero.
    entries: Vec<T>,
    /// One state and ∇²H there.
    state: Vec<T>,
    hessian: Vec<T>,
    points: Vec<T>,
    gradients: Vec<T>,
    beside: Vec<T>,
    shifts: Vec<T>,
    fastest: PowerIteration,
}

impl<T: Float> StageHessians<T> {
    pub(crate) fn new(iterate: &Iterate<T>, pattern: Pattern) -> Self {
        let (n, stride) = (iterate.n, iterate.stride);
        let zeros = |len: usize| vec![T::int(0); len];
        let groups = pattern.column_groups();
        let columns = |group: &Vec<usize>| group.iter().map(|&c| Column::of(&pattern, c)).collect();
        let mut fastest = PowerIteration::default();
        fastest.make_room(&pattern);
        StageHessians {
            s: iterate.s,
            stride,
            m: n / 2,
            set: iterate.set,
            groups: groups.iter().map(columns).collect(),
            entries: zeros(pattern.len() * stride),
            state: zeros(n),
            hessian: zeros(pattern.len()),
            points: zeros(n * stride),
            gradients: zeros(n * stride),
            beside: zeros(n * stride),
            shifts: zeros(n * stride),
            fastest,
            pattern,
        }
    }

    /// Takes ∇²H at the stages of an iterate that has converged, as good as what is solved for to this
    /// `tolerance` needs it. `None` if it is not finite.
    pub(crate) fn take<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        tolerance: T,
    ) -> Option<Work> {
        let [simple, central] = [T::EPSILON.sqrt(), T::EPSILON.cbrt().powi(2)];
        let [simple, central] = [simple, central].map(|x| T::int(QUOTIENTS) * x);
        if !T::IS_DOUBLE || tolerance < central {
            return self.take_exactly(iterate, energy);
        }
        let work = self.take_quotients(iterate, energy, tolerance < simple);
        self.weigh(iterate).then_some(work)
    }

    /// Multiplies by h b_i. Returns whether all is finite.
    fn weigh(&mut self, iterate: &Iterate<T>) -> bool {
        let mut sum = T::int(0);
        for entry in self.entries.chunks_exact_mut(self.stride) {
            for (x, &hb) in entry.iter_mut().zip(&*iterate.hb) {
                *x *= hb;
                sum += *x;
            }
        }
        sum.is_finite()
    }

    /// The same to rounding.
    pub(crate) fn take_exactly<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
    ) -> Option<Work> {
        for i in 0..self.s {
            for (c, x) in self.state.iter_mut().enumerate() {
                *x = iterate.points[c * self.stride + i];
            }
            energy.hessian(&self.state, &mut self.hessian);
            let places = self.entries.chunks_exact_mut(self.stride);
            for (entry, &x) in places.zip(&self.hessian) {
                entry[i] = x;
            }
        }
        let hessians = self.s as u64;
        self.weigh(iterate).then_some(Work {
            gradients: 0,
            hessians,
        })
    }

    fn take_quotients<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        is_central: bool,
    ) -> Work {
        let (s, stride) = (self.s, self.stride);
        self.entries.fill(T::int(0));
        let rows = self.known_rows(iterate);
        let len = rows * stride;
        let mut work = Work::default();
        let mut evaluate = |points: &[T], gradients: &mut [T]| {
            work.gradients += s as u64;
            match iterate.kinetic {
                Some(_) => energy.forces_by_component(points, gradients, stride, s),
                None => energy.gradients_by_component(points, gradients, stride, s),
            }
        };
        self.points[..len].copy_from_slice(&iterate.points[..len]);
        // The gradients that others are compared with: at the stages themselves, or to the other side of
        // them.
        if !is_central {
            evaluate(&self.points[..len], &mut self.beside[..len]);
        }
        let eps = T::EPSILON;
        let step = if is_central { eps.cbrt() } else { eps.sqrt() };
        for group in &self.groups {
            let columns = || group.iter().filter(|column| column.c < rows);
            if columns().next().is_none() {
                continue;
            }
            if is_central {
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
        work
    }

    /// Rows of ∇²H that are to be differenced: of T(p) + U(q) those of U, T being known.
    fn known_rows(&mut self, iterate: &Iterate<T>) -> usize {
        let Some(weights) = iterate.inverse_masses() else {
            return 2 * self.m;
        };
        for (c, &w) in weights.iter().enumerate() {
            for (entry, column) in self.pattern.row(self.m + c) {
                if column == self.m + c {
                    self.entries[entry * self.stride..][..self.s].fill(w);
                }
            }
        }
        self.m
    }

    /// Whether the fastest motion, ∇²H being the mean over the step, turns by an angle hω of at most `most`.
    pub(crate) fn is_within(&mut self, most: f64) -> bool {
        let places = self.entries.chunks_exact(self.stride);
        let mean = places.map(|entry| {
            let sum = entry[..self.s].iter().fold(T::int(0), |sum, &x| sum + x);
            sum.to_f64()
        });
        self.fastest.set(&self.pattern, mean);
        self.fastest.is_within(&self.pattern, most)
    }

    /// δL of these rows of ∇²H, of which the first `columns` count, from X of several sides.
    pub(crate) fn times(
        &self,
        rows: (usize, usize),
        columns: usize,
        (x, sides): (&[T], usize),
        dl: &mut [T],
    ) {
        self.set.run(&mut Times {
            pattern: &self.pattern,
            entries: &self.entries,
            rows,
            columns,
            x,
            dl,
            sides,
            stride: self.stride,
        });
    }
}

/// δL from X: rows of h b ∇²H times X, the sign being that of J.
struct Times<'a, T> {
    pub(crate) pattern: &'a Pattern,
    pub(crate) entries: &'a [T],
    /// First row and number of rows.
    rows: (usize, usize),
    /// Columns that are looked at.
    columns: usize,
    x: &'a [T],
    pub(crate) dl: &'a mut [T],
    sides: usize,
    pub(crate) stride: usize,
}

impl<T: Float> Kernel for Times<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.stride, self);
    }
}

impl<T: Float> Times<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        for (place, row) in (self.rows.0..).take(self.rows.1).enumerate() {
            let mut side = 0;
            while side < self.sides {
                side += match self.sides - side {
                    1 => self.block::<N, 1>((place, row, side), groups),
                    2 => self.block::<N, 2>((place, row, side), groups),
                    _ => self.block::<N, 3>((place, row, side), groups),
                };
            }
        }
    }

    /// S sides of a row, whose sums stay in registers. Returns S.
    #[inline(always)]
    fn block<const N: usize, const S: usize>(
        &mut self,
        (place, row, side): (usize, usize, usize),
        groups: usize,
    ) -> usize {
        let (entries, x) = (self.entries.as_chunks::<N>().0, self.x.as_chunks::<N>().0);
        let dl = self.dl.as_chunks_mut::<N>().0;
        let (_, sign) = turned::<T>(row, self.pattern.dimension());
        let range = self.pattern.row_starts[row]..self.pattern.row_starts[row + 1];
        let columns = &self.pattern.columns[range.clone()];
        for g in 0..groups {
            let mut sums = [[T::int(0); N]; S];
            for (e, &column) in range.clone().zip(columns) {
                if column >= self.columns {
                    break;
                }
                let entry = &entries[e * groups + g];
                let x = &x[(column * self.sides + side) * groups..][..S * groups];
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum = fused_each(entry, &x[k * groups + g], sum);
                }
            }
            for (k, sum) in sums.iter().enumerate() {
                dl[(place * self.sides + side + k) * groups + g] = scaled(sum, sign);
            }
        }
        S
    }
}
