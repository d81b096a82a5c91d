//! One iteration, all stages at once: Z ← K(α) L(Z), or Z ← Z + M⁻¹ (K(α) L(Z) − Z).

use crate::convergence::again::{Again, Once, Series};
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
    /// For n components; `alphas` are those a step starts from.
    pub fn prepare(
        method: &Coefficients<T>,
        n: usize,
        kinetic: Option<Kinetic<T>>,
        alphas: &[T],
    ) -> Self {
        (ready::<T>().iterate)(method, n, kinetic, alphas)
    }

    /// A step of size `h` begins at `y` with Z = 0 and the α_k to start from.
    pub fn begin(&mut self, method: &Coefficients<T>, step: (&State<T>, T)) {
        (ready::<T>().at_rest)(self, method, step);
    }

    /// A step of size `h` begins at `y`, where the last one began (`start` = 0) or ended (1), which had the
    /// size `last`; `known` is ∇H at `y`.
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

    /// y1 = y0 + Σ L_i, compensated.
    pub fn end_point(&self, y: &State<T>, next: &mut State<T>) {
        (ready::<T>().advance)(self, y, next);
    }

    /// Sees to it that the stages of all components are there.
    pub fn keep_momenta(&mut self, y: &State<T>) {
        (ready::<T>().make_momenta)(self, y);
    }

    /// From now on with K of these α_k.
    pub fn set_alphas(&mut self, method: &Coefficients<T>, alphas: &[T]) {
        (ready::<T>().fill_k)(self, method, alphas);
    }

    /// Changes Z of each unknown component c in place by `change(c, Z_c)`, and the stages with it.
    pub fn displace(&mut self, y: &State<T>, mut change: impl FnMut(usize, &mut [T])) {
        let unknowns = self.unknowns();
        let rows = self.z.chunks_exact_mut(self.stride).enumerate();
        rows.take(unknowns).for_each(|(c, z)| change(c, z));
        (ready::<T>().place)(self, y);
        self.z_is_k_l = false;
    }

    /// Takes over a step of size `h` from `y` that has these L, stage by stage in blocks of length n, and
    /// this K(α), row by row: Z = K L and the stages.
    pub fn set_stages(&mut self, method: &Coefficients<T>, step: (&State<T>, T), of: (&[T], &[T])) {
        (ready::<T>().stages)(self, method, step, of);
    }

    /// One iteration from the step's start `y`, or as many incremental ones as leave others to come. Returns
    /// what the last change of Z says, and how many iterations were made; each has evaluated the gradient at
    /// s points.
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
        let change = if self.is_incremental {
            (ready::<T>().series)(self, energy, y, &mut series)
        } else {
            (ready::<T>().once)(self, energy, y)
        };
        self.z_is_k_l = true;
        let made = series.made;
        if let Some(progress) = series.progress {
            // What an incremental iteration leaves has no L: it is never the last.
            let goes_on = progress == Progress::Settled;
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

    /// One iteration, and M⁻¹ applied to what it changes.
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
        let was_measured = self.is_measured;
        if !was_measured || contraction.is_far() {
            (ready.measure)(self, y, 0..self.n);
            self.is_measured = true;
        }
        (contraction.observe(change, !was_measured), 1)
    }

    /// How many times as much M⁻¹ makes of the rounding of the stages as M = I does: of stages that are off
    /// by ±1 in units of their components.
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

    /// One iteration. Returns the change.
    pub(crate) fn once(&mut self, energy: &mut Evaluator<T>, y: &State<T>) -> f64 {
        self.run(energy, y, &mut Once)
    }

    /// Incremental iterations. Returns the last change.
    pub(crate) fn series(
        &mut self,
        energy: &mut Evaluator<T>,
        y: &State<T>,
        series: &mut Series<'_>,
    ) -> f64 {
        self.run(energy, y, series)
    }

    /// Iterations of one form, by one kernel where there is one. Returns the last change.
    #[inline(always)]
    fn run(&mut self, energy: &mut Evaluator<T>, y: &State<T>, again: &mut impl Again) -> f64 {
        let fused = if T::IS_DOUBLE {
            match self.stride {
                4 => self.fuse::<4>(energy, y, again),
                8 => self.fuse::<8>(energy, y, again),
                _ => None,
            }
        } else {
            None
        };
        fused.unwrap_or_else(|| {
            loop {
                self.evaluate(energy);
                let change = (ready::<T>().mix)(self, y);
                if !again.again(change) {
                    return change;
                }
            }
        })
    }

    /// The whole iteration as one kernel, if there is one for this energy in this float type.
    #[inline(always)]
    fn fuse<const N: usize>(
        &mut self,
        energy: &mut Evaluator<T>,
        y: &State<T>,
        again: &mut impl Again,
    ) -> Option<f64> {
        macro_rules! fused {
            ($method:ident, $task:expr, $again:expr) => {{
                let task = $task.in_doubles()?;
                energy.$method::<N, _>(&mut OneGroup(task, $again))?
            }};
        }
        Some(match self.form(y) {
            Form::Full(task) => fused!(fuse_gradients, task, Once),
            Form::Separable(task) => fused!(fuse_forces, task, Once),
            Form::Incremental(task) => fused!(fuse_forces, task, again),
        })
    }

    /// ∇H, or ∇U, at the stages.
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
