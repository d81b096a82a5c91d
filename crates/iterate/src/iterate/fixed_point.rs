//! Fixed-point iterations Z ← K(α) L(Z), and preconditioned ones Z ← Z + M⁻¹ (K(α) L(Z) − Z), for all stages
//! at once.

use crate::convergence::again::Series;
use crate::convergence::contraction::{Contraction, Progress};
use crate::extrapolation::polynomial::Polynomial;
use crate::forms::fused::OneGroup;
use crate::iterate::compiled::ready;
use crate::iterate::form::Form;
use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::{Held, Preconditioner};
use crate::layout::state::State;
use equip_autodiff::{Evaluator, Kinetic};
use equip_scalar::Float;
use equip_tableau::Coefficients;

impl<T: Float> Iterate<T> {
    /// Allocates for n components. `alphas` are the initial α_k of every step.
    pub fn prepare(
        method: &Coefficients<T>,
        n: usize,
        kinetic: Option<Kinetic<T>>,
        alphas: &[T],
    ) -> Self {
        (ready::<T>().new)(method, n, kinetic, alphas)
    }

    /// Begins a step of size `h` from `y` with Z = 0 and the initial α_k.
    pub fn begin(&mut self, method: &Coefficients<T>, step: (&State<T>, T)) {
        (ready::<T>().at_zero)(self, method, step);
    }

    /// Begins a step of size `h` from `y` with extrapolated stages. The last step had the size `last`, and
    /// this step starts where the last one began (`start` = 0) or ended (`start` = 1). `known` is ∇H at `y`.
    pub fn begin_from_last(
        &mut self,
        method: &Coefficients<T>,
        (y, h): (&State<T>, T),
        (polynomial, start, last): (&mut Polynomial<T>, T, T),
        known: Option<&[T]>,
    ) {
        let ready = ready::<T>();
        let ratio = h / last;
        (ready.polynomial)(polynomial, self.set, [start, ratio, last], known.is_some());
        (ready.from_polynomial)(self, method, (y, h, ratio), polynomial, known);
    }

    /// y1 = y0 + Σ L_i, with compensated summation. For linear equations L of stiff components is computed
    /// from Z.
    pub fn end_point(&mut self, y: &State<T>, next: &mut State<T>) {
        if std::mem::take(&mut self.has_residual) {
            (ready::<T>().correct)(self);
        }
        (ready::<T>().advance)(self, y, next);
    }

    /// Computes the stages of the momenta if they are not stored yet.
    pub fn keep_momenta(&mut self, y: &State<T>) {
        (ready::<T>().make_momenta)(self, y);
    }

    /// Sets K(α) for the following iterations.
    pub fn set_alphas(&mut self, method: &Coefficients<T>, alphas: &[T]) {
        (ready::<T>().fill_k)(self, method, alphas);
    }

    /// Changes Z of each unknown component c in place by `change(c, Z_c)`, and updates the stages.
    pub fn displace(&mut self, y: &State<T>, mut change: impl FnMut(usize, &mut [T])) {
        let unknowns = self.unknowns();
        let rows = self.z.chunks_exact_mut(self.stride).enumerate();
        rows.take(unknowns).for_each(|(c, z)| change(c, z));
        (ready::<T>().place)(self, y);
        self.z_is_k_l = false;
    }

    /// Sets Z = K L and the stages of a step of size `h` from `y`, given its L, stage by stage in blocks of
    /// length n, and its K(α), row by row.
    pub fn set_stages(&mut self, method: &Coefficients<T>, step: (&State<T>, T), of: (&[T], &[T])) {
        (ready::<T>().stages)(self, method, step, of);
    }

    /// Runs one iteration from the start `y` of the step, or a series of incremental ones if further
    /// iterations must follow. Returns the state of the iteration after the last change of Z, and the number
    /// of iterations. Each has evaluated the gradient at s points.
    pub fn fixed_point(
        &mut self,
        energy: &mut Evaluator<T>,
        y: &State<T>,
        contraction: &mut Contraction,
    ) -> (Progress, u32) {
        let measures =
            !self.is_measured || contraction.is_far() && contraction.next_change().is_finite();
        let mut series = Series::new(contraction);
        let can_be = self.twofold.is_some() && !self.k_has_moved;
        self.is_incremental = can_be && self.z_is_k_l && !measures && series.is_next();
        self.has_momenta = measures;
        let change = (ready::<T>().iterate)(self, energy, y, &mut series);
        (self.z_is_k_l, self.has_residual) = (true, false);
        let made = series.made;
        if let Some(progress) = series.progress {
            // An incremental iteration does not compute L_q, so it is never the last one.
            let goes_on = progress == Progress::Converged;
            return (
                if goes_on {
                    Progress::Contracts
                } else {
                    progress
                },
                made,
            );
        }
        let remeasured = measures && !self.is_measured;
        if measures {
            (ready::<T>().measure)(self, y, 0..self.n);
            self.is_measured = true;
        }
        (contraction.observe(change, remeasured), made)
    }

