//! The search direction D of a step: α = D t, one column for each constraint.
//!
//! D depends on the step with α = 0, that is on (y0, h). It does not change within the step.
//!
//! | quantity | computed from |
//! |---|---|
//! | X_k = ∂Z/∂α_k and u_k = ∂y1/∂α_k | the linearised stage equations with r = T_k L ([`equip_iterate::LinearIteration`]) |
//! | u'_k = −Ψ⁻¹u_k, Ψ the tangent map of the step | the same equations with y1 held and r = u_k |
//! | V, ∂I_a/∂α_k as the mean over both ends | ∇I_a(y1)·u_k and −∇I_a(y0)·u'_k |
//! | D | [`crate::alpha::least_displacement`] |
//!
//! Only the first [`LEADING`] free parameters α_k change, or as many as there are constraints. If there are
//! no more parameters than constraints, D = I, and the equations with y1 held are not solved.
//!
//! Cost: ∇²H at the stages, and about 6 linearised iterations for each parameter and each end. Nothing is
//! allocated.

use crate::alpha::least_displacement::{LeastDisplacement, dot};
use crate::constraint::Constraint;
use crate::policy::LEADING;
use equip_autodiff::{Evaluator, Pattern};
use equip_iterate::{Held, Iterate, LinearIteration, Preconditioner, State};
use equip_linear::DenseLu;
use equip_scalar::{Float, mix_stages};
use equip_tableau::Coefficients;
use nalgebra::{DMatrix, DVector};

/// D, and the data of the updates of t.
#[derive(Debug)]
pub(crate) struct Direction<T: Float> {
    s: usize,
    n: usize,
    stride: usize,
    /// The index of the first parameter that changes, from 0, and the number of parameters that change.
    first: usize,
    free: usize,
    pub(crate) linear: LinearIteration<T>,
    /// T_k column by column.
    t_columns: Vec<Vec<T>>,
    /// Right-hand sides; the X_k, concatenated; and the solutions with y1 held.
    rhs: Vec<T>,
    x: Vec<T>,
    back: Vec<T>,
    /// The change of each component over the step with α = 0, and the largest such change in its group
    /// (positions, momenta). Zero for time and its momentum.
    pub(crate) motion: [Vec<T>; 2],
    /// Whether the last position is time.
    has_time: bool,
    /// 1 over the change of each component.
    pub(crate) weights: Vec<T>,
    /// u_k and u'_k, and both weighted and concatenated.
    ends: Vec<Vec<T>>,
    starts: Vec<Vec<T>>,
    rows: Vec<Vec<T>>,
    /// V, and ∂I_a/∂α_k at y1.
    v: DMatrix<T>,
    v_end: DMatrix<T>,
    d: DMatrix<T>,
    least: LeastDisplacement<T>,
    /// ∂Z/∂t_a, concatenated.
    response: Vec<T>,
    /// ∂I_a/∂t_b, and its LU factorisation.
    derivatives: DMatrix<T>,
    factorised: DenseLu<T>,
    has_derivatives: bool,
    /// The square of the displacement for t_b = 1, over both ends.
    displacements: Vec<T>,
    /// The change of t by the last update.
    delta: DVector<T>,
}

