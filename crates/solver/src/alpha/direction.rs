//! Directions α = D t in which the α's move: a function of the solution of the stage equations, not of the
//! way to it.
//!
//! | needed | from |
//! |---|---|
//! | X_k, by which the stages follow α_k, and u_k = ∂y1/∂α_k | [`equip_sweeps::LinearSweeps`] with r = T_k L |
//! | u'_k = −Ψ⁻¹u_k, Ψ the tangent map of the step | the same with the end held and r = u_k |
//! | V, ∂I_a/∂α_k, the mean over both ends | ∇I_a(y1)·u_k and −∇I_a(y0)·u'_k |
//! | D | [`crate::alpha::least_displacement`] |
//!
//! Only the first [`LEADING`] of the free α's move, or as many as there are constraints. Where these are no
//! more than the constraints, the constraints alone say what they are: D = I, and nothing is solved with the
//! end held.
//!
//! Cost: ∇²H at the stages, and some 6 linear sweeps for each of them and each end.
//! Nothing is allocated.

use crate::alpha::least_displacement::{LeastDisplacement, dot};
use crate::equations::constraint::Constraint;
use crate::policy::LEADING;
use equip_autodiff::{Evaluate, Pattern};
use equip_linear::DenseLu;
use equip_scalar::{Float, mix_stages};
use equip_sweeps::{Held, Iterate, LinearSweeps, Preconditioner, State};
use equip_tableau::Gauss;
use nalgebra::{DMatrix, DVector};

/// Directions of the free α's.
#[derive(Debug)]
pub(crate) struct Direction<T: Float> {
    s: usize,
    n: usize,
    stride: usize,
    /// Number of the first α that moves, from 0, and how many do.
    first: usize,
    free: usize,
    linear: LinearSweeps<T>,
    /// T_k column by column.
    t_columns: Vec<Vec<T>>,
    /// Right-hand sides, X_k side by side, the solutions with the end held, and one T_k L.
    rhs: Vec<T>,
    x: Vec<T>,
    back: Vec<T>,
    t_l: Vec<T>,
    /// The solutions are those of other stages of the same step.
    is_near: bool,
    /// Motion of each component in the step with α = 0, and that of the component of its group (positions,
    /// momenta) that moves most.
    pub(crate) motion: [Vec<T>; 2],
    /// Motion of each component in the step as it is, 1 over it, and 1 over the size of the component.
    moved: Vec<T>,
    weights: Vec<T>,
    state_weights: Vec<T>,
    /// u_k and u'_k, and both weighted one after the other.
    ends: Vec<Vec<T>>,
    starts: Vec<Vec<T>>,
    rows: Vec<Vec<T>>,
    /// V as the mean over both ends, and as it is at the end; D.
    v: DMatrix<T>,
    v_end: DMatrix<T>,
    d: DMatrix<T>,
    least: LeastDisplacement<T>,
    /// What the constraints were before the last move and what it was to change them by; what slopes have
    /// been found to be off since.
    before: Vec<T>,
    predicted: Vec<T>,
    correction: DMatrix<T>,
    /// V_endᵀ D, and t.
    slopes: DenseLu<T>,
    has_slopes: bool,
    t: DVector<T>,
    /// By how much the α's are to move.
    pub(crate) delta: Vec<T>,
}