    /// One iteration, with M⁻¹ applied to its change of Z.
    pub fn preconditioned(
        &mut self,
        energy: &mut Evaluator<T>,
        y: &State<T>,
        contraction: &mut Contraction,
        m: &mut dyn Preconditioner<T>,
    ) -> (Progress, u32) {
        let ready = ready::<T>();
        self.is_incremental = false;
        self.has_momenta = true;
        (ready.keep_z)(self);
        self.evaluate(energy);
        (ready.mix)(self, y);
        m.apply(Held::Start, self.subtract_kept());
        let change = (ready.add_kept)(self, y);
        self.has_residual = self.inverse_k.is_some();
        let was_measured = self.is_measured;
        if !was_measured || contraction.is_far() {
            (ready.measure)(self, y, 0..self.n);
            self.is_measured = true;
        }
        (contraction.observe(change, !was_measured), 1)
    }

    /// The factor by which M⁻¹ amplifies rounding errors of the stages compared with M = I, measured for
    /// errors of ±1 in units of the components.
    pub fn amplification(&mut self, m: &mut dyn Preconditioner<T>) -> f64 {
        let (len, stride) = (self.unknowns() * self.stride, self.stride);
        let rows = &mut self.z_before[..len];
        let mut signs = 0x9e37_79b9_7f4a_7c15_u64;
        for (row, &scale) in rows.chunks_exact_mut(stride).zip(&self.scale) {
            for z in &mut row[..self.s] {
                *z = if signs & 1 == 0 { scale } else { -scale };
                signs = signs.rotate_right(1);
            }
        }
        m.apply(Held::Start, rows);
        let rows = rows.chunks_exact(stride).zip(&self.inverse_scale);
        let worst = |most: T, (row, &inverse): (&[T], &T)| {
            let sizes = row[..self.s].iter().map(|z| (*z * inverse).abs());
            sizes.fold(most, |most, size| most.max(size))
        };
        rows.fold(T::int(0), worst).to_f64()
    }

    /// A series of incremental iterations, or one iteration of another form, in one kernel if there is one.
    /// Returns the last change of Z.
    pub(crate) fn iterate(
        &mut self,
        energy: &mut Evaluator<T>,
        y: &State<T>,
        series: &mut Series<'_>,
    ) -> f64 {
        let fused = if T::IS_DOUBLE {
            match self.stride {
                4 => self.fuse::<4>(energy, y, series),
                8 => self.fuse::<8>(energy, y, series),
                _ => None,
            }
        } else {
            None
        };
        fused.unwrap_or_else(|| {
            loop {
                self.evaluate(energy);
                let change = (ready::<T>().mix)(self, y);
                if !self.is_incremental || !series.again(change) {
                    return change;
                }
            }
        })
    }

    /// The complete iteration in one kernel, if there is one for this energy and this float type.
    #[inline(always)]
    fn fuse<const N: usize>(
        &mut self,
        energy: &mut Evaluator<T>,
        y: &State<T>,
        series: &mut Series<'_>,
    ) -> Option<f64> {
        macro_rules! fused {
            ($method:ident, $task:expr) => {{
                let task = $task.in_doubles()?;
                energy.$method::<N, _>(&mut OneGroup(task, series))?
            }};
        }
        Some(match self.form(y) {
            Form::Full(task) => fused!(fuse_gradients, task),
            Form::Separable(task) => fused!(fuse_forces, task),
            Form::Incremental(task) => fused!(fuse_forces, task),
        })
    }

    /// Evaluates ∇H, or ∇U, at the stages.
    fn evaluate(&mut self, energy: &mut Evaluator<T>) {
        let (s, stride) = (self.s, self.stride);
        let len = self.unknowns() * stride;
        let (points, gradients) = (&self.points[..len], &mut self.gradients[..len]);
        if self.kinetic.is_some() {
            energy.forces_by_component(points, gradients, stride, s);
        } else {
            energy.gradients_by_component(points, gradients, stride, s);
        }
    }
}
