//! The stage equations linearised, solved by sweeps: how a step answers to small changes, without a factorisation.
//!
//! With B_i = h b_i J∇²H(Y_i) a change r of the right-hand side and a change x of an end point move the stages by
//!
//! $$ X = K\,\delta L + r \quad\text{(start held)}, \qquad X = x - (\mathbf 1\mathbf 1^T - K)\,\delta L \quad\text{(start moves)},
//!    \qquad \delta L_i = B_i X_i , $$
//!
//! and the other end by Σ δL_i. Both are iterated momenta first, then positions: for H = T(p) + U(q) that takes half the sweeps.
//!
//! ∇²H at the stages is taken as quotients of differences of ∇H, all stages at once, one for each group of
//! columns that do not meet: right to √ε, or to ε^(2/3) for twice the price, which is enough for what only has to point the right way.
//!
//! *Layout.* As in [`crate::sweep`], with several right-hand sides: component c of side k of stage i stands at `(c·sides + k)·stride + i`.
//!
//! Cost: a gradient at all stages for each group of columns; a sweep of one side nnz·s + 2m s² products. Nothing is allocated.

use crate::hessians::turned;
use crate::outcome::Counts;
use crate::row::{add, by_lanes, times};
use crate::sweep::Iterate;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::{Float, InstructionSet, Kernel, mix_stages};
use equip_tableau::Gauss;

/// Sweeps allowed.
const MAX_SWEEPS: usize = 40;
/// And at least made: what a change is worth at the end shows after a few only.
const MIN_SWEEPS: usize = 3;

/// A column of ∇²H, with its entries on and above the diagonal: row, place, and place of the mirror image.
#[derive(Debug)]
struct Column {
    c: usize,
    entries: Vec<(usize, usize, usize)>,
}

impl Column {
    fn of(pattern: &Pattern, c: usize) -> Self {
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

/// The end of the step that does not move.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Held {
    Start,
    End,
}

/// ∇²H at all stages, and what is solved with it.
#[derive(Debug)]
pub(crate) struct LinearSweeps<T: Float> {
    s: usize,
    stride: usize,
    m: usize,
    set: InstructionSet,
    pub(crate) pattern: Pattern,
    groups: Vec<Vec<Column>>,
    /// h b_i ∂²H at stage i: entry e at `e·stride + i`; the padding is zero.
    entries: Vec<T>,
    /// One state and ∇²H there.
    state: Vec<T>,
    hessian: Vec<T>,
    /// K(0) and K(0) − 1 1ᵀ, column by column: for each end that may be held.
    k: [Vec<T>; 2],
    points: Vec<T>,
    gradients: Vec<T>,
    beside: Vec<T>,
    shifts: Vec<T>,
    is_accurate: bool,
    /// K δL, and δL.
    mixed: Vec<T>,
    dl: Vec<T>,
    /// Σ_i δL_i: component c of side k at `c·sides + k`.
    pub(crate) sums: Vec<T>,
    before: Vec<T>,
}

impl<T: Float> LinearSweeps<T> {
    /// For `sides` right-hand sides at most.
    pub(crate) fn new(
        gauss: &Gauss<T>,
        iterate: &Iterate<T>,
        pattern: Pattern,
        sides: usize,
    ) -> Self {
        let (s, n, stride) = (iterate.s, iterate.n, iterate.stride);
        let zeros = |len: usize| vec![T::int(0); len];
        let mut k = zeros(stride * stride);
        gauss.skew_columns_into(&zeros(s - 1), stride, &mut k);
        let mut k_back = zeros(stride * stride);
        for j in 0..s {
            for i in 0..s {
                k_back[j * stride + i] = -k[i * stride + j];
            }
        }
        LinearSweeps {
            s,
            stride,
            m: n / 2,
            set: iterate.set,
            groups: pattern
                .column_groups()
                .iter()
                .map(|group| group.iter().map(|&c| Column::of(&pattern, c)).collect())
                .collect(),
            entries: zeros(pattern.len() * stride),
            state: zeros(n),
            hessian: zeros(pattern.len()),
            k: [k, k_back],
            points: zeros(n * stride),
            gradients: zeros(n * stride),
            beside: zeros(n * stride),
            shifts: zeros(n * stride),
            is_accurate: false,
            mixed: zeros(n * sides * stride),
            dl: zeros(n * sides * stride),
            sums: zeros(n * sides),
            before: zeros(n * sides),
            pattern,
        }
    }

    /// Takes ∇²H at the stages of an iterate that has converged, by `accurate` differences or simple ones. Returns whether it is finite.
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

