//! Functions that are compiled once, with their crate, and not again in each crate that uses them.
//!
//! Generic code is compiled where it is used. For an integrator, with its kernels for every instruction set,
//! this takes a minute. Such code is therefore called through a table of functions, generic in the float
//! type. A crate builds one table for doubles and one for double-doubles, and constants select the table, so
//! that nothing is compiled elsewhere for these types.
//!
//! Cost: an indirect call.

use std::any::Any;

/// Makes the two of a table with a constant `HERE`, and `ready::<T>()`, which gives the one for a float type.
///
/// ```
/// use equip_scalar::{Float, ready};
/// pub(crate) struct Table<T> {
///     epsilon: fn() -> T,
/// }
/// impl<T: Float> Table<T> {
///     const HERE: Self = Table { epsilon: || T::EPSILON };
/// }
/// ready!(Table);
/// assert!(std::ptr::eq(ready::<f64>(), &IN_DOUBLES)); // not another one, compiled anew
/// assert_eq!((ready::<f64>().epsilon)(), f64::EPSILON);
/// ```
#[doc(hidden)]
#[macro_export]
macro_rules! ready {
    ($table:ident) => {
        #[cfg(not(test))]
        static IN_DOUBLES: $table<f64> = $table::HERE;
        #[cfg(not(test))]
        static IN_DOUBLE_DOUBLES: $table<$crate::DoubleDouble> = $table::HERE;

        /// The functions for this float type.
        #[cfg(not(test))]
        pub(crate) fn ready<T: $crate::Float>() -> &'static $table<T> {
            if const { T::IS_DOUBLE } {
                $crate::same(&IN_DOUBLES)
            } else if const { T::IS_DOUBLE_DOUBLE } {
                $crate::same(&IN_DOUBLE_DOUBLES)
            } else {
                const { &$table::HERE }
            }
        }

        /// The same: unit tests compile what they use, and no table.
        #[cfg(test)]
        pub(crate) fn ready<T: $crate::Float>() -> &'static $table<T> {
            const { &$table::HERE }
        }
    };
}

/// `x`, under the second name of its type.
///
/// # Panics
/// If the two types differ.
#[doc(hidden)]
#[inline(always)]
pub fn same<A: Any, B: Any>(x: &A) -> &B {
    match (x as &dyn Any).downcast_ref() {
        Some(x) => x,
        None => panic!("the constants of a float type say which it is"),
    }
}
