//! Which α's, where sweeps contract: as [`crate::alpha`] chooses them, but everything by sweeps.
//!
//! | needed | from |
//! |---|---|
//! | u_k = ∂y1/∂α_k and the X_k by which the stages follow | [`crate::linear_sweeps`] with r = T_k L |
//! | u'_k = −Ψ⁻¹u_k, e' = −Ψ⁻¹e | the same with the end moved by −u_k, −e |
//! | e, the local error of the step with α = 0 | sweeps with one stage more, from the polynomial of these stages: [`crate::finer`] |
//!
//! and from these α⁰ and D of [`crate::displacement`]: α = α⁰ + D t.
//!
//! Only α_1 … α_[`LEADING`] move: further ones disturb the stages the more for the same displacement of y1.
//!
//! Steps that are to return take all of it again at the solution, relative to the α's that are there: what is left to move is then the same from both ends.
//!
//! Cost: [`crate::finer`], as many gradients as ∇²H has groups of columns (in wide numbers ∇²H at all stages), and some 6 linear sweeps of
//! each of 2·[`LEADING`] + 1 right-hand sides. Nothing is allocated.

use crate::constraint::Constraint;
use crate::displacement::{Displacements, dot};
use crate::finer::Finer;
use crate::hessians;
use crate::linear_sweeps::{Held, LinearSweeps};
use crate::one_more::OneMore;
use crate::outcome::Counts;
use crate::ready::ready;
use crate::springs::Springs;
use crate::stages::raise_to_least;
use crate::state::State;
use crate::sweep::Iterate;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::{Float, mix_stages};
use equip_tableau::Gauss;

/// So many α's move.
pub(crate) const LEADING: usize = 3;
/// Defects of fewer floors are removed by least displacement; of more than the second number the local error is aimed at in full. In between
/// in part: a defect is not the same to some floors in the step made backwards, and what follows from it is not to jump.
const AIMED_AT: [i64; 2] = [16, 256];
/// The same in wide numbers, whose defects of some hundred floors are no rounding: with the numbers above order 8 ends at 1e-26.
const WIDE_AIMED_AT: [i64; 2] = [0, 1];

#[derive(Debug)]
pub(crate) struct Response<T: Float> {
    s: usize,
    n: usize,
    stride: usize,
    /// Number of α's that move.
    free: usize,
    linear: LinearSweeps<T>,
    /// T_k column by column.
    t_columns: Vec<Vec<T>>,
    /// Right-hand sides and solutions, and one T_k L.
    rhs: Vec<T>,
    x: Vec<T>,
    back: Vec<T>,
    t_l: Vec<T>,
    /// The δL that the X_k on stiff springs were made with, side by side.
    made: Vec<T>,
    finer: Option<Finer<T>>,
    displacements: Displacements<T>,
    mean: Vec<T>,
    resolution: Vec<T>,
    sizes: Vec<T>,
    weights: Vec<T>,
    /// u_k and u'_k, one after the other; e and e'.
    ends: Vec<Vec<T>>,
    starts: Vec<Vec<T>>,
    error: Vec<T>,
    error_start: Vec<T>,
    /// How much of the error is aimed at, if there is one.
    share: T,
    /// By how much the free α's have moved.
    moved: Vec<T>,
    /// α⁰ and D.
    pub(crate) base: Vec<T>,
    pub(crate) d: Vec<T>,
    /// dg/dt, and what α⁰ does to g.
    pub(crate) slope: T,
    pub(crate) by_base: T,
}

