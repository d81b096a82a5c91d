//! One sweep of the stage equations, all stages at once: Z ← K(α) L(Z).
//!
//! Component c of stage i stands at `c·stride + i`, so that the stages lie side by side in SIMD registers; the places from s to
//! `stride` are padding. Two forms:
//!
//! | H | unknowns | one sweep |
//! |---|---|---|
//! | any | Z of all 2m components | ∇H at the stages; Z ← K L |
//! | T(p) + U(q), T quadratic | Z of the m positions | ∇U at the stages; P ← p + K L_p; L_q = h b ∇T(P); Z_q ← K L_q |
//!
//! The second takes half the sweeps and only the derivative of U: with M⁻¹ known, ∇T needs no differentiation. Nothing is multiplied out:
//! K enters as K, with K_ij + K_ji = 1 to the last bit, so quadratic invariants are kept to rounding.
//!
//! Cost of a sweep: s gradients (of H, or of U) and 2m s² products. Nothing is allocated.

use crate::state::State;
use equip_autodiff::{Evaluate, Kinetic};
use equip_scalar::{Float, InstructionSet, mix_stages};
use equip_tableau::Gauss;

/// The iterate Z with its L, and what a sweep needs of the method.
#[derive(Debug)]
pub(crate) struct Iterate<T: Float> {
    pub(crate) s: usize,
    pub(crate) stride: usize,
    pub(crate) n: usize,
    pub(crate) kinetic: Option<Kinetic<T>>,
    set: InstructionSet,
    /// K(α), column by column.
    k: Vec<T>,
    rows: Vec<T>,
    alphas: Vec<T>,
    /// h b_i.
    hb: Vec<T>,
    h: T,
    /// L of the last sweep.
    pub(crate) l: Vec<T>,
    /// K L of the last sweep.
    z: Vec<T>,
    z_next: Vec<T>,
    /// Z before the α's moved.
    z_before: Vec<T>,
    points: Vec<T>,
    gradients: Vec<T>,
    /// Size of each component over the step.
    pub(crate) scale: Vec<T>,
    inverse_scale: Vec<T>,
}

/// Lanes are padded to this many.
fn stride_for(s: usize) -> usize {
    if s <= 4 { 4 } else { s.next_multiple_of(8) }
}

impl<T: Float> Iterate<T> {
    pub(crate) fn new(gauss: &Gauss<T>, n: usize, kinetic: Option<Kinetic<T>>) -> Self {
        let s = gauss.stages();
        let stride = stride_for(s);
        let zeros = |len: usize| vec![T::int(0); len];
        let mut iterate = Iterate {
            s,
            stride,
            n,
            kinetic,
            set: InstructionSet::best(),
            k: zeros(s * stride),
            rows: zeros(s * s),
            alphas: vec![T::NAN; s - 1],
            hb: zeros(stride),
            h: T::int(0),
            l: zeros(n * stride),
            z: zeros(n * stride),
            z_next: zeros(n * stride),
            z_before: zeros(n * stride),
            points: zeros(n * stride),
            gradients: zeros(n * stride),
            scale: zeros(n),
            inverse_scale: zeros(n),
        };
        iterate.set_alphas(gauss, &zeros(s - 1));
        iterate
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
        if self.alphas == alphas && !alphas.is_empty() {
            return;
        }
        self.alphas.copy_from_slice(alphas);
        gauss.skew_into(alphas, &mut self.rows);
        for (i, row) in self.rows.chunks_exact(self.s).enumerate() {
            for (j, &k) in row.iter().enumerate() {
                self.k[j * self.stride + i] = k;
            }
        }
    }

    /// A step of size `h` begins: Z = E L_old, E column by column, or zero without it.
    pub(crate) fn begin(&mut self, gauss: &Gauss<T>, h: T, prolongation: Option<&[T]>) {
        if self.h != h {
            self.h = h;
            for (hb, &b) in self.hb.iter_mut().zip(gauss.weights()) {
                *hb = h * b;
            }
        }
        let len = self.unknowns() * self.stride;
        match prolongation {
            Some(e) => mix_stages(
                self.set,
                e,
                &self.l[..len],
                &mut self.z[..len],
                self.s,
                self.stride,
            ),
            None => self.z.fill(T::int(0)),
        }
    }

