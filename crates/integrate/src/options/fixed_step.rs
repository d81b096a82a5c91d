//! [`FixedStep`]: steps of one size.

use crate::error::IntegrateError;
use crate::options::integrator::Integrator;
use crate::options::method::Method;
use equip_scalar::Float;

/// A method with a fixed step: fixed for the whole run, the last step shorter if it does not divide the
/// interval.
pub type FixedStep<T> = Integrator<T, Fixed<T>>;

/// Steps of one size.
#[derive(Debug, Clone)]
pub struct Fixed<T> {
    pub(crate) h: T,
}

impl Method {
    /// An integrator with the fixed step `h`, in the float type of `h`. A run over an interval goes its way
    /// with steps of |h|, back in time too, and with h < 0 back only; one that is started and made step by
    /// step goes back in time if h < 0.
    pub fn step<T: Float>(self, h: T) -> FixedStep<T> {
        Integrator::new(self, Fixed { h })
    }
}

impl<T: Float> FixedStep<T> {
    /// How often a step whose stages do not converge may be halved, 10 by default; 0 never halves.
    #[must_use]
    pub fn max_halvings(mut self, halvings: u32) -> Self {
        self.options.max_halvings = halvings;
        self
    }
}

impl<T: Float> Fixed<T> {
    pub(crate) fn validate(&self) -> Result<(), IntegrateError<T>> {
        if self.h != T::int(0) && self.h.is_finite() {
            Ok(())
        } else {
            Err(IntegrateError::StepOutOfRange { step: self.h })
        }
    }
}
