//! [`Recording`]: the number that records what is done with it, and refuses to be looked at.
//!
//! A recorded energy is replayed at other states than the one it was recorded at; had it branched on a
//! comparison, the replay would silently take the wrong branch. Ordinary [`Num`]s have no comparison at all.
//! The recording one has them only to say where they stand: each notes the caller's file and line and answers
//! `false` (or NaN), and the recording as a whole is then refused.

use super::scalar::Scalar;
use crate::num::Num;
use std::cmp::Ordering;
use std::panic::Location;

/// What was attempted with a number that has no value yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attempt {
    /// A comparison: `q[0] < 1.0`, `a == b`, `a.partial_cmp(&b)`.
    Comparison,
    /// A read-out: `f64::from(x)`, `x.value()`, `x.is_nan()`.
    ReadOut,
}

/// A [`Scalar`] that stands for a value not known yet. Implemented by the tracing variable of the tape only.
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
    /// Refused: a variable being recorded has no value. Returns NaN.
    #[track_caller]
    pub fn value(self) -> f64 {
        f64::from(self)
    }

    /// Refused: a variable being recorded has no value. Returns NaN.
    #[track_caller]
    pub fn to_f64(self) -> f64 {
        f64::from(self)
    }

    /// Refused: a variable being recorded has no value. Returns `false`.
    #[track_caller]
    pub fn is_nan(self) -> bool {
        refused::<S>(Attempt::ReadOut)
    }

    /// Refused: a variable being recorded has no value. Returns `false`.
    #[track_caller]
    pub fn is_finite(self) -> bool {
        refused::<S>(Attempt::ReadOut)
    }

    /// Refused: a variable being recorded has no sign. Returns `false`.
    #[track_caller]
    pub fn is_sign_negative(self) -> bool {
        refused::<S>(Attempt::ReadOut)
    }
}
