//! The functions that depend on the float type alone, compiled once with this crate for `f64` and
//! double-double ([`equip_scalar::ready!`]).

use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::{Held, Preconditioner};
use crate::linear::linear_iteration::{LinearIteration, Sides};
use equip_autodiff::Pattern;
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// The functions by name.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
pub(crate) struct Ready<T: Float> {
    pub(crate) linear: fn(&Coefficients<T>, &Iterate<T>, Pattern, usize) -> LinearIteration<T>,
    pub(crate) weigh: fn(&mut LinearIteration<T>, &Iterate<T>) -> bool,
    pub(crate) is_within: fn(&mut LinearIteration<T>, f64) -> bool,
    pub(crate) solve: fn(&mut LinearIteration<T>, Held, Sides<'_, T>, &Iterate<T>, Option<&mut (dyn Preconditioner<T> + '_)>) -> bool,
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        linear: LinearIteration::make,
        weigh: LinearIteration::weigh,
        is_within: LinearIteration::bounds_angle,
        solve: LinearIteration::iterate,
    };
}

equip_scalar::ready!(Ready);
