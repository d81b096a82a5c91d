//! One sweep of the stage equations, all stages at once: Z ← K(α) L(Z).
//!
//! Component c of stage i stands at `c·stride + i`, so that the stages lie side by side in SIMD registers; the places from s to
//! `stride` are padding. Two forms:
//!
//! | H | unknowns | one sweep |
//! |---|---|---|
//! | any | Z of all 2m components | ∇H at the stages; Z ← K L |
//! | T(p) + U(q), T = ½ Σ w_c p_c² + b·p | Z of the m positions | ∇U at the stages; P ← p + K L_p; L_q = h b ∇T(P); Z_q ← K L_q |
//!
//! The second takes half the sweeps and only the derivative of U: with M⁻¹ known, ∇T needs no differentiation. Nothing is multiplied out:
//! K enters as K, with K_ij + K_ji = 1 to the last bit, so quadratic invariants are kept to rounding.
//!
//! Cost of a sweep: s gradients (of H, or of U) and 2m s² products. Nothing is allocated.

use crate::mix::{Change, Half, Step, Whole, stride_for};
use crate::state::State;
use equip_autodiff::{Evaluate, Kinetic};
use equip_scalar::{Float, InstructionSet, mix_stages};
use equip_tableau::Gauss;
use std::ops::Range;

/// The iterate Z with its L, and what a sweep needs of the method.
#[derive(Debug)]
pub(crate) struct Iterate<T: Float> {
    pub(crate) s: usize,
    pub(crate) stride: usize,
    pub(crate) n: usize,
    /// T(p), if it is quadratic with a diagonal M⁻¹.
    pub(crate) kinetic: Option<Kinetic<T>>,
    set: InstructionSet,
    /// K(α) and K(0), column by column.
    k: Vec<T>,
    k_start: Vec<T>,
    /// h b_i.
    pub(crate) hb: Vec<T>,
    h: T,
    /// L of the last sweep.
    pub(crate) l: Vec<T>,
    /// K L of the last sweep.
    z: Vec<T>,
    /// Z before the α's moved.
    z_before: Vec<T>,
    pub(crate) points: Vec<T>,
    gradients: Vec<T>,
    /// Size of each component over the step, and its inverse.
    pub(crate) scale: Vec<T>,
    inverse_scale: Vec<T>,
    /// Z of this step began as a prolongation.
    is_prolonged: bool,
    /// The last sweep moved Z by more than 1/8 of its size.
    was_far: bool,
    /// The next change of Z is relative to other sizes than the last.
    pub(crate) was_remeasured: bool,
}

impl<T: Float> Iterate<T> {
    /// `alphas` are those a step starts from.
    pub(crate) fn new(
        gauss: &Gauss<T>,
        n: usize,
        kinetic: Option<Kinetic<T>>,
        alphas: &[T],
    ) -> Self {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let zeros = |len: usize| vec![T::int(0); len];
        // One column for each place of L, also the padding: all zero there.
        let mut k = zeros(stride * stride);
        gauss.skew_columns_into(alphas, stride, &mut k);
        Iterate {
            s,
            stride,
            n,
            kinetic: kinetic.filter(|kinetic| kinetic.diagonal().is_some()),
            set: InstructionSet::best(),
            k_start: k.clone(),
            k,
            hb: zeros(stride),
            h: T::int(0),
            l: zeros(n * stride),
            z: zeros(n * stride),
            z_before: zeros(n * stride),
            points: zeros(n * stride),
            gradients: zeros(n * stride),
            scale: zeros(n),
            inverse_scale: zeros(n),
            is_prolonged: false,
            was_far: false,
            was_remeasured: false,
        }
    }

    /// Components that are unknown: all, or the positions.
    fn unknowns(&self) -> usize {
        match self.kinetic {
            Some(_) => self.n / 2,
            None => self.n,
        }
    }

    /// K for these α's.
    pub(crate) fn set_alphas(&mut self, gauss: &Gauss<T>, alphas: &[T]) {
        gauss.skew_columns_into(alphas, self.stride, &mut self.k);
    }

    /// A step of size `h` begins at `y` with the α's to start from: Z = E L_old, E column by column, or zero without it.
    pub(crate) fn begin(
        &mut self,
        gauss: &Gauss<T>,
        (y, h): (&State<T>, T),
        prolongation: Option<&[T]>,
    ) {
        if self.h != h {
            self.h = h;
            for (hb, &b) in self.hb.iter_mut().zip(gauss.weights()) {
                *hb = h * b;
            }
        }
        self.k.copy_from_slice(&self.k_start);
        let len = self.unknowns() * self.stride;
        let (z, l) = (&mut self.z[..len], &self.l[..len]);
        match prolongation {
            Some(e) => mix_stages(self.set, e, l, z, self.s, self.stride),
            None => z.fill(T::int(0)),
        }
        self.is_prolonged = prolongation.is_some();
        self.was_far = false;
        self.place(y);
        self.measure(y, 0..self.unknowns());
    }

    /// Stages from Z.
    fn place(&mut self, y: &State<T>) {
        let (stride, unknowns) = (self.stride, self.unknowns());
        let rows = self.points.chunks_exact_mut(stride);
        let starts = y.hi.iter().zip(&y.lo);
        for ((point, z), (&hi, &lo)) in rows
            .zip(self.z.chunks_exact(stride))
            .zip(starts)
            .take(unknowns)
        {
            for (x, &z) in point.iter_mut().zip(z) {
                *x = hi + (z + lo);
            }
        }
    }

