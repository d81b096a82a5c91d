//! How what a step has missed grows on the way to its end.
//!
//! The motion leaves the polynomial of a step by γ_s P_s + …; to the end point that is passed by what the
//! flow's derivative Φ along the step is orthogonal to polynomials of degree below s, with
//!
//! $$ \Phi_s = \sqrt{2s+1}\, \frac{(z/2)^s}{(2s+1)!!} , \qquad
//!    z^2 = \frac{\lVert (h J \nabla^2 H)^2 d \rVert}{\lVert d \rVert} , $$
//!
//! d being what it leaves it by. Of a free oscillator Φ_s is the ϱ^s by which the motion itself decays
//! ([`crate::control::estimate`]). Where a system is pushed slower than it would swing it is more, and what
//! is extrapolated from the motion alone is 10² to 10⁶ times too small. Where ∇²H turns with the motion, as
//! on a circle, Φ turns by both. Φ_s^{1/s} is proportional to z, so that with both
//!
//! $$ \mathrm{est} = \varrho^s \big( \varrho^2 + \Phi_s^{2/s} \big)^{s/2} . $$
//!
//! Fixed-point iterations contract by z over 1.33 s + 0.7, twice which bounds z: where steps are no longer
//! than iterations cost least for, Φ_s is below what the tolerance asks for, and nothing is evaluated.
//!
//! Nothing is made of rounding, nor for tolerances that are rounding.
//!
//! Cost: two products with ∇²H, of steps that fixed-point iteration does not solve, or slowly.

use crate::control::estimate::Decay;
use equip_autodiff::Evaluator;
use equip_scalar::Float;
use equip_scalar::power::power;

/// Workspace for it.
#[derive(Debug)]
pub(crate) struct Flow<T> {
    s: usize,
    d: Vec<T>,
    product: Vec<T>,
}

impl<T: Float> Flow<T> {
    /// Of steps with s stages of states with n components.
    pub(crate) fn new(s: usize, n: usize) -> Self {
        let zeros = || vec![T::int(0); n];
        Flow {
            s,
            d: zeros(),
            product: zeros(),
        }
    }

    /// Φ_s^{1/s} of the step of size `h` to `y` that was estimated last; zero where it is not finite.
    pub(crate) fn decay(
        &mut self,
        energy: &mut Evaluator<T>,
        (y, h): (&[T], T),
        estimated: &Decay<T>,
    ) -> f64 {
        estimated.defect(&mut self.d);
        let before = estimated.in_units(&self.d);
        for _ in 0..2 {
            energy.jacobian_vector(y, &self.d, &mut self.product);
            std::mem::swap(&mut self.d, &mut self.product);
            self.d.iter_mut().for_each(|x| *x *= h);
        }
        let z = (estimated.in_units(&self.d) / before).sqrt();
        if z.is_finite() { self.of(z) } else { 0.0 }
    }

    /// No less than that, by the contraction of the iterations of the step.
    pub(crate) fn most(&self, contraction: f64) -> f64 {
        let s = self.s as f64;
        self.of(2.0 * (1.33 * s + 0.7) * contraction)
    }

    /// Φ_s^{1/s}, at most 1: faster motion is passed over.
    fn of(&self, z: f64) -> f64 {
        let factors = (1..=self.s).map(|j| z / 2.0 / (2 * j + 1) as f64);
        let product = factors.product::<f64>() * ((2 * self.s + 1) as f64).sqrt();
        power(product, 1.0 / self.s as f64).min(1.0)
    }
}