    /// Measures the components: max(|y_c|, max_i |Z_ic|), of momenta that are not unknowns max_i |P_ic|; no less than ε² of the largest
    /// position or momentum.
    fn measure(&mut self, y: &State<T>) {
        let (s, stride, m) = (self.s, self.stride, self.n / 2);
        for c in 0..self.n {
            let place = c * stride..c * stride + s;
            self.scale[c] = if c < self.unknowns() {
                largest(&self.z_next[place]).max(y.hi[c].abs())
            } else {
                largest(&self.points[place])
            };
        }
        for group in [0..m, m..self.n] {
            let scale = &mut self.scale[group.clone()];
            let largest = largest(scale);
            let least = if largest > T::int(0) {
                largest * T::EPSILON * T::EPSILON
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

    /// One sweep from the step's start `y`. Returns the largest change of Z relative to the sizes of the components; not finite if
    /// anything is not. The components are measured in the `first` sweep of a step.
    pub(crate) fn sweep<E: Evaluate<T>>(&mut self, energy: &mut E, y: &State<T>, first: bool) -> T {
        let (s, stride, m) = (self.s, self.stride, self.n / 2);
        let len = self.unknowns() * stride;
        for (((point, z), &hi), &lo) in (self.points[..len].chunks_exact_mut(stride))
            .zip(self.z.chunks_exact(stride))
            .zip(&y.hi)
            .zip(&y.lo)
        {
            for (x, &z) in point.iter_mut().zip(z) {
                *x = hi + (z + lo);
            }
        }
        if self.kinetic.is_some() {
            energy.forces_by_component(&self.points[..len], &mut self.gradients[..len], stride, s);
            scale_rows(&mut self.l[len..], &self.gradients[..len], &self.hb, true);
        } else {
            energy.gradients_by_component(&self.points, &mut self.gradients, stride, s);
            let (by_q, by_p) = self.gradients.split_at(m * stride);
            let (l_q, l_p) = self.l.split_at_mut(m * stride);
            scale_rows(l_q, by_p, &self.hb, false);
            scale_rows(l_p, by_q, &self.hb, true);
        }
        self.mix(y);
        if first {
            self.measure(y);
        }
        let (mut change, mut sum) = (T::int(0), T::int(0));
        for ((z, next), &inverse) in (self.z[..len].chunks_exact_mut(stride))
            .zip(self.z_next.chunks_exact(stride))
            .zip(&self.inverse_scale)
        {
            for (z, &next) in z.iter_mut().zip(next).take(s) {
                let moved = (next - *z).abs() * inverse;
                change = if moved > change { moved } else { change };
                sum += moved;
                *z = next;
            }
        }
        if sum.is_finite() { change } else { T::NAN }
    }

    /// K L of the unknowns into `z_next`, from the gradients of the last sweep; of P and L_q on the way, where they are not unknowns.
    fn mix(&mut self, y: &State<T>) {
        let (set, s, stride, m) = (self.set, self.s, self.stride, self.n / 2);
        let len = self.unknowns() * stride;
        let Some(kinetic) = &self.kinetic else {
            return mix_stages(set, &self.k, &self.l, &mut self.z_next, s, stride);
        };
        let (l_q, l_p) = self.l.split_at_mut(len);
        let (momenta, velocities) = (&mut self.points[len..], &mut self.gradients[len..]);
        mix_stages(set, &self.k, l_p, momenta, s, stride);
        let starts = y.hi[m..].iter().zip(&y.lo[m..]);
        for (p, (&hi, &lo)) in momenta.chunks_exact_mut(stride).zip(starts) {
            p.iter_mut().for_each(|p| *p = hi + (*p + lo));
        }
        kinetic.velocities_by_component(momenta, velocities, stride);
        scale_rows(l_q, velocities, &self.hb, false);
        mix_stages(set, &self.k, l_q, &mut self.z_next[..len], s, stride);
    }

    /// After K has changed for the first time in the step: Z ← K L with the gradients there are. What Z was is kept.
    pub(crate) fn mix_anew(&mut self, y: &State<T>) {
        self.mix(y);
        std::mem::swap(&mut self.z, &mut self.z_next);
        std::mem::swap(&mut self.z_before, &mut self.z_next);
    }

    /// After K has changed again, by `share` of the first change: Z moves by this share of how it has moved since.
    pub(crate) fn extrapolate(&mut self, share: T) {
        let len = self.unknowns() * self.stride;
        for (z, &before) in self.z[..len].iter_mut().zip(&self.z_before) {
            *z += share * (*z - before);
        }
    }

    /// y1 = y0 + Σ L_i.
    pub(crate) fn end_point(&self, y: &State<T>, next: &mut State<T>) {
        y.advance_by_component(&self.l, self.s, self.stride, next);
    }
}

/// x_ci = ± w_i g_ci.
#[inline(always)]
fn scale_rows<T: Float>(x: &mut [T], g: &[T], w: &[T], negative: bool) {
    for (x, g) in x.chunks_exact_mut(w.len()).zip(g.chunks_exact(w.len())) {
        for ((x, &g), &w) in x.iter_mut().zip(g).zip(w) {
            *x = if negative { -(w * g) } else { w * g };
        }
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
