//! [`Fixed`]: steps of one size.

use crate::error::IntegrateError;
use crate::options::common::{Words, in_digits};
use equip_scalar::Float;

/// Steps of one size for the complete run. The last one is shorter if the size does not divide the interval.
#[derive(Debug, Clone)]
pub(crate) struct Fixed<T> {
    pub(crate) h: T,
}

impl<T: Float> Fixed<T> {
    pub(crate) fn validate(&self) -> Result<(), IntegrateError<T>> {
        if self.h != T::int(0) && self.h.is_finite() {
            Ok(())
        } else {
            Err(IntegrateError::StepOutOfRange { step: self.h })
        }
    }

    pub(crate) fn words(&self) -> Words {
        vec![
            ("steps", "of one size".to_owned()),
            ("step", in_digits(self.h.abs())),
        ]
    }
}
