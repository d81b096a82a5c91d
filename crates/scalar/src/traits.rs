//! The traits of number types.

mod derivatives;
mod digits;
mod float;
pub(crate) mod half_power;
mod outside;
mod pack;
mod recording;
mod scalar;

pub use derivatives::FirstOrder;
pub use digits::plain;
pub use float::Float;
pub(crate) use float::scalar_glue;
pub use outside::Outside;
pub use pack::Pack;
pub use recording::{Attempt, Recording};
pub use scalar::Scalar;
