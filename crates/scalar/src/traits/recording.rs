//! [`Recording`]: the number type that traces operations. It has no value.
//!
//! A trace is replayed at other states. If the energy had branched on a comparison, the replay would silently
//! use the wrong branch. Other [`Num`]s have no comparisons. The tracing [`Num`] has comparisons only to
//! report them: each stores the file and line of its caller and returns `false` (or NaN), and the trace is
//! then rejected.

use super::scalar::Scalar;
use crate::num::Num;
use std::cmp::Ordering;
use std::panic::Location;

/// An invalid operation on a number that has no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attempt {
    /// A comparison: `q[0] < 1.0`, `a == b`, `a.partial_cmp(&b)`.
    Comparison,
    /// A read-out: `f64::from(x)`, `x.value()`, `x.is_nan()`.
    ReadOut,
}

/// A [`Scalar`] without a value. Only the tracing variable implements it.
pub trait Recording: Scalar {
    /// Notes the attempt and its place, so that the recording is refused when it ends.
    fn refuse(attempt: Attempt, location: &'static Location<'static>);
}

// One macro writes both traits for a pair of types, so that every method carries `#[track_caller]`: a default
// method of `core` would report the line in `core`.
macro_rules! refuse_comparison {
    ($left:ty, $right:ty) => {
        #[allow(clippy::partialeq_ne_impl)]
        impl<S: Recording> PartialEq<$right> for $left {
            #[track_caller]
            fn eq(&self, _: &$right) -> bool {
                refused::<S>(Attempt::Comparison)
            }
            #[track_caller]
            fn ne(&self, _: &$right) -> bool {
                refused::<S>(Attempt::Comparison)
            }
        }

        impl<S: Recording> PartialOrd<$right> for $left {
            #[track_caller]
            fn partial_cmp(&self, _: &$right) -> Option<Ordering> {
                refused::<S>(Attempt::Comparison);
                None
            }
            #[track_caller]
            fn lt(&self, _: &$right) -> bool {
                refused::<S>(Attempt::Comparison)
            }
            #[track_caller]
            fn le(&self, _: &$right) -> bool {
                refused::<S>(Attempt::Comparison)
            }
            #[track_caller]
            fn gt(&self, _: &$right) -> bool {
                refused::<S>(Attempt::Comparison)
            }
            #[track_caller]
            fn ge(&self, _: &$right) -> bool {
                refused::<S>(Attempt::Comparison)
            }
        }
    };
}
refuse_comparison!(Num<S>, Num<S>);
refuse_comparison!(Num<S>, f64);
refuse_comparison!(f64, Num<S>);

#[track_caller]
fn refused<S: Recording>(attempt: Attempt) -> bool {
    S::refuse(attempt, Location::caller());
    false
}

impl<S: Recording> From<Num<S>> for f64 {
    #[track_caller]
    fn from(_: Num<S>) -> f64 {
        refused::<S>(Attempt::ReadOut);
        f64::NAN
    }
}

/// Read-outs people reach for. They exist on the recording variable only, compile there, and make the
/// recording fail with the place they stand at.
impl<S: Recording> Num<S> {
    /// Rejected: a variable has no value while H is traced. Returns NaN.
    #[track_caller]
    pub fn value(self) -> f64 {
        f64::from(self)
    }

    /// Rejected: a variable has no value while H is traced. Returns NaN.
    #[track_caller]
    pub fn to_f64(self) -> f64 {
        f64::from(self)
    }

    /// Rejected: a variable has no value while H is traced. Returns `false`.
    #[track_caller]
    pub fn is_nan(self) -> bool {
        refused::<S>(Attempt::ReadOut)
    }

    /// Rejected: a variable has no value while H is traced. Returns `false`.
    #[track_caller]
    pub fn is_finite(self) -> bool {
        refused::<S>(Attempt::ReadOut)
    }

    /// Rejected: a variable has no sign while H is traced. Returns `false`.
    #[track_caller]
    pub fn is_sign_negative(self) -> bool {
        refused::<S>(Attempt::ReadOut)
    }
}
