//! [`Reversible`]: variable steps that are the same backwards.
//!
//! Step control by tolerance is not symmetric: the size comes from the step before. For long runs of
//! reversible systems there is the explicit symmetric control of Hairer & Söderlind (SIAM J. Sci. Comput. 26,
//! 2005; Hairer, Lubich & Wanner, VIII.3.2): the step density z ≈ 1/σ is integrated beside the state,
//!
//! $$ z_{n+1/2} = z_{n-1/2} + \varepsilon G(y_n), \qquad G = -\frac{\nabla\sigma\cdot f}{\sigma}, \qquad h_{n+1/2} = \frac{\varepsilon}{z_{n+1/2}}, \qquad
//!    z_{1/2} = \frac{1}{\sigma(y_0)} + \frac{\varepsilon}{2} G(y_0), $$
//!
//! with steps h ≈ ε σ(y). The other rule remembers nothing: the size solves
//!
//! $$ h \sum_i \frac{b_i}{\sigma(Y_i)} = \varepsilon , $$
//!
//! the quadrature of ∫ dt/σ = ε over the step's own stages, which are the same backwards. It is solved by a
//! secant around the stages, from the size of the explicit rule.
//!
//! No step is refused for its error: ε is the accuracy, chosen once. σ is a function of the state or, by
//! default, made from ∇²H ([`crate::control::step_density`]).

use crate::error::IntegrateError;
use crate::options::common::check;
use crate::options::integrator::Integrator;
use crate::options::method::Method;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// How reversible steps get their sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum StepRule {
    /// From the size before and the motion between: one evaluation of ∇σ per step.
    #[default]
    Explicit,
    /// From the stages of the step itself, h Σ b_i/σ(Y_i) = ε: several solves of the stages per step, no
    /// memory.
    Integral,
}

/// A method with steps of about ε σ(q, p), chosen symmetrically in time. [`Integrator::output_at`] is served
/// from dense output.
pub type Reversible<T> = Integrator<T, Symmetric<T>>;

/// Sizes of about ε σ(q, p).
#[derive(Debug, Clone)]
pub struct Symmetric<T> {
    pub(crate) epsilon: T,
    /// `None` for the automatic one.
    pub(crate) sigma: Option<Hamiltonian>,
    pub(crate) rule: StepRule,
}

impl Method {
    /// An integrator with steps of about ε σ(q, p), chosen so that the run backwards takes the same ones.
    /// `sigma` is a positive function of the state, recorded like an energy ([`Hamiltonian::new`], or
    /// [`Hamiltonian::with_time`] where H is), even in p.
    pub fn reversible<T: Float>(self, epsilon: T, sigma: Hamiltonian) -> Reversible<T> {
        let sigma = Some(sigma);
        Integrator::new(self, Symmetric::new(epsilon, sigma))
    }

    /// The same with σ from the second derivatives of H: 1/σ is the pace of the fastest linearised motion,
    /// and ε the phase it turns by in a step (6.3 / ε steps a turn). For at most 256 degrees of freedom, and
    /// for motion that is nowhere free: 1/σ must not vanish.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::Equip;
    ///
    /// let kepler = Hamiltonian::new(2, |q, p| {
    ///     0.5 * (p[0].powi(2) + p[1].powi(2)) - (q[0].powi(2) + q[1].powi(2)).sqrt().recip()
    /// })?;
    /// let run = Equip::stages(6)
    ///     .reversible_automatic(0.5)
    ///     .integrate(&kepler, &[0.4, 0.0], &[0.0, 2.0], 0.0..=10.0)?;
    /// assert!(run.certificate().energy_kept_on_every_step());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reversible_automatic<T: Float>(self, epsilon: T) -> Reversible<T> {
        let sigma = None;
        Integrator::new(self, Symmetric::new(epsilon, sigma))
    }
}

impl<T: Float> Reversible<T> {
    /// How steps get their sizes; [`StepRule::Explicit`] by default. With the integral rule no step is
    /// halved.
    #[must_use]
    pub fn rule(mut self, rule: StepRule) -> Self {
        self.sizes.rule = rule;
        if rule == StepRule::Integral {
            // The rule is about the stages of one step.
            self.options.max_halvings = 0;
        }
        self
    }

    /// How often a step that fails may be halved, 10 by default; 0 never halves.
    #[must_use]
    pub fn max_halvings(mut self, halvings: u32) -> Self {
        self.options.max_halvings = halvings;
        self
    }
}

impl<T: Float> Symmetric<T> {
    fn new(epsilon: T, sigma: Option<Hamiltonian>) -> Self {
        Symmetric {
            epsilon,
            sigma,
            rule: StepRule::default(),
        }
    }

    pub(crate) fn validate(&self) -> Result<(), IntegrateError<T>> {
        let epsilon = self.epsilon;
        let ok = epsilon > T::int(0) && epsilon.is_finite();
        check(ok, "epsilon", epsilon, "positive and finite")
    }
}