    /// Measures components: max(|y_c|, max_i |Y_ic|), no less than ε^(3/4) of the largest position or momentum: the
    /// front of a wave that runs into a chain at rest is not resolved to its own last bit.
    fn measure(&mut self, y: &State<T>, components: Range<usize>) {
        let (s, stride, m) = (self.s, self.stride, self.n / 2);
        let root = T::EPSILON.sqrt();
        for c in components.clone() {
            let points = &self.points[c * stride..][..s];
            self.scale[c] = largest(points).max(y.hi[c].abs());
        }
        for group in [0..m, m..self.n] {
            let group = group.start.max(components.start)..group.end.min(components.end);
            if group.is_empty() {
                continue;
            }
            let scale = &mut self.scale[group.clone()];
            let largest = largest(scale);
            let least = if largest > T::int(0) {
                largest * root * root.sqrt()
            } else {
                T::int(1)
            };
            for (x, inverse) in scale.iter_mut().zip(&mut self.inverse_scale[group]) {
                *x = x.max(least);
                *inverse = T::int(1) / *x;
            }
        }
    }

    /// Takes over L of a step that was solved stage by stage, blocks of length n.
    pub(crate) fn take_l(&mut self, l: &[T]) {
        for (i, l) in l.chunks_exact(self.n).enumerate() {
            for (c, &l) in l.iter().enumerate() {
                self.l[c * self.stride + i] = l;
            }
        }
    }

    /// L stage by stage, in blocks of length n.
    pub(crate) fn give_l(&self, l: &mut [T]) {
        for (i, l) in l.chunks_exact_mut(self.n).enumerate() {
            for (c, l) in l.iter_mut().enumerate() {
                *l = self.l[c * self.stride + i];
            }
        }
    }

    /// The stage increments Z, stage by stage in blocks of length n; those of momenta that are no unknowns from their stages.
    pub(crate) fn give_z(&self, y: &State<T>, z: &mut [T]) {
        for (i, z) in z.chunks_exact_mut(self.n).enumerate() {
            for (c, z) in z.iter_mut().enumerate() {
                let place = c * self.stride + i;
                *z = if c < self.unknowns() {
                    self.z[place]
                } else {
                    (self.points[place] - y.hi[c]) - y.lo[c]
                };
            }
        }
    }

    /// One sweep from the step's start `y`. Returns the largest change of Z relative to the sizes of the components; not finite if
    /// anything is not. In the `first` sweep of a step what was not known before is measured.
    pub(crate) fn sweep<E: Evaluate<T>>(&mut self, energy: &mut E, y: &State<T>, first: bool) -> T {
        let (s, stride) = (self.s, self.stride);
        let len = self.unknowns() * stride;
        let (points, gradients) = (&self.points[..len], &mut self.gradients[..len]);
        if self.kinetic.is_some() {
            energy.forces_by_component(points, gradients, stride, s);
        } else {
            energy.gradients_by_component(points, gradients, stride, s);
        }
        let change = self.mix(y);
        if first || self.was_far {
            // What was measured on stages that were far off is measured again.
            let known = self.is_prolonged && !self.was_far;
            let from = if known { self.unknowns() } else { 0 };
            self.measure(y, from..self.n);
        }
        self.was_remeasured = self.was_far;
        self.was_far = change.largest > T::ratio(1, 8);
        if change.sum.is_finite() {
            change.largest
        } else {
            T::NAN
        }
    }

    /// L from the gradients, Z ← K L, and the stages; P and L_q on the way, where momenta are not unknowns.
    fn mix(&mut self, y: &State<T>) -> Change<T> {
        let (set, s) = (self.set, self.s);
        let step = Step {
            k: &self.k,
            hb: &self.hb,
            hi: &y.hi,
            lo: &y.lo,
            inverse_scale: &self.inverse_scale,
            gradients: &self.gradients,
            l: &mut self.l,
            z: &mut self.z,
            points: &mut self.points,
            s,
        };
        let Some(kinetic) = &self.kinetic else {
            return set.run(Whole(step));
        };
        set.run(Half {
            step,
            inverse_masses: kinetic.diagonal().unwrap_or_default(),
            offset: kinetic.offset(),
        })
    }

    /// After K has changed for the first time in the step: Z ← K L with the gradients there are. What Z was is kept.
    pub(crate) fn mix_anew(&mut self, y: &State<T>) {
        self.z_before.copy_from_slice(&self.z);
        self.mix(y);
    }

    /// After K has changed again, by `share` of the first change: Z moves by this share of how it has moved since.
    pub(crate) fn extrapolate(&mut self, y: &State<T>, share: T) {
        let len = self.unknowns() * self.stride;
        for (z, &before) in self.z[..len].iter_mut().zip(&self.z_before) {
            *z += share * (*z - before);
        }
        self.place(y);
    }

    /// Changes Z of each unknown component c in place by `change(c, Z_c)`, and the stages with it.
    pub(crate) fn displace(&mut self, y: &State<T>, mut change: impl FnMut(usize, &mut [T])) {
        let unknowns = self.unknowns();
        let rows = self.z.chunks_exact_mut(self.stride).enumerate();
        rows.take(unknowns).for_each(|(c, z)| change(c, z));
        self.place(y);
    }

    /// y1 = y0 + Σ L_i.
    pub(crate) fn end_point(&self, y: &State<T>, next: &mut State<T>) {
        y.advance_by_component(&self.l, self.s, self.stride, next);
    }
}

/// max |x_i|.
#[inline(always)]
fn largest<T: Float>(x: &[T]) -> T {
    x.iter().fold(T::int(0), |a, x| {
        let x = x.abs();
        if x > a { x } else { a }
    })
}
