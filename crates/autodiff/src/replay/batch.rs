//! [`Batch`]: points component by component, with their derivatives.

use equip_scalar::Float;

/// Points component by component: component c of point i is at `c·stride + i`.
#[derive(Debug)]
pub(crate) struct Batch<'a, T> {
    pub(crate) states: &'a [T],
    pub(crate) gradients: &'a mut [T],
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

impl<'a, T: Float> Batch<'a, T> {
    pub(crate) fn new(
        states: &'a [T],
        gradients: &'a mut [T],
        stride: usize,
        count: usize,
    ) -> Self {
        Batch {
            states,
            gradients,
            stride,
            count,
        }
    }

    /// A single point.
    pub(crate) fn one(state: &'a [T], gradient: &'a mut [T]) -> Self {
        Batch::new(state, gradient, 1, 1)
    }

    /// # Panics
    /// If there are not so many components, and so many results for each point.
    #[inline(always)]
    pub(crate) fn check(&self, [components, results]: [usize; 2]) {
        let lengths = [self.states.len(), self.gradients.len()];
        assert!(
            lengths == [components, results].map(|rows| rows * self.stride)
                && self.count <= self.stride,
            "a state of this system has {components} components and {results} results, with room for {} points each",
            self.count
        );
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
