//! The initial guess of a step: Z = 0, or the extrapolation from the last step.

use crate::extrapolation::gradients::{Extrapolate, Resolve, Sizes};
use crate::extrapolation::polynomial::Polynomial;
use crate::iterate::iterate::Iterate;
use crate::layout::state::State;
use equip_scalar::Float;
use equip_tableau::Coefficients;
use std::ops::Range;

impl<T: Float> Iterate<T> {
    /// Begins a step of size `h` from `y` with Z = 0.
    pub(crate) fn begin_at_zero(&mut self, method: &Coefficients<T>, (y, h): (&State<T>, T)) {
        self.set_step(method, h);
        let len = self.unknowns() * self.stride;
        self.z[..len].fill(T::int(0));
        self.has_momenta = false;
        self.place(y);
        // Stage momenta that are not unknowns do not exist yet. They are set to the momenta at the start.
        let (unknowns, stride) = (self.unknowns(), self.stride);
        let momenta = self.points[len..].chunks_exact_mut(stride);
        momenta
            .zip(&y.hi[unknowns..])
            .for_each(|(row, &p)| row.fill(p));
        self.measure(y, 0..self.n);
        (self.is_measured, self.is_incremental, self.z_is_k_l) = (false, false, true);
    }

    /// Begins a step of size `h` from `y`, `ratio` times as long as the last step, with the stages
    /// extrapolated by the polynomial of the last step. `known` is ∇H at `y`.
    pub(crate) fn begin_from_polynomial(
        &mut self,
        method: &Coefficients<T>,
        (y, h, ratio): (&State<T>, T, T),
        polynomial: &Polynomial<T>,
        known: Option<&[T]>,
    ) {
        self.set_step(method, h);
        std::mem::swap(&mut self.l, &mut self.l_before);
        (self.is_measured, self.is_incremental, self.z_is_k_l) = (true, false, true);
        self.has_momenta = true;
        let wanted = self.unknowns();
        self.set.run(&mut Extrapolate {
            prolongation: polynomial.view(),
            l: &self.l_before,
            known,
            gradients: &mut self.gradients,
            hb: &self.hb,
            ratio,
            m: self.n / 2,
            wanted,
            s: self.s,
        });
        self.mix(y);
        self.measure(y, 0..self.n);
    }

    pub(crate) fn set_step(&mut self, method: &Coefficients<T>, h: T) {
        if self.h != h {
            self.h = h;
            for (hb, &b) in self.hb.iter_mut().zip(method.weights()) {
                *hb = h * b;
            }
        }
        if std::mem::take(&mut self.k_has_moved) {
            self.k.copy_from_slice(&self.k_start);
        }
    }

    /// Measures the sizes of `components` from their stages.
    pub(crate) fn measure(&mut self, y: &State<T>, components: Range<usize>) {
        let stride = self.stride;
        self.set.run(&mut Sizes {
            hi: &y.hi[components.clone()],
            points: &self.points[components.start * stride..components.end * stride],
            scale: &mut self.scale[components.clone()],
            s: self.s,
        });
        self.set.run(&mut Resolve {
            scale: &mut self.scale,
            inverse: &mut self.inverse_scale,
            components,
        });
    }
}
