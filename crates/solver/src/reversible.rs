//! [`Reversible`]: variable steps that are the same backwards.
//!
//! Step control by tolerance is not symmetric: the size comes from the step before. For long runs of reversible systems there is the explicit symmetric
//! control of Hairer & Söderlind (SIAM J. Sci. Comput. 26, 2005; Hairer, Lubich & Wanner, VIII.3.2): the step density z ≈ 1/σ is integrated beside the
//! state,
//!
//! $$ z_{n+1/2} = z_{n-1/2} + \varepsilon G(y_n), \qquad G = -\frac{\nabla\sigma\cdot f}{\sigma}, \qquad h_{n+1/2} = \frac{\varepsilon}{z_{n+1/2}}, \qquad
//!    z_{1/2} = \frac{1}{\sigma(y_0)} + \frac{\varepsilon}{2} G(y_0), $$
//!
//! with steps h ≈ ε σ(y). No step is refused for its error: ε is the accuracy, chosen once.

use crate::error::IntegrateError;
use crate::event::Event;
use crate::invariant::Invariant;
use crate::method::Method;
use crate::options::{FixedStep, OnNoAlpha, Record, StageSolver};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// A method with steps of about ε σ(q, p), chosen symmetrically in time.
#[derive(Debug, Clone)]
pub struct Reversible<T: Float> {
    pub(crate) base: FixedStep<T>,
    pub(crate) epsilon: T,
    pub(crate) sigma: Hamiltonian,
}

impl Method {
    /// An integrator with steps of about ε σ(q, p), chosen so that the run backwards takes the same ones. `sigma` is a positive function of the state, recorded
    /// like an energy ([`Hamiltonian::new`]), even in p.
    pub fn reversible<T: Float>(self, epsilon: T, sigma: Hamiltonian) -> Reversible<T> {
        Reversible {
            base: FixedStep::new(self, T::int(1)),
            epsilon,
            sigma,
        }
    }
}

macro_rules! pass_on {
    ($($name:ident($argument:ident: $type:ty)),* $(,)?) => {$(
        #[doc = concat!("See [`FixedStep::", stringify!($name), "`].")]
        #[must_use]
        pub fn $name(mut self, $argument: $type) -> Self {
            self.base = self.base.$name($argument);
            self
        }
    )*};
}

impl<T: Float> Reversible<T> {
    pass_on!(
        on_no_alpha(choice: OnNoAlpha),
        alpha_bound(bound: T),
        max_iterations(iterations: u32),
        max_halvings(halvings: u32),
        stage_solver(solver: StageSolver),
        measure_energy(measure: bool),
        invariant(invariant: Invariant),
        keep(invariant: Invariant),
        record(record: Record),
        event(event: Event<T>),
    );

    /// See [`FixedStep::dense`].
    #[must_use]
    pub fn dense(mut self) -> Self {
        self.base = self.base.dense();
        self
    }

    /// Times at which the state is wanted besides the steps; see [`Adaptive::output_at`](crate::Adaptive::output_at).
    #[must_use]
    pub fn output_at(mut self, times: &[T]) -> Self {
        self.base = self.base.output_at(times);
        self
    }

    /// Checks everything that does not need the Hamiltonian.
    pub(crate) fn validate(&self) -> Result<(), IntegrateError<T>> {
        let epsilon = self.epsilon;
        if epsilon > T::int(0) && epsilon.is_finite() {
            self.base.validate().map(|_| ())
        } else {
            Err(IntegrateError::Option {
                option: "epsilon",
                value: epsilon,
                expected: "positive and finite",
            })
        }
    }

    /// What has to be the same again for a checkpoint to fit.
    pub(crate) fn fingerprint(&self) -> String {
        let common = self.base.common_fingerprint();
        format!("reversible, epsilon {:?}; {common}", self.epsilon)
    }
}
