//! [`Batch`]: points component by component, with their derivatives.

use equip_scalar::Float;

/// Points component by component.
#[derive(Debug)]
pub(crate) struct Batch<'a, T> {
    pub(crate) states: &'a [T],
    pub(crate) gradients: &'a mut [T],
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

impl<T: Float> Batch<'_, T> {
    /// A single point.
    pub(crate) fn one<'a>(state: &'a [T], gradient: &'a mut [T]) -> Batch<'a, T> {
        Batch {
            states: state,
            gradients: gradient,
            stride: 1,
            count: 1,
        }
    }

    /// The same batch if the numbers are doubles.
    #[inline(always)]
    pub(crate) fn in_doubles(&mut self) -> Option<Batch<'_, f64>> {
        Some(Batch {
            states: T::as_doubles(self.states)?,
            gradients: T::as_doubles_mut(self.gradients)?,
            stride: self.stride,
            count: self.count,
        })
    }
}
