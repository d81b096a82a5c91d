//! Changes of Z, L and the stages other than by an iteration.

use crate::iterate::iterate::Iterate;
use crate::layout::state::State;
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// A copy of the stages.
#[derive(Debug)]
pub struct Kept<T> {
    z: Vec<T>,
    l: Vec<T>,
    points: Vec<T>,
    has_momenta: bool,
}

impl<T: Float> Kept<T> {
    /// L of these stages, component by component.
    pub fn increments(&self) -> &[T] {
        &self.l
    }

    /// Allocates a copy for the stages of `iterate`.
    pub fn new(iterate: &Iterate<T>) -> Self {
        let zeros = || vec![T::int(0); iterate.n * iterate.stride];
        Kept {
            z: zeros(),
            l: zeros(),
            points: zeros(),
            has_momenta: false,
        }
    }
}

impl<T: Float> Iterate<T> {
    /// Computes the stages of momenta that are not unknowns, by repeating the linear half of the last
    /// iteration.
    pub(crate) fn make_momenta(&mut self, y: &State<T>) {
        if !std::mem::replace(&mut self.has_momenta, true) {
            debug_assert!(!self.is_incremental);
            self.mix(y);
        }
    }

    /// Copies Z, L and the stages into `kept`.
    pub fn keep(&self, kept: &mut Kept<T>) {
        kept.z.copy_from_slice(&self.z);
        kept.l.copy_from_slice(&self.l);
        kept.points.copy_from_slice(&self.points);
        kept.has_momenta = self.has_momenta;
    }

    /// Restores the stages in `kept`, which were solved with the initial α_k.
    pub fn put_back(&mut self, kept: &Kept<T>) {
        self.z.copy_from_slice(&kept.z);
        self.l.copy_from_slice(&kept.l);
        self.points.copy_from_slice(&kept.points);
        self.has_momenta = kept.has_momenta;
        self.k.copy_from_slice(&self.k_start);
        (self.k_has_moved, self.z_is_k_l, self.has_residual) = (false, true, false);
    }

    /// Sets the L of another step, stage by stage in blocks of length n.
    pub fn set_increments(&mut self, l: &[T]) {
        for (i, l) in l.chunks_exact(self.n).enumerate() {
            for (c, &l) in l.iter().enumerate() {
                self.l[c * self.stride + i] = l;
            }
        }
    }

    pub(crate) fn take_stages(
        &mut self,
        method: &Coefficients<T>,
        (y, h): (&State<T>, T),
        (l, k): (&[T], &[T]),
    ) {
        self.set_step(method, h);
        self.set_increments(l);
        let (s, stride) = (self.s, self.stride);
        for c in 0..self.n {
            for (i, row) in k.chunks_exact(s).enumerate() {
                let terms = row.iter().zip(&self.l[c * stride..]);
                let z = terms.fold(T::int(0), |sum, (&k, &l)| sum + k * l);
                self.z[c * stride + i] = z;
                self.points[c * stride + i] = y.hi[c] + (z + y.lo[c]);
            }
        }
        self.has_momenta = true;
        self.measure(y, 0..self.n);
    }

    /// L stage by stage, in blocks of length n.
    pub fn increments_by_stage(&self, l: &mut [T]) {
        for (i, block) in l.chunks_exact_mut(self.n).enumerate() {
            for (c, x) in block.iter_mut().enumerate() {
                *x = self.l[c * self.stride + i];
            }
        }
    }

    /// Copies Z, for `subtract_kept`.
    pub(crate) fn keep_z(&mut self) {
        let len = self.unknowns() * self.stride;
        self.z_before[..len].copy_from_slice(&self.z[..len]);
    }

    /// Replaces Z by its difference to the copy, K L − Z, which is stored if L is to be corrected.
    pub(crate) fn subtract_kept(&mut self) -> &mut [T] {
        let len = self.unknowns() * self.stride;
        let pairs = self.z[..len].iter_mut().zip(&self.z_before[..len]);
        pairs.for_each(|(z, &before)| *z -= before);
        if self.inverse_k.is_some() {
            self.delta[..len].copy_from_slice(&self.z[..len]);
        }
        &mut self.z[..len]
    }

    /// Adds the copy to Z, and updates the stages. Returns the largest change of Z relative to the sizes of
    /// the components.
    pub(crate) fn add_kept(&mut self, y: &State<T>) -> f64 {
        let (stride, unknowns) = (self.stride, self.unknowns());
        let (mut most, mut sum) = (T::int(0), T::int(0));
        let rows = self
            .z
            .chunks_exact_mut(stride)
            .zip(self.z_before.chunks_exact(stride));
        for ((z, before), &inverse) in rows.zip(&self.inverse_scale).take(unknowns) {
            for (z, &before) in z.iter_mut().zip(before) {
                let change = (*z * inverse).abs();
                sum += change;
                most = most.max(change);
                *z += before;
            }
        }
        self.place(y);
        self.z_is_k_l = false;
        if sum.is_finite() {
            most.to_f64()
        } else {
            f64::NAN
        }
    }
}
