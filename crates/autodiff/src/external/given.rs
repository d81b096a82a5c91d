//! [`Given`]: a user-supplied gradient, in doubles.

use super::check::{at_or_near, compare};
use crate::WrongGradient;
use crate::replay::batch::Batch;
use crate::replay::point::{Points, check_components};
use equip_scalar::Float;
use std::fmt;
use std::sync::Arc;

type Gradient = dyn Fn(&[f64], &[f64], &mut [f64], &mut [f64]) + Send + Sync;

/// `gradient(q, p, dq, dp)` writes ∂H/∂q into `dq` and ∂H/∂p into `dp`.
#[derive(Clone)]
pub(crate) struct GivenGradient(pub(crate) Arc<Gradient>);

impl fmt::Debug for GivenGradient {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("GivenGradient(..)")
    }
}

impl GivenGradient {
    /// ∇H at y = (q, p), both slices of length n = 2m.
    pub(crate) fn at(&self, y: &[f64], gradient: &mut [f64]) {
        let (q, p) = y.split_at(y.len() / 2);
        let (dq, dp) = gradient.split_at_mut(q.len());
        (self.0)(q, p, dq, dp);
    }
}

/// The gradient with its workspace. For other float types its argument and its result are rounded to doubles.
#[derive(Debug, Clone)]
pub(crate) struct Given<T> {
    gradient: GivenGradient,
    state: Vec<f64>,
    derivative: Vec<f64>,
    points: Points<T>,
}

impl<T: Float> Given<T> {
    pub(crate) fn new(gradient: &GivenGradient, n: usize) -> Self {
        Given {
            gradient: gradient.clone(),
            state: vec![0.0; n],
            derivative: vec![0.0; n],
            points: Points::default(),
        }
    }

    /// `y` in doubles. If `y` contains the positions only, the momenta are 0.
    pub(crate) fn in_doubles(&mut self, y: &[T]) -> &[f64] {
        let (given, missing) = self.state.split_at_mut(y.len());
        given.iter_mut().zip(y).for_each(|(x, y)| *x = y.to_f64());
        missing.fill(0.0);
        &self.state
    }

    /// The last state in doubles.
    pub(crate) fn state(&self) -> &[f64] {
        &self.state
    }

    /// ∇H at `y`, length n.
    ///
    /// # Panics
    /// If `y` or `gradient` has another length.
    pub(crate) fn at(&mut self, y: &[T], gradient: &mut [T]) {
        check_components(self.state.len(), &[y.len(), gradient.len()]);
        self.in_doubles(y);
        self.gradient.at(&self.state, &mut self.derivative);
        let derivatives = gradient.iter_mut().zip(&self.derivative);
        derivatives.for_each(|(derivative, &x)| *derivative = T::exact(x));
    }

    /// ∇H at several states, one after the other.
    pub(crate) fn one_by_one(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            self.at(y, gradient);
        }
    }

    /// ∇H at several states, component by component.
    pub(crate) fn by_component(&mut self, batch: Batch<T>) {
        batch.check([self.state.len(); 2]);
        self.each(batch);
    }

    /// ∇H at each point of a batch with all n components or the positions alone.
    pub(crate) fn each(&mut self, batch: Batch<T>) {
        let mut points = std::mem::take(&mut self.points);
        let lengths = [self.state.len(); 2];
        points.each(batch, lengths, |y, derivative| self.at(y, derivative));
        self.points = points;
    }

    /// Compares the gradient with `expected` at `y`.
    pub(crate) fn check(
        &mut self,
        y: &[T],
        mut expected: impl FnMut(&[T], &mut [T]),
    ) -> Result<(), WrongGradient<T>> {
        let (mut given, mut right) = (y.to_vec(), y.to_vec());
        at_or_near(y, |y| {
            self.at(y, &mut given);
            expected(y, &mut right);
            compare(&given, &right)
        })
    }
}
