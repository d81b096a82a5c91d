//! The stage equations linearised, solved by sweeps: how a step answers to small changes, without a factorisation.
//!
//! With B_i = h b_i J∇²H(Y_i) a change r of the right-hand side and a change x of an end point move the stages by
//!
//! $$ X = K\,\delta L + r \quad\text{(start held)}, \qquad X = x - (\mathbf 1\mathbf 1^T - K)\,\delta L \quad\text{(start moves)},
//!    \qquad \delta L_i = B_i X_i , $$
//!
//! and the other end by Σ δL_i. Both are iterated momenta first, then positions; for H = T(p) + U(q) as sweeps know it the momenta are put in: `positions`.
//!
//! ∇²H at the stages: `at_stages`. On stiff springs δL is foreseen as gradients are ([`crate::foresee`]).
//!
//! *Layout.* As in [`crate::sweep`], with several right-hand sides: component c of side k of stage i stands at `(c·sides + k)·stride + i`.
//!
//! Cost: a sweep of one side nnz·s + 2m s² products, of positions alone less than half of that. Nothing is allocated.

mod at_stages;
mod positions;

use crate::columns::both_ways;
use crate::hessians::turned;
use crate::row::{by_groups, fused_each, scaled};
use crate::springs::Springs;
use crate::sweep::Iterate;
use at_stages::Column;
use equip_autodiff::Pattern;
use equip_scalar::{Float, InstructionSet, Kernel, mix_stages};
use equip_tableau::Gauss;
use positions::Positions;
use std::hint::black_box;