impl<T: Float> Direction<T> {
    /// For α_`first` and those after it, from 1, and so many constraints.
    pub(crate) fn new(
        gauss: &Gauss<T>,
        iterate: &Iterate<T>,
        pattern: &Pattern,
        (first, constraints): (usize, usize),
    ) -> Self {
        let (s, n, stride) = (iterate.stages(), iterate.components(), iterate.stride());
        let free = (s - first).min(LEADING.max(constraints));
        let zeros = |len: usize| vec![T::int(0); len];
        let t_columns = (first..first + free).map(|k| {
            let mut columns = zeros(s * stride);
            for (i, row) in gauss.skew_basis(k).chunks_exact(s).enumerate() {
                for (j, &x) in row.iter().enumerate() {
                    columns[j * stride + i] = x;
                }
            }
            columns
        });
        Direction {
            s,
            n,
            stride,
            first: first - 1,
            free,
            linear: LinearSweeps::new(gauss, iterate, pattern.clone(), free),
            t_columns: t_columns.collect(),
            rhs: zeros(n * free * stride),
            x: zeros(n * free * stride),
            back: zeros(n * free * stride),
            t_l: zeros(n * stride),
            is_near: false,
            motion: [zeros(n), zeros(n)],
            moved: zeros(n),
            weights: zeros(n),
            state_weights: zeros(n),
            ends: vec![zeros(n); free],
            starts: vec![zeros(n); free],
            rows: vec![zeros(2 * n); free],
            v: DMatrix::zeros(free, constraints),
            v_end: DMatrix::zeros(free, constraints),
            d: DMatrix::identity(free, constraints),
            least: LeastDisplacement::new(free),
            before: zeros(constraints),
            predicted: zeros(constraints),
            correction: DMatrix::zeros(free, constraints),
            slopes: DenseLu::new(constraints),
            has_slopes: false,
            t: DVector::zeros(constraints),
            delta: zeros(s - 1),
        }
    }

    /// A step begins its α's, at the solution in `iterate` from `y` to `next` with α = 0.
    pub(crate) fn begin(&mut self, iterate: &Iterate<T>, y: &State<T>, next: &State<T>) {
        self.correction.fill(T::int(0));
        self.is_near = false;
        self.weigh(iterate, y, next);
        let [own, group] = &mut self.motion;
        own.copy_from_slice(&self.moved);
        let m = self.n / 2;
        for (group, own) in group.chunks_exact_mut(m).zip(own.chunks_exact(m)) {
            group.fill(own.iter().fold(T::int(0), |most, &x| most.max(x)));
        }
    }

    /// Measures how far each component moves in the step from `y` to `next`, no less than √ε of its size, by
    /// which displacements are weighed.
    pub(crate) fn weigh(&mut self, iterate: &Iterate<T>, y: &State<T>, next: &State<T>) {
        let rows = iterate.points().chunks_exact(self.stride);
        let ends = y.hi.iter().zip(&next.hi);
        let root = T::EPSILON.sqrt();
        let inverse = |x: T| {
            let x = T::int(1) / x;
            if x.is_finite() { x } else { T::int(0) }
        };
        for (c, (row, (&from, &to))) in rows.zip(ends).enumerate() {
            let (mut least, mut most) = (from.min(to), from.max(to));
            for &x in &row[..self.s] {
                (least, most) = (least.min(x), most.max(x));
            }
            let size = least.abs().max(most.abs());
            self.moved[c] = (most - least) + root * size;
            (self.weights[c], self.state_weights[c]) = (inverse(self.moved[c]), inverse(size));
        }
    }

    /// The largest |y_c| in units of the motion.
    pub(crate) fn largest_size(&self, y: &State<T>) -> T {
        let sizes = y.hi.iter().zip(&self.weights);
        sizes.fold(T::int(0), |most, (&y, &weight)| {
            most.max((y * weight).abs())
        })
    }