    /// How well ∇²H is known, and so all that is solved for: √ε, or ε^(2/3) by central differences.
    pub(crate) fn accuracy(&self) -> T {
        if !T::IS_DOUBLE {
            T::EPSILON
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

    /// Solves for all sides, `x` starting anywhere, until the sums δL of every side, weighed with `weights`, change by
    /// less than `tolerance`: X = K δL + r, or, with the other end held, X = r − (1 1ᵀ − K) δL. Returns whether they do.
    pub(crate) fn solve(
        &mut self,
        held: Held,
        sides: (&[T], &mut [T]),
        weights: &[T],
        tolerance: T,
    ) -> bool {
        let k = std::mem::take(&mut self.k[held as usize]);
        let solved = self.sweep(&k, sides, weights, tolerance);
        self.k[held as usize] = k;
        solved
    }

    fn sweep(&mut self, k: &[T], (r, x): (&[T], &mut [T]), weights: &[T], tolerance: T) -> bool {
        let (s, stride, m) = (self.s, self.stride, self.m);
        let len = x.len();
        let sides = len / (2 * m * stride);
        let half = m * sides * stride;
        for made in 0..MAX_SWEEPS {
            // δL_p = −h b ∂²H/∂q∂y X, then the momenta; δL_q = h b ∂²H/∂p∂y X, then the positions.
            for (rows, at) in [(0, half), (m, 0)] {
                let dl = &mut self.dl[at..at + half];
                self.set.run(&mut Times {
                    pattern: &self.pattern,
                    entries: &self.entries,
                    rows: (rows, m),
                    x,
                    dl,
                    sides,
                    stride,
                });
                let mixed = &mut self.mixed[at..at + half];
                mix_stages(self.set, k, dl, mixed, s, stride);
                let moved = x[at..at + half].iter_mut().zip(&r[at..at + half]);
                for ((x, &r), &z) in moved.zip(&*mixed) {
                    *x = r + z;
                }
            }
            self.before[..len / stride].copy_from_slice(&self.sums[..len / stride]);
            for (sum, dl) in self
                .sums
                .iter_mut()
                .zip(self.dl[..len].chunks_exact(stride))
            {
                *sum = dl[..s].iter().fold(T::int(0), |sum, &x| sum + x);
            }
            if made + 1 >= MIN_SWEEPS {
                match self.rests(sides, weights, tolerance) {
                    Some(true) => return true,
                    Some(false) => {}
                    None => return false,
                }
            }
        }
        false
    }

    /// Whether the sums of all sides have come to rest; `None` if they are not finite.
    fn rests(&self, sides: usize, weights: &[T], tolerance: T) -> Option<bool> {
        let mut all = true;
        for k in 0..sides {
            let (mut change, mut size) = (T::int(0), T::int(0));
            for (c, &w) in weights.iter().enumerate() {
                let (new, old) = (self.sums[c * sides + k], self.before[c * sides + k]);
                change += ((new - old) * w).abs();
                size += (new * w).abs();
            }
            if !size.is_finite() {
                return None;
            }
            all &= change <= tolerance * size;
        }
        Some(all)
    }
}

/// δL from X: rows of h b ∇²H times X, the sign being that of J.
struct Times<'a, T> {
    pattern: &'a Pattern,
    entries: &'a [T],
    /// First row and number of rows.
    rows: (usize, usize),
    x: &'a [T],
    dl: &'a mut [T],
    sides: usize,
    stride: usize,
}

impl<T: Float> Kernel for Times<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.stride, self)
    }
}

impl<T: Float> Times<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let (sides, groups) = (self.sides, self.stride / N);
        let entries = self.entries.as_chunks::<N>().0;
        let x = self.x.as_chunks::<N>().0;
        let dl = self.dl.as_chunks_mut::<N>().0;
        let (first, count) = self.rows;
        let n = self.pattern.dimension();
        for row in first..first + count {
            let (_, sign) = turned::<T>(row, n);
            let range = self.pattern.row_starts[row]..self.pattern.row_starts[row + 1];
            for side in 0..sides {
                for g in 0..groups {
                    let mut sum = [T::int(0); N];
                    for e in range.clone() {
                        let column = self.pattern.columns[e];
                        let (a, b) = (
                            &entries[e * groups + g],
                            &x[(column * sides + side) * groups + g],
                        );
                        add(&mut sum, &times(a, b));
                    }
                    for x in &mut sum {
                        *x *= sign;
                    }
                    dl[((row - first) * sides + side) * groups + g] = sum;
                }
            }
        }
    }
}
