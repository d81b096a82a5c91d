//! How the residual of a step grows until the end of the step.
//!
//! The motion leaves the polynomial of a step by γ_s P_s + …. This residual affects the end point through the
//! component of the flow's derivative Φ along the step that is orthogonal to polynomials of degree below s:
//!
//! $$ \Phi_s = \sqrt{2s+1}\, \frac{(z/2)^s}{(2s+1)!!} , \qquad
//!    z^2 = \frac{\lVert (h J \nabla^2 H)^2 d \rVert}{\lVert d \rVert} , $$
//!
//! Here d is the residual. For a free oscillator Φ_s = ϱ^s, the decay of the motion itself
//! ([`crate::control::estimate`]). If a system is driven more slowly than it oscillates, Φ_s is larger, and
//! an extrapolation from the motion alone is too small by a factor of 10² to 10⁶. If ∇²H rotates with the
//! motion, as on a circle, Φ contains both. Φ_s^{1/s} is proportional to z, so with both
//!
//! $$ \mathrm{est} = \varrho^s \big( \varrho^2 + \Phi_s^{2/s} \big)^{s/2} . $$
//!
//! The contraction of the fixed-point iteration is z/(1.33 s + 0.7); twice this expression bounds z. If steps
//! are no longer than the size with the least work, Φ_s is below the tolerance, and nothing is evaluated.
//!
//! Φ_s is not computed from coefficients that are rounding, nor for tolerances at round-off level.
//!
//! Cost: two products with ∇²H, for steps that fixed-point iteration solves slowly or not at all.

use crate::control::estimate::Decay;
use equip_autodiff::Evaluator;
use equip_scalar::Float;
use equip_scalar::power::power;

/// Workspace for Φ_s.
#[derive(Debug)]
pub(crate) struct Flow<T> {
    s: usize,
    d: Vec<T>,
    product: Vec<T>,
}

impl<T: Float> Flow<T> {
    /// For steps with s stages and states with n components.
    pub(crate) fn new(s: usize, n: usize) -> Self {
        let zeros = || vec![T::int(0); n];
        Flow {
            s,
            d: zeros(),
            product: zeros(),
        }
    }

    /// Φ_s^{1/s} of the last estimated step, of size `h`, which ends at `y`; zero if it is not finite.
    pub(crate) fn decay(
        &mut self,
        energy: &mut Evaluator<T>,
        (y, h): (&[T], T),
        estimated: &Decay<T>,
    ) -> f64 {
        estimated.residual(&mut self.d);
        let before = estimated.in_units(&self.d);
        for _ in 0..2 {
            energy.jacobian_vector(y, &self.d, &mut self.product);
            std::mem::swap(&mut self.d, &mut self.product);
            self.d.iter_mut().for_each(|x| *x *= h);
        }
        let z = (estimated.in_units(&self.d) / before).sqrt();
        if z.is_finite() { self.of(z) } else { 0.0 }
    }

    /// An upper bound of Φ_s^{1/s} from the contraction of the iterations of the step.
    pub(crate) fn most(&self, contraction: f64) -> f64 {
        let s = self.s as f64;
        self.of(2.0 * (1.33 * s + 0.7) * contraction)
    }

    /// Φ_s^{1/s} for this z, at most 1, since faster motion is not resolved.
    fn of(&self, z: f64) -> f64 {
        let factors = (1..=self.s).map(|j| z / 2.0 / (2 * j + 1) as f64);
        let product = factors.product::<f64>() * ((2 * self.s + 1) as f64).sqrt();
        power(product, 1.0 / self.s as f64).min(1.0)
    }
}
