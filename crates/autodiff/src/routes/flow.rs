//! w and w' of y' = Jw, which a step needs: ∇H and ∇²H, multiplied by the bracket if the system has one
//! ([`crate::structure::bracket`]).
//!
//! Cost of a bracket: a gradient of its bilinear form for each gradient of H; for w' the Hessian of the form,
//! and the products of B with ∇²H that can be non-zero.

use super::evaluator::{Evaluator, Source, Turned};
use super::traced_evaluator::ready;
use crate::replay::batch::Batch;
use crate::structure::conjugate::{turn, turned};
use equip_scalar::Float;

use Source::{External, Traced, WithGradient};

impl<T: Float> Evaluator<T> {
    /// Writes the running error bound of the trace of w at `y` to `off` (length n): a bound for the effect of
    /// rounding `y` in its last place and of rounding all operations, to first order. For an external energy
    /// it is its accuracy, relative to the largest component.
    pub fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => {
                round(y, off);
                (ready::<T>().gradient_rounding)(traced, y, off);
            }
            External(external) => external.gradient_rounding(y, off),
        }
        if let Some(mut turned) = self.bracket.take() {
            turned.gradients.resize(y.len(), T::int(0));
            self.gradients(y, &mut turned.gradients, y.len());
            turned.turn_rounding(y, off);
            self.bracket = Some(turned);
        }
    }

    /// Writes w of y' = Jw at `y` to `w` (length n): ∇H, or JᵀB∇H.
    pub fn flow_gradient(&mut self, y: &[T], w: &mut [T]) {
        self.gradients(y, w, y.len());
        if let Some(turned) = &mut self.bracket {
            turned.turn(y, w, 1, 1);
        }
    }

    /// Writes y' = Jw at `y` to `f` (length n).
    pub fn vector_field(&mut self, y: &[T], f: &mut [T]) {
        self.flow_gradient(y, f);
        turn(f);
    }

    /// Writes (∂y'/∂y) v at `y`, the right-hand side of the variational equation, to `product` (length n).
    pub fn jacobian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.hessian_vector(y, v, product);
        turn(product);
    }

    /// w at `count` points at once, component by component: component c of point i is at `c·stride + i` in
    /// `states` (length n·stride) and in `gradients`. Entries between `count` and `stride` must be finite;
    /// their results are unspecified. Each w agrees bit for bit with that of
    /// [`flow_gradient`](Self::flow_gradient).
    pub fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let batch = Batch::new(states, &mut *gradients, stride, count);
        match &mut self.source {
            Traced(traced) => (ready::<T>().gradients_by_component)(traced, batch),
            WithGradient(_, given) => given.by_component(batch),
            External(external) => external.given.by_component(batch),
        }
        if let Some(turned) = &mut self.bracket {
            turned.turn(states, gradients, stride, count);
        }
    }

    /// Writes ∇²H(y)·v, or w'(y)·v, to `product` (length n). For an external energy ∇²H is computed by
    /// differences of its gradient.
    pub fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => {
                (ready::<T>().hessian_vector)(traced, y, v, product)
            }
            External(external) => external.hessian_times(y, v, product),
        }
        if let Some(mut turned) = self.bracket.take() {
            turned.gradients.resize(y.len(), T::int(0));
            self.gradients(y, &mut turned.gradients, y.len());
            turned.turn_product(y, v, product);
            self.bracket = Some(turned);
        }
    }

    /// The entries of ∇²H(y), or w'(y), in the order of the pattern `structure().hessian`. For an external
    /// energy they are computed by differences of its gradient.
    pub fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        let Some(mut turned) = self.bracket.take() else {
            return self.energy_hessian(y, entries);
        };
        turned.gradients.resize(y.len(), T::int(0));
        turned.hessians.resize(turned.pattern.len(), T::int(0));
        self.gradients(y, &mut turned.gradients, y.len());
        self.energy_hessian(y, &mut turned.hessians);
        turned.jacobians(y, entries, (1, 1));
        self.bracket = Some(turned);
    }

    fn energy_hessian(&mut self, y: &[T], entries: &mut [T]) {
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().hessian)(traced, y, entries),
            External(external) => external.hessian(y, entries),
        }
    }

    /// ∇²H, or w', at `count` points at once, component by component as in
    /// [`gradients_by_component`](Self::gradients_by_component): entry e of the pattern at point i is at
    /// `e·stride + i` in `entries`.
    pub fn hessians_by_component(
        &mut self,
        states: &[T],
        entries: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let Some(mut turned) = self.bracket.take() else {
            return self.energy_hessians(Batch::new(states, entries, stride, count));
        };
        turned.gradients.resize(states.len(), T::int(0));
        turned
            .hessians
            .resize(turned.pattern.len() * stride, T::int(0));
        // With the bracket taken out, these are gradients of H.
        self.gradients_by_component(states, &mut turned.gradients, stride, count);
        self.energy_hessians(Batch::new(states, &mut turned.hessians, stride, count));
        turned.jacobians(states, entries, (stride, count));
        self.bracket = Some(turned);
    }

    fn energy_hessians(&mut self, batch: Batch<T>) {
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => {
                (ready::<T>().hessians_by_component)(traced, batch);
            }
            External(external) => external.hessians(batch),
        }
    }
}