/// Sweeps allowed.
const MAX_SWEEPS: usize = 40;
/// And at least made: what a change is worth at the end shows after a few only.
const MIN_SWEEPS: usize = 3;

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
    /// The same of the α's that the step has come to, if it has.
    k_there: [Vec<T>; 2],
    is_there: bool,
    points: Vec<T>,
    gradients: Vec<T>,
    beside: Vec<T>,
    shifts: Vec<T>,
    is_accurate: bool,
    /// On stiff springs, side by side, the δL that X was made with.
    pub(crate) made: Vec<T>,
    /// K δL, and δL.
    mixed: Vec<T>,
    dl: Vec<T>,
    /// Σ_i δL_i: component c of side k at `c·sides + k`.
    pub(crate) sums: Vec<T>,
    before: Vec<T>,
    /// What else sweeps of positions alone need, if there are any.
    positions: Option<Positions<T>>,
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
        let k = both_ways(gauss);
        let rows = n / 2 * sides;
        let positions = (iterate.kinetic.as_ref()).map(|_| Positions::new(gauss, &k, rows));
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
            k_there: k.clone(),
            is_there: false,
            k,
            positions,
            points: zeros(n * stride),
            gradients: zeros(n * stride),
            beside: zeros(n * stride),
            shifts: zeros(n * stride),
            is_accurate: false,
            made: Vec::new(),
            mixed: zeros(n * sides * stride),
            dl: zeros(n * sides * stride),
            sums: zeros(n * sides),
            before: zeros(n * sides),
            pattern,
        }
    }

    /// With room for stiff springs.
    pub(crate) fn make_room(&mut self, springs: &Springs<T>) {
        let rows = self.sums.len() / (2 * self.m) * springs.springs.len();
        self.made.resize(rows * self.stride, T::int(0));
    }

    /// From now on with this K(α), or with K(0). By K(α) all unknowns are swept.
    pub(crate) fn set_k(&mut self, there: Option<&[T]>) {
        self.is_there = there.is_some();
        let Some(k) = there else {
            return;
        };
        let (stride, s) = (self.stride, self.s);
        let [forward, back] = &mut self.k_there;
        forward.copy_from_slice(k);
        for j in 0..s {
            for i in 0..s {
                back[j * stride + i] = -k[i * stride + j];
            }
        }
    }

    /// Whether the positions alone are unknown.
    fn knows_momenta(&self) -> bool {
        self.positions.is_some() && !self.is_there
    }

    /// Solves for all sides, until the sums δL of every side, weighed with `weights`, change by less than `tolerance`: X = K δL + r,
    /// or, with the other end held, X = r − (1 1ᵀ − K) δL. Returns whether they do. Where the positions alone are unknown the momenta in `x` are not made.
    pub(crate) fn solve(
        &mut self,
        held: Held,
        (r, x): (&[T], &mut [T]),
        weights: &[T],
        tolerance: T,
        iterate: &Iterate<T>,
    ) -> bool {
        let sides = x.len() / (2 * self.m * self.stride);
        self.made.fill(T::int(0));
        if self.knows_momenta() {
            self.begin_positions(held, r, x, iterate);
        } else {
            x.copy_from_slice(r);
        }
        for made in 0..MAX_SWEEPS {
            std::mem::swap(&mut self.sums, &mut self.before);
            if self.knows_momenta() {
                self.sweep_positions(held, x, iterate);
            } else {
                self.sweep(held, (r, x), iterate);
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

    /// δL_p = −h b ∂²H/∂q∂y X, then the momenta; δL_q = h b ∂²H/∂p∂y X, then the positions.
    fn sweep(&mut self, held: Held, (r, x): (&[T], &mut [T]), iterate: &Iterate<T>) {
        let (s, stride, m) = (self.s, self.stride, self.m);
        let sides = x.len() / (2 * m * stride);
        let half = m * sides * stride;
        for (rows, at) in [(0, half), (m, 0)] {
            self.times((rows, m), 2 * m, (x, at), (held, iterate));
            let mixed = &mut self.mixed[at..at + half];
            let k = if self.is_there {
                &self.k_there
            } else {
                &self.k
            };
            let k = &k[held as usize];
            mix_stages(self.set, k, &self.dl[at..at + half], mixed, s, stride);
            self.set.run(&mut Plus {
                x: &mut x[at..at + half],
                r: &r[at..at + half],
                z: mixed,
            });
        }
        let rows = self.dl[..2 * half].chunks_exact(stride);
        for (sum, dl) in self.sums.iter_mut().zip(rows) {
            *sum = dl[..s].iter().fold(T::int(0), |sum, &x| sum + x);
        }
    }

    /// δL, from `at` on, as X makes it by these rows of ∇²H, of which the first `columns` are looked at; on stiff springs as it is foreseen.
    fn times(
        &mut self,
        rows: (usize, usize),
        columns: usize,
        (x, at): (&[T], usize),
        (held, iterate): (Held, &Iterate<T>),
    ) {
        let sides = x.len() / (2 * self.m * self.stride);
        let dl = &mut self.dl[at..at + rows.1 * sides * self.stride];
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
        if let (Some(springs), 0) = (iterate.active_springs(), rows.0) {
            let reversed = matches!(held, Held::End);
            let made = (&mut *self.made, dl);
            springs.foresee_sides(self.set, made, &iterate.hb, (sides, self.s), reversed);
        }
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
    /// Columns that are looked at.
    columns: usize,
    x: &'a [T],
    dl: &'a mut [T],
    sides: usize,
    stride: usize,
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
        let sides = self.sides;
        let entries = self.entries.as_chunks::<N>().0;
        let x = self.x.as_chunks::<N>().0;
        let dl = self.dl.as_chunks_mut::<N>().0;
        let n = self.pattern.dimension();
        let starts = &self.pattern.row_starts[self.rows.0..];
        let rows = dl.chunks_exact_mut(sides * groups).take(self.rows.1);
        for ((row, dl), range) in (self.rows.0..).zip(rows).zip(starts.windows(2)) {
            let (_, sign) = turned::<T>(row, n);
            dl.fill([T::int(0); N]);
            for e in range[0]..range[1] {
                let column = self.pattern.columns[e];
                if column >= self.columns {
                    break;
                }
                let entry = &entries[e * groups..][..groups];
                let x = &x[column * sides * groups..][..sides * groups];
                for (dl, x) in dl.chunks_exact_mut(groups).zip(x.chunks_exact(groups)) {
                    // One side after the other: of four at a time the compiler would gather the numbers.
                    let x = black_box(x);
                    for g in 0..groups {
                        dl[g] = fused_each(&scaled(&entry[g], sign), &x[g], &dl[g]);
                    }
                }
            }
        }
    }
}

/// X = r + Z.
struct Plus<'a, T> {
    x: &'a mut [T],
    r: &'a [T],
    z: &'a [T],
}

impl<T: Float> Kernel for Plus<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        for ((x, &r), &z) in self.x.iter_mut().zip(self.r).zip(self.z) {
            *x = r + z;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::Counts;
    use crate::state::State;
    use equip_autodiff::{Evaluate, Hamiltonian, System};

    /// From either end of the step, hω = 2.5: with springs the same in fewer sweeps.
    #[test]
    fn springs_are_solved_for_at_once() {
        let energy = Hamiltonian::new(2, |q, p| {
            let between = (q[1] - q[0]).powi(2);
            0.5 * (p[0] * p[0] + 0.5 * p[1] * p[1]) + 2500.0 * q[1] * q[1] + between * between
        });
        let energy = energy.unwrap();
        let pattern = &energy.structure().hessian;
        let mut evaluator = energy.evaluator::<f64>();
        let y = State::new(&[1.0, 0.01], &[0.5, 0.7]);
        for s in [3, 8, 11, 16] {
            let (h, gauss) = (0.05, Gauss::<f64>::new(s).unwrap());
            let kinetic = evaluator.kinetic();
            let w: Vec<f64> = kinetic.as_ref().unwrap().diagonal().unwrap().to_vec();
            let mut iterate = Iterate::new(&gauss, 4, kinetic, &vec![0.0; s - 1]);
            iterate.begin(&gauss, (&y, h));
            for _ in 0..30 {
                iterate.sweep(&mut evaluator, &y, false, &mut crate::ahead::Once);
            }
            let stiff = (pattern, w.as_slice(), false);
            let springs = Springs::find(
                &gauss,
                &mut evaluator,
                stiff,
                (&y.hi, h),
                (&mut Vec::new(), None),
            );
            let mut springs = springs.0.unwrap();
            assert_eq!(springs.springs.len(), 1);
            assert!(springs.has_failed(&gauss) && springs.is_active);

            let sides = 2;
            let mut linear = LinearSweeps::new(&gauss, &iterate, pattern.clone(), sides);
            linear.make_room(&springs);
            assert!(linear.take(&iterate, &mut evaluator, true, &mut Counts::default()));
            let stride = iterate.stride;
            let mut r = vec![0.0; 4 * sides * stride];
            for (k, row) in r.chunks_exact_mut(stride).enumerate() {
                for (i, x) in row.iter_mut().enumerate().take(s) {
                    *x = ((3 * k + i * i) as f64).sin();
                }
            }
            for held in [Held::Start, Held::End] {
                let mut solve = |springs, tolerance| {
                    iterate.springs = springs;
                    let mut x = vec![0.0; r.len()];
                    let solved = (&*r, &mut *x);
                    let found = linear.solve(held, solved, &[1.0; 4], tolerance, &iterate);
                    (found, linear.sums.clone(), iterate.springs.take())
                };
                let (_, plain, _) = solve(None, 1e-14);
                let (found, sprung, back) = solve(Some(springs), 1e-6);
                springs = back.unwrap();
                assert!(found);
                let most = plain.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
                for (a, b) in plain.iter().zip(&sprung) {
                    assert!((a - b).abs() <= 1e-8 * most, "s = {s}, {held:?}: {a}, {b}");
                }
            }
        }
    }
}