impl<T: Float> Response<T> {
    pub(crate) fn new(
        gauss: &Gauss<T>,
        finer: Option<&OneMore<T>>,
        iterate: &Iterate<T>,
        pattern: &Pattern,
    ) -> Self {
        let (s, n, stride) = (iterate.s, iterate.n, iterate.stride);
        let free = (s - 1).min(LEADING);
        let zeros = |len: usize| vec![T::int(0); len];
        let t_columns = (1..=free).map(|k| {
            let mut columns = zeros(s * stride);
            for (i, row) in gauss.skew_basis(k).chunks_exact(s).enumerate() {
                for (j, &x) in row.iter().enumerate() {
                    columns[j * stride + i] = x;
                }
            }
            columns
        });
        Response {
            s,
            n,
            stride,
            free,
            linear: LinearSweeps::new(gauss, iterate, pattern.clone(), free + 1),
            t_columns: t_columns.collect(),
            rhs: zeros(n * (free + 1) * stride),
            x: zeros(n * free * stride),
            back: zeros(n * (free + 1) * stride),
            t_l: zeros(n * stride),
            made: Vec::new(),
            finer: finer.map(|finer| Finer::new(finer.clone(), iterate, pattern)),
            displacements: Displacements::new(free + 1, n, 1),
            mean: zeros(pattern.len()),
            resolution: zeros(n),
            sizes: zeros(n),
            weights: zeros(n),
            ends: vec![zeros(n); free],
            starts: vec![zeros(n); free],
            error: zeros(n),
            error_start: zeros(n),
            share: T::int(0),
            moved: zeros(free),
            base: zeros(s - 1),
            d: zeros(s - 1),
            slope: T::int(0),
            by_base: T::int(0),
        }
    }

    /// The steps are made with these springs, or without.
    pub(crate) fn set_springs(&mut self, springs: Option<&Springs<T>>) {
        if let Some(finer) = &mut self.finer {
            let earlier = finer.iterate.springs.take();
            finer.iterate.springs = springs.and_then(|springs| springs.for_other_stages(earlier));
        }
        if let Some(springs) = springs {
            self.linear.make_room(springs);
            self.made.clone_from(&self.linear.made);
        }
    }

