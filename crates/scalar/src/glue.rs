//! One glue between our float types and num-traits, num-dual and nalgebra.

/// What num-dual asks of the float below its dual numbers.
pub trait DualFloat: num_dual::DualNum<Primitive = Self> + num_dual::DualNumFloat {}

impl<T: num_dual::DualNum<Primitive = T> + num_dual::DualNumFloat> DualFloat for T {}