    /// Linearises at the solution in `iterate`, with all its stages. Returns whether that is finite.
    pub(crate) fn linearise<E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
    ) -> bool {
        self.linear.linearise(iterate, energy)
    }

    /// Whether the step resolves its fastest oscillation, hω ≤ s, at the solution that was linearised: there
    /// Gauss turns it by .04, .01, 5e-4 of an angle too far with s = 2, 4, 8 (docs/adr/0020).
    pub(crate) fn is_resolved(&mut self) -> bool {
        self.linear.is_within(self.s as f64)
    }

    /// Whether there are more α's than constraints. If not, the constraints alone say what they are: D = I.
    pub(crate) fn has_choice(&self) -> bool {
        self.d.nrows() > self.d.ncols()
    }

    /// Takes the directions where it was linearised, to a relative `tolerance` of their displacements; from
    /// those of before if these are of this step. Returns whether there are any.
    pub(crate) fn take(
        &mut self,
        (iterate, constraints): (&Iterate<T>, &[Constraint<T>]),
        tolerance: T,
        mut m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let solved = self.solve_forward(iterate, tolerance, m.as_deref_mut())
            && (!self.has_choice() || self.solve_back(iterate, tolerance, m));
        self.is_near = solved;
        if !solved {
            return false;
        }
        for (k, row) in self.rows.iter_mut().enumerate() {
            let (end, start) = (&self.ends[k], &self.starts[k]);
            for (c, &weight) in self.weights.iter().enumerate() {
                row[c] = weight * end[c];
                row[self.n + c] = weight * start[c];
            }
            for (a, constraint) in constraints.iter().enumerate() {
                let at_end = dot(&constraint.gradient, end);
                self.v_end[(k, a)] = at_end + self.correction[(k, a)];
                self.v[(k, a)] = at_end - dot(&constraint.start_gradient, start);
            }
        }
        if self.has_choice() && !self.least.solve(&self.rows, &self.v, &mut self.d) {
            return false;
        }
        self.factor_slopes();
        self.has_slopes
    }

    /// From `alphas` to α = D t with the constraints, to first order, at zero, into `delta`. Returns whether
    /// that is finite.
    pub(crate) fn aim(&mut self, alphas: &[T], constraints: &[Constraint<T>]) -> bool {
        let moving = &alphas[self.first..][..self.free];
        for (a, (t, constraint)) in self.t.iter_mut().zip(constraints).enumerate() {
            let terms = moving.iter().enumerate();
            *t = terms.fold(-constraint.defect, |sum, (k, &alpha)| {
                sum + self.v_end[(k, a)] * alpha
            });
        }
        self.slopes.solve(&mut self.t);
        let mut is_finite = self.has_slopes;
        for (k, &alpha) in moving.iter().enumerate() {
            let terms = self.t.iter().enumerate();
            let aim = terms.fold(T::int(0), |sum, (a, &t)| sum + self.d[(k, a)] * t);
            let delta = aim - alpha;
            is_finite &= delta.is_finite();
            self.delta[self.first + k] = delta;
        }
        for (a, constraint) in constraints.iter().enumerate() {
            let moves = self.delta[self.first..][..self.free].iter().enumerate();
            self.predicted[a] = moves.fold(T::int(0), |sum, (k, &delta)| {
                sum + self.v_end[(k, a)] * delta
            });
            self.before[a] = constraint.defect;
        }
        is_finite
    }

    /// A move was made: slopes are those of K(0), and are corrected by what they have promised too much
    /// (Broyden 1965), each α in units of its displacement.
    pub(crate) fn learn(&mut self, constraints: &[Constraint<T>]) {
        let weighed = |k: usize| {
            let weight = dot(&self.rows[k], &self.rows[k]);
            weight * self.delta[self.first + k]
        };
        let square = (0..self.free).fold(T::int(0), |sum, k| {
            sum + weighed(k) * self.delta[self.first + k]
        });
        for (a, constraint) in constraints.iter().enumerate() {
            let off = (constraint.defect - self.before[a]) - self.predicted[a];
            if !(off.abs() > T::int(4) * constraint.floor) {
                continue;
            }
            for k in 0..self.free {
                let by = off * weighed(k) / square;
                if by.is_finite() {
                    self.correction[(k, a)] += by;
                    self.v_end[(k, a)] += by;
                }
            }
        }
        self.factor_slopes();
    }

    /// V_endᵀ D, factorised.
    fn factor_slopes(&mut self) {
        let matrix = self.slopes.matrix_mut();
        for (a, v) in self.v_end.column_iter().enumerate() {
            for (b, d) in self.d.column_iter().enumerate() {
                matrix[(a, b)] = v.dot(&d);
            }
        }
        self.has_slopes = self.slopes.factor().is_ok();
    }

    /// How far `delta` moves the stages, in units of the motion, and the end point, in units of the state.
    pub(crate) fn displacement(&self) -> [T; 2] {
        let (free, stride) = (self.free, self.stride);
        let delta = &self.delta[self.first..][..free];
        let unknown = if self.linear.knows_momenta() {
            self.n / 2
        } else {
            self.n
        };
        let (mut stages, mut end) = (T::int(0), T::int(0));
        for c in 0..self.n {
            let terms = self.ends.iter().zip(delta);
            let moved = terms.fold(T::int(0), |sum, (u, &delta)| sum + delta * u[c]);
            end = end.max((moved * self.state_weights[c]).abs());
            for i in 0..if c < unknown { self.s } else { 0 } {
                let rows = self.x[c * free * stride + i..].iter().step_by(stride);
                let moved = rows
                    .zip(delta)
                    .fold(T::int(0), |sum, (&x, &delta)| sum + delta * x);
                stages = stages.max((moved * self.weights[c]).abs());
            }
        }
        [stages, end]
    }

    /// Moves Z with `delta`.
    pub(crate) fn follow(&self, iterate: &mut Iterate<T>, y: &State<T>) {
        let (free, stride) = (self.free, self.stride);
        let delta = &self.delta[self.first..][..free];
        iterate.displace(y, |c, z| {
            for (k, &delta) in delta.iter().enumerate() {
                let x = &self.x[(c * free + k) * stride..][..stride];
                z.iter_mut().zip(x).for_each(|(z, &x)| *z += delta * x);
            }
        });
    }

    /// X_k with r = T_k L, and u_k.
    fn solve_forward(
        &mut self,
        iterate: &Iterate<T>,
        tolerance: T,
        m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let (s, stride) = (self.s, self.stride);
        for (k, t) in self.t_columns.iter().enumerate() {
            let (set, l) = (iterate.instruction_set(), iterate.increments());
            mix_stages(set, t, l, &mut self.t_l, s, stride);
            for (c, t_l) in self.t_l.chunks_exact(stride).enumerate() {
                self.rhs[(c * self.free + k) * stride..][..stride].copy_from_slice(t_l);
            }
        }
        let solved = self.solve(Held::Start, iterate, tolerance, m);
        for (k, end) in self.ends.iter_mut().enumerate() {
            for (c, u) in end.iter_mut().enumerate() {
                *u = self.linear.sums()[c * self.free + k];
            }
        }
        solved
    }

    /// The same with the end held and r = u_k, and u'_k.
    fn solve_back(
        &mut self,
        iterate: &Iterate<T>,
        tolerance: T,
        m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        for (k, end) in self.ends.iter().enumerate() {
            for (c, &u) in end.iter().enumerate() {
                let row = &mut self.rhs[(c * self.free + k) * self.stride..][..self.stride];
                row.fill(T::int(0));
                row[..self.s].fill(u);
            }
        }
        let solved = self.solve(Held::End, iterate, tolerance, m);
        for (k, (start, end)) in self.starts.iter_mut().zip(&self.ends).enumerate() {
            for (c, (start, &u)) in start.iter_mut().zip(end).enumerate() {
                *start = self.linear.sums()[c * self.free + k] - u;
            }
        }
        solved
    }

    fn solve(
        &mut self,
        held: Held,
        iterate: &Iterate<T>,
        tolerance: T,
        m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let x = match held {
            Held::Start => &mut self.x,
            Held::End => &mut self.back,
        };
        let (how, to_rest) = ((held, self.is_near), (self.weights.as_slice(), tolerance));
        self.linear.solve(how, (&self.rhs, x), to_rest, iterate, m)
    }
}