impl<T: Float> Direction<T> {
    /// For the parameters from α_`first` on, counted from 1, and this number of constraints.
    pub(crate) fn new(
        method: &Coefficients<T>,
        iterate: &Iterate<T>,
        pattern: &Pattern,
        (first, constraints): (usize, usize),
        has_time: bool,
    ) -> Self {
        let (s, n, stride) = (iterate.stages(), iterate.components(), iterate.stride());
        let free = (s - first).min(LEADING.max(constraints));
        let zeros = |len: usize| vec![T::int(0); len];
        let t_columns = (first..first + free).map(|k| {
            let mut columns = zeros(s * stride);
            for (i, row) in method.skew_basis(k).chunks_exact(s).enumerate() {
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
            linear: LinearIteration::new(method, iterate, pattern.clone(), free),
            t_columns: t_columns.collect(),
            rhs: zeros(n * free * stride),
            x: zeros(n * free * stride),
            back: zeros(n * free * stride),
            motion: [zeros(n), zeros(n)],
            has_time,
            weights: zeros(n),
            ends: vec![zeros(n); free],
            starts: vec![zeros(n); free],
            rows: vec![zeros(2 * n); free],
            v: DMatrix::zeros(free, constraints),
            v_end: DMatrix::zeros(free, constraints),
            d: DMatrix::identity(free, constraints),
            least: LeastDisplacement::new(free),
            response: zeros(n * constraints * stride),
            derivatives: DMatrix::zeros(constraints, constraints),
            factorised: DenseLu::new(constraints),
            has_derivatives: false,
            displacements: zeros(constraints),
            delta: DVector::zeros(constraints),
        }
    }

    /// Measures the change of each component over the step with α = 0 from `y` to `next`, at least √ε of its
    /// size. This change is the unit of displacements.
    pub(crate) fn begin(&mut self, iterate: &Iterate<T>, y: &State<T>, next: &State<T>) {
        let (root, bounded) = (T::EPSILON.sqrt(), self.bounded());
        let m = self.n / 2;
        let rows = iterate.points().chunks_exact(self.stride);
        let ends = y.hi.iter().zip(&next.hi);
        let [own, group] = &mut self.motion;
        for (c, (row, (&from, &to))) in rows.zip(ends).enumerate() {
            let (mut least, mut most) = (from.min(to), from.max(to));
            for &x in &row[..self.s] {
                (least, most) = (least.min(x), most.max(x));
            }
            own[c] = T::int(0);
            if c % m < bounded {
                own[c] = (most - least) + root * least.abs().max(most.abs());
            }
            let inverse = T::int(1) / own[c];
            self.weights[c] = if inverse.is_finite() {
                inverse
            } else {
                T::int(0)
            };
        }
        for (group, own) in group.chunks_exact_mut(m).zip(own.chunks_exact(m)) {
            let most = own.iter().fold(T::int(0), |most, &x| most.max(x));
            group[..bounded].fill(most);
        }
    }

    /// The largest change of a component in each of the units, for these changes of all components.
    pub(crate) fn in_units(&self, changes: impl Iterator<Item = T>) -> [T; 2] {
        let (m, bounded) = (self.n / 2, self.bounded());
        let mut largest = [T::int(0); 2];
        let counts = |&(c, change): &(usize, T)| c % m < bounded && change != T::int(0);
        for (c, change) in changes.enumerate().filter(counts) {
            for (largest, units) in largest.iter_mut().zip(&self.motion) {
                *largest = largest.max(change / units[c]);
            }
        }
        largest
    }

    /// The number of positions, and of momenta, whose change is bounded. Time and its momentum only record
    /// the work of the drive: their local error is no reason to change q and p.
    fn bounded(&self) -> usize {
        self.n / 2 - usize::from(self.has_time)
    }

    /// The largest |y_c| in units of the change of component c.
    pub(crate) fn largest_size(&self, y: &State<T>) -> T {
        let sizes = y.hi.iter().zip(&self.weights);
        sizes.fold(T::int(0), |most, (&y, &weight)| {
            most.max((y * weight).abs())
        })
    }

    /// Linearises the stage equations at the stages of `iterate`. Returns whether the result is finite.
    pub(crate) fn linearise(&mut self, iterate: &Iterate<T>, energy: &mut Evaluator<T>) -> bool {
        self.linear.linearise(iterate, energy)
    }

    /// Whether the step resolves its fastest oscillation: hω ≤ s, with ω of the linearisation. At hω = s the
    /// phase error of Gauss is .04, .01 and 5e-4 for s = 2, 4 and 8 (docs/adr/0020).
    pub(crate) fn is_resolved(&mut self) -> bool {
        self.linear.is_within(self.s as f64)
    }

    /// Whether there are more parameters than constraints.
    pub(crate) fn has_choice(&self) -> bool {
        self.d.nrows() > self.d.ncols()
    }

    /// Computes D from the linearisation, with the relative `tolerance` for the displacements. Returns
    /// whether the constraints change along D.
    pub(crate) fn compute(
        &mut self,
        (iterate, constraints): (&Iterate<T>, &[Constraint<T>]),
        tolerance: T,
        mut m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let has_choice = self.has_choice();
        if !self.solve_forward(iterate, tolerance, m.as_deref_mut())
            || has_choice && !self.solve_back(iterate, tolerance, m)
        {
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
                self.v_end[(k, a)] = at_end;
                self.v[(k, a)] = at_end - dot(&constraint.start_gradient, start);
            }
        }
        if has_choice && !self.least.solve(&self.rows, &self.v, &mut self.d) {
            return false;
        }
        self.respond();
        self.factorise();
        self.has_derivatives
    }

    /// Computes ∂Z/∂t = Σ_k X_k D_k, and ∂I/∂t at y1.
    fn respond(&mut self) {
        let (side, r) = (self.n * self.stride, self.d.ncols());
        let unknown = self.unknowns() * self.stride;
        for (out, d) in self
            .response
            .chunks_exact_mut(side)
            .zip(self.d.column_iter())
        {
            let out = &mut out[..unknown];
            out.fill(T::int(0));
            for (x, &d) in self.x.chunks_exact(side).zip(&d) {
                out.iter_mut().zip(x).for_each(|(out, &x)| *out += d * x);
            }
        }
        self.v_end.tr_mul_to(&self.d, &mut self.derivatives);
        for (square, d) in self.displacements.iter_mut().zip(self.d.column_iter()) {
            // With one constraint the scale of the norm cancels.
            *square = T::int(1);
            if r > 1 {
                let moved = (0..2 * self.n).map(|c| {
                    let terms = self.rows.iter().zip(&d);
                    terms.fold(T::int(0), |sum, (row, &d)| sum + d * row[c])
                });
                *square = moved.fold(T::int(0), |sum, x| sum + x * x);
            }
        }
    }

    fn unknowns(&self) -> usize {
        if self.linear.knows_momenta() {
            self.n / 2
        } else {
            self.n
        }
    }

    /// One Newton or Broyden update of t towards zero constraints: adds D δt to `alphas`. Returns whether it
    /// is finite.
    pub(crate) fn update(&mut self, constraints: &[Constraint<T>], alphas: &mut [T]) -> bool {
        for (a, constraint) in constraints.iter().enumerate() {
            self.delta[a] = -constraint.residual;
        }
        self.factorised.solve(&mut self.delta);
        for (k, alpha) in alphas[self.first..][..self.free].iter_mut().enumerate() {
            let terms = self.delta.iter().enumerate();
            *alpha += terms.fold(T::int(0), |sum, (a, &t)| sum + self.d[(k, a)] * t);
        }
        self.has_derivatives && self.delta.iter().all(|t| t.is_finite())
    }

    /// Corrects ∂I/∂t after the last update (Broyden 1965; the secant method for one constraint).
    pub(crate) fn learn(&mut self, constraints: &[Constraint<T>]) {
        let weighted = |b: usize, delta: T| self.displacements[b] * delta;
        let terms = self.delta.iter().enumerate();
        let square = terms.fold(T::int(0), |sum, (b, &delta)| {
            sum + weighted(b, delta) * delta
        });
        for (a, constraint) in constraints.iter().enumerate() {
            // The update was predicted to make the constraint zero, so its residual is the prediction error.
            if constraint.residual.abs() > T::int(4) * constraint.round_off {
                for (b, &delta) in self.delta.iter().enumerate() {
                    let by = constraint.residual * weighted(b, delta) / square;
                    self.derivatives[(a, b)] += if by.is_finite() { by } else { T::int(0) };
                }
            }
        }
        self.factorise();
    }

    fn factorise(&mut self) {
        self.factorised.matrix_mut().copy_from(&self.derivatives);
        self.has_derivatives = self.factorised.factor().is_ok();
    }

    /// Adds ∂Z/∂t δt to Z.
    pub(crate) fn follow(&self, iterate: &mut Iterate<T>, y: &State<T>) {
        let (n, stride) = (self.n, self.stride);
        iterate.displace(y, |c, z| {
            for (a, &delta) in self.delta.iter().enumerate() {
                let x = &self.response[(a * n + c) * stride..][..stride];
                z.iter_mut().zip(x).for_each(|(z, &x)| *z += delta * x);
            }
        });
    }

    /// Solves for X_k with r = T_k L, and for u_k.
    fn solve_forward(
        &mut self,
        iterate: &Iterate<T>,
        tolerance: T,
        m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let sides = self.rhs.chunks_exact_mut(self.n * self.stride);
        for (r, t) in sides.zip(&self.t_columns) {
            let (set, l) = (iterate.instruction_set(), iterate.increments());
            mix_stages(set, t, l, r, self.s, self.stride);
        }
        let solved = self.solve(Held::Start, iterate, tolerance, m);
        let sums = self.linear.sums().chunks_exact(self.n);
        self.ends
            .iter_mut()
            .zip(sums)
            .for_each(|(u, sum)| u.copy_from_slice(sum));
        solved
    }

    /// Solves with y1 held and r = u_k, for u'_k.
    fn solve_back(
        &mut self,
        iterate: &Iterate<T>,
        tolerance: T,
        m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let rows = self.rhs.chunks_exact_mut(self.stride);
        for (row, &u) in rows.zip(self.ends.iter().flatten()) {
            for (i, r) in row.iter_mut().enumerate() {
                *r = if i < self.s { u } else { T::int(0) };
            }
        }
        let solved = self.solve(Held::End, iterate, tolerance, m);
        let sums = self.linear.sums().chunks_exact(self.n);
        for ((start, sum), end) in self.starts.iter_mut().zip(sums).zip(&self.ends) {
            for ((start, &sum), &u) in start.iter_mut().zip(sum).zip(end) {
                *start = sum - u;
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
        let to_tolerance = (self.weights.as_slice(), tolerance);
        self.linear
            .solve(held, (&self.rhs, x), to_tolerance, iterate, m)
    }
}
