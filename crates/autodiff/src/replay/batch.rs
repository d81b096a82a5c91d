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

impl<'a> Batch<'a, f64> {
    /// `None` if the numbers are not `f64`.
    #[inline(always)]
    pub(crate) fn of_doubles<T: Float>(
        states: &'a [T],
        gradients: &'a mut [T],
        stride: usize,
        count: usize,
    ) -> Option<Self> {
        Some(Batch {
            states: T::as_doubles(states)?,
            gradients: T::as_doubles_mut(gradients)?,
            stride,
            count,
        })
    }
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

    /// The same batch, reborrowed.
    pub(crate) fn reborrow(&mut self) -> Batch<'_, T> {
        Batch {
            states: self.states,
            gradients: &mut *self.gradients,
            stride: self.stride,
            count: self.count,
        }
    }

    /// The same batch if the numbers are doubles.
    pub(crate) fn in_doubles(&mut self) -> Option<Batch<'_, f64>> {
        Batch::of_doubles(self.states, &mut *self.gradients, self.stride, self.count)
    }
}