/// The effect of rounding `y` in its last place.
fn round<T: Float>(y: &[T], off: &mut [T]) {
    let pairs = off.iter_mut().zip(y);
    pairs.for_each(|(off, &y)| *off = T::EPSILON * y.abs());
}

impl<T: Float> Turned<T> {
    /// Sets the points to (y, g, 0) for `count` states. The padding is finite.
    fn set(&mut self, (states, gradients): (&[T], &[T]), stride: usize, count: usize) {
        let len = states.len();
        self.points.resize(3 * len, T::int(0));
        let (y, rest) = self.points.split_at_mut(len);
        y.copy_from_slice(states);
        rest[len..].fill(T::int(0));
        let rows = rest
            .chunks_exact_mut(stride)
            .zip(gradients.chunks_exact(stride));
        for (to, from) in rows {
            to[..count].copy_from_slice(&from[..count]);
        }
    }

    /// Replaces ∇H at `count` states by w, component by component.
    fn turn(&mut self, states: &[T], gradients: &mut [T], stride: usize, count: usize) {
        self.set((states, gradients), stride, count);
        self.of_form.resize(self.points.len(), T::int(0));
        let batch = Batch::new(&self.points, &mut self.of_form, stride, count);
        (ready::<T>().gradients_by_component)(&mut self.form, batch);
        self.take(gradients, stride);
    }

    /// Replaces the error bounds of ∇H at `y` by those of w, from ∇H at `y`.
    fn turn_rounding(&mut self, y: &[T], off: &mut [T]) {
        let (n, zero) = (y.len(), T::int(0));
        let gradients = std::mem::take(&mut self.gradients);
        self.set((y, &gradients), 1, 1);
        self.gradients = gradients;
        self.of_form.resize(3 * n, zero);
        let (of_y, rest) = self.of_form.split_at_mut(n);
        round(y, of_y);
        rest[..n].copy_from_slice(off);
        rest[n..].fill(zero);
        (ready::<T>().gradient_rounding)(&mut self.form, &self.points, &mut self.of_form);
        self.take(off, 1);
        off.iter_mut().for_each(|x| *x = x.abs());
    }

    /// Computes w from the gradient of the form by λ.
    fn take(&self, w: &mut [T], stride: usize) {
        let n = w.len() / stride;
        for (c, w) in w.chunks_exact_mut(stride).enumerate() {
            let (from, sign) = turned::<T>(c, n);
            let results = &self.of_form[(2 * n + from) * stride..][..stride];
            for (w, &x) in w.iter_mut().zip(results) {
                *w = sign * x;
            }
        }
    }

    /// Computes the entries of w' from ∇H and the entries of ∇²H at `count` states, component by component.
    fn jacobians(&mut self, states: &[T], entries: &mut [T], (stride, count): (usize, usize)) {
        let gradients = std::mem::take(&mut self.gradients);
        self.set((states, &gradients), stride, count);
        self.gradients = gradients;
        let len = self.form.shared.structure.hessian.len() * stride;
        self.entries.resize(len, T::int(0));
        let batch = Batch::new(&self.points, &mut self.entries, stride, count);
        (ready::<T>().hessians_by_component)(&mut self.form, batch);
        let own = &self.entries;
        let of_form = &self.form.shared.structure.hessian;
        let (jacobian, n) = (
            self.of.jacobian(&self.pattern, of_form),
            self.pattern.dimension(),
        );
        for row in 0..n {
            let sign = turned::<T>(row, n).1;
            for (e, _) in self.of.structure.hessian.row(row) {
                let entry = &mut entries[e * stride..][..count];
                match jacobian.direct[e] {
                    Some(place) => entry.copy_from_slice(&own[place * stride..][..count]),
                    None => entry.fill(T::int(0)),
                }
                for &[b, h] in &jacobian.products[jacobian.starts[e]..jacobian.starts[e + 1]] {
                    let factors = own[b * stride..].iter().zip(&self.hessians[h * stride..]);
                    for (x, (&b, &h)) in entry.iter_mut().zip(factors) {
                        *x += b * h;
                    }
                }
                entry.iter_mut().for_each(|x| *x *= sign);
            }
        }
    }

    /// Replaces ∇²H·v in `product` by w'·v at `y`, from ∇H at `y`.
    fn turn_product(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        let gradients = std::mem::take(&mut self.gradients);
        self.set((y, &gradients), 1, 1);
        self.gradients = gradients;
        let n = y.len();
        self.along.resize(3 * n, T::int(0));
        self.along[..n].copy_from_slice(v);
        self.along[n..2 * n].copy_from_slice(product);
        self.of_form.resize(3 * n, T::int(0));
        let (form, points, results) = (&mut self.form, &self.points, &mut self.of_form);
        (ready::<T>().hessian_vector)(form, points, &self.along, results);
        self.take(product, 1);
    }
}