    /// Takes α⁰ and D at the converged stages of `iterate`, at whose end point the constraint has been
    /// evaluated; its gradient at the start is known. Returns whether they were found; of a step that does not resolve the motion they are left to Newton.
    pub(crate) fn take<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        step: (&State<T>, T),
        constraint: &Constraint<T>,
        counts: &mut Counts,
    ) -> bool {
        self.linear.set_k(None);
        self.moved.fill(T::int(0));
        self.measure(iterate);
        self.share = self.share_of_error(constraint);
        self.take_at(iterate, energy, step, constraint, counts)
    }

    /// The same at the stages that the α's have led to: what they are to move by yet. For steps that are to return: those of the step made backwards are the same
    /// where the directions are those at the solution.
    pub(crate) fn take_again<E: Evaluate<T>>(
        &mut self,
        (iterate, alphas, start): (&Iterate<T>, &[T], &[T]),
        energy: &mut E,
        step: (&State<T>, T),
        constraint: &Constraint<T>,
        counts: &mut Counts,
    ) -> bool {
        self.linear.set_k(Some(&iterate.k));
        self.measure(iterate);
        for (moved, (&alpha, &start)) in self.moved.iter_mut().zip(alphas.iter().zip(start)) {
            *moved = alpha - start;
        }
        self.take_at(iterate, energy, step, constraint, counts)
    }

    /// At the stages of a step from y by h with α = 0, or of one whose α's have moved, whose components are measured.
    fn take_at<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        step: (&State<T>, T),
        constraint: &Constraint<T>,
        counts: &mut Counts,
    ) -> bool {
        if !self.linear.take(iterate, energy, false, counts) {
            return false;
        }
        self.resolve();
        self.displacements
            .begin(&self.sizes, &self.resolution, false);
        if self.displacements.is_unresolved(0) {
            return false;
        }
        let aims = self.find_error(iterate, energy, step, counts);
        // The error of the directions times how far they are to move the end point is to be round-off: a step backwards takes the same.
        // The u_k are nearly parallel, which makes their errors some 1000 times as large in the α's.
        let pairs = self.error.iter().zip(&self.weights);
        let error = pairs.fold(T::int(0), |a, (&e, &w)| a.max((e * w).abs()));
        let moved = error.max(constraint.defect.abs() / constraint.scale);
        let wanted = T::EPSILON / (T::int(1024) * moved);
        if wanted < self.linear.accuracy() && !self.linear.take(iterate, energy, true, counts) {
            return false;
        }
        let ready = ready::<T>();
        let tolerance = wanted.clamp(T::int(16) * T::EPSILON, T::ratio(1, 100));
        if !(ready.solve_forward)(self, iterate, tolerance) {
            return false;
        }
        counts.alpha_solves += 2 * self.free as u64;
        if !(ready.solve_back)(self, iterate, tolerance) {
            return false;
        }
        for (u, back) in self.ends.iter().zip(&self.starts) {
            let slope = (dot(&constraint.gradient, u) - dot(&constraint.start_gradient, back))
                / constraint.scale;
            self.displacements.push(u, back, std::iter::once(slope));
            self.displacements.count_one();
        }
        if !self.displacements.factor() {
            return false;
        }
        self.base.fill(T::int(0));
        self.d.fill(T::int(0));
        if aims {
            self.displacements
                .aim(&self.error, &self.error_start, &self.moved);
            self.displacements.base(&mut self.base[..self.free]);
        }
        for (base, &moved) in self.base.iter_mut().zip(&self.moved) {
            *base -= moved;
        }
        self.displacements.direction(0, &mut self.d[..self.free]);
        // Only the ratios matter.
        let largest = self.d.iter().fold(T::int(0), |a, x| a.max(x.abs()));
        if !(largest > T::int(0)) {
            return false;
        }
        self.d.iter_mut().for_each(|d| *d /= largest);
        let slopes = self.ends.iter().map(|u| dot(&constraint.gradient, u));
        (self.slope, self.by_base) = (T::int(0), T::int(0));
        for (v, (&d, &base)) in slopes.zip(self.d.iter().zip(&self.base)) {
            self.slope += v * d;
            self.by_base += v * base;
        }
        true
    }

    /// How much of the local error is aimed at.
    fn share_of_error(&self, constraint: &Constraint<T>) -> T {
        let aimed_at = if T::IS_DOUBLE {
            AIMED_AT
        } else {
            WIDE_AIMED_AT
        };
        let [least, full] = aimed_at.map(T::int);
        let floors = constraint.in_floors_of_both_ends(&self.sizes);
        ((floors - least) / (full - least)).min(T::int(1))
    }

    /// The local error of the step, as much of it as is aimed at, and in wide numbers what it is at the start. Returns whether there is one.
    fn find_error<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        step: (&State<T>, T),
        counts: &mut Counts,
    ) -> bool {
        let share = self.share;
        let errors = [&mut self.error, &mut self.error_start];
        let aims = share > T::int(0)
            && match &mut self.finer {
                Some(finer) => {
                    counts.local_errors += 1;
                    if T::IS_DOUBLE {
                        let [error, _] = errors;
                        let found = finer.estimate(iterate, energy, step, &self.weights, error);
                        counts.gradients += finer.evaluations;
                        found
                    } else {
                        finer.estimate_both(iterate, energy, step, &self.weights, errors, counts)
                    }
                }
                None => false,
            };
        for e in [&mut self.error, &mut self.error_start] {
            if aims {
                e.iter_mut().for_each(|e| *e *= share);
            } else {
                e.fill(T::int(0));
            }
        }
        aims
    }

    /// How far the α's are to move the end point yet, relative to the sizes of the components, where g is what it is.
    pub(crate) fn still_moves(&self, g: T) -> T {
        let t = -(g + self.by_base) / self.slope;
        (0..self.n).fold(T::int(0), |most, c| {
            let alphas = self.base.iter().zip(&self.d);
            let moved = (self.ends.iter().zip(alphas)).fold(T::int(0), |sum, (u, (&base, &d))| {
                sum + (base + t * d) * u[c]
            });
            most.max((moved * self.weights[c]).abs())
        })
    }

    /// How far the end point moves along D where g is removed, relative to the positions or to the momenta, whichever is more.
    pub(crate) fn displacement(&self, g: T) -> T {
        let m = self.n / 2;
        let of = |group: std::ops::Range<usize>| {
            let (mut moved, mut size) = (T::int(0), T::int(0));
            for c in group {
                let ends = self.ends.iter().zip(&self.d);
                let u = ends.fold(T::int(0), |sum, (u, &d)| sum + d * u[c]);
                moved += u * u;
                size += self.sizes[c] * self.sizes[c];
            }
            (moved / size).sqrt()
        };
        let (q, p) = (of(0..m), of(m..2 * m));
        (g / self.slope).abs() * if q > p { q } else { p }
    }

    /// Moves Z by Σ δα_k X_k, δα being the change of the α's.
    pub(crate) fn follow(&self, iterate: &mut Iterate<T>, y: &State<T>, delta: &[T]) {
        let (free, stride) = (self.free, self.stride);
        iterate.displace(y, |c, z| {
            for (k, &delta) in delta.iter().enumerate().take(free) {
                let x = &self.x[(c * free + k) * stride..][..stride];
                z.iter_mut().zip(x).for_each(|(z, &x)| *z += delta * x);
            }
        });
        iterate.follow_with(&delta[..free], &self.made);
    }

    /// Sizes of the components that are the same for the step made backwards.
    fn measure(&mut self, iterate: &Iterate<T>) {
        let (s, stride) = (self.s, self.stride);
        for (size, points) in self
            .sizes
            .iter_mut()
            .zip(iterate.points.chunks_exact(stride))
        {
            *size = points[..s].iter().fold(T::int(0), |a, x| a.max(x.abs()));
        }
        raise_to_least(&mut self.sizes);
        for (weight, &size) in self.weights.iter_mut().zip(&self.sizes) {
            *weight = if size > T::int(0) {
                T::int(1) / size
            } else {
                size
            };
        }
    }

    /// How far each component is resolved.
    fn resolve(&mut self) {
        self.linear.mean_into(&mut self.mean);
        hessians::resolution(&self.linear.pattern, &self.mean, &mut self.resolution);
    }

    /// X_k and u_k.
    pub(crate) fn solve_forward(&mut self, iterate: &Iterate<T>, tolerance: T) -> bool {
        let (free, stride, n) = (self.free, self.stride, self.n);
        let len = n * free * stride;
        for (k, t) in self.t_columns.iter().enumerate() {
            mix_stages(iterate.set, t, &iterate.l, &mut self.t_l, self.s, stride);
            for (c, t_l) in self.t_l.chunks_exact(stride).enumerate() {
                self.rhs[(c * free + k) * stride..][..stride].copy_from_slice(t_l);
            }
        }
        let sides = (&self.rhs[..len], &mut self.x[..len]);
        if !(self.linear).solve(Held::Start, sides, &self.weights, tolerance, iterate) {
            return false;
        }
        self.made.copy_from_slice(&self.linear.made);
        for (k, end) in self.ends.iter_mut().enumerate() {
            for (c, u) in end.iter_mut().enumerate() {
                *u = self.linear.sums[c * free + k];
            }
        }
        true
    }

    /// u'_k, e'. X of the forward solution stays.
    pub(crate) fn solve_back(&mut self, iterate: &Iterate<T>, tolerance: T) -> bool {
        let (count, stride, n) = (self.free + 1, self.stride, self.n);
        let mut x = std::mem::take(&mut self.back);
        for c in 0..n {
            let ends = self.ends.iter().chain(std::iter::once(&self.error));
            for (k, u) in ends.enumerate() {
                self.rhs[(c * count + k) * stride..][..stride].fill(u[c]);
            }
        }
        let sides = (self.rhs.as_slice(), x.as_mut_slice());
        let solved = (self.linear).solve(Held::End, sides, &self.weights, tolerance, iterate);
        self.back = x;
        if !solved {
            return false;
        }
        let starts = self.starts.iter_mut().zip(&self.ends);
        let error = std::iter::once((&mut self.error_start, &self.error));
        // In wide numbers it is known.
        let pairs = starts
            .chain(error)
            .take(if T::IS_DOUBLE { count } else { count - 1 });
        for (k, (start, end)) in pairs.enumerate() {
            for (c, (start, &u)) in start.iter_mut().zip(end).enumerate() {
                *start = self.linear.sums[c * count + k] - u;
            }
        }
        true
    }
}
