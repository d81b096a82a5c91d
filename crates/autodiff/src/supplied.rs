//! [`Supplied`]: a recorded energy with a gradient closure over `f64`, used whenever the float is `f64`.

use crate::point::{Points, check_batch, require_separable};
use crate::{Evaluate, Kinetic, Recorded, RecordedEvaluator, Structure, System};
use equip_scalar::{Float, InstructionSet};
use std::any::TypeId;
use std::sync::Arc;

/// A recorded energy with a hand-written gradient; made by
/// [`Hamiltonian::with_gradient`](crate::Hamiltonian::with_gradient).
#[derive(Debug)]
pub struct Supplied<G> {
    recorded: Recorded,
    gradient: Arc<G>,
}

// Not derived: the closure need not be `Clone` to be shared.
impl<G> Clone for Supplied<G> {
    fn clone(&self) -> Self {
        Supplied {
            recorded: self.recorded.clone(),
            gradient: Arc::clone(&self.gradient),
        }
    }
}

impl<G: Fn(&[f64], &[f64], &mut [f64], &mut [f64])> Supplied<G> {
    pub(crate) fn new(recorded: Recorded, gradient: G) -> Self {
        Supplied {
            recorded,
            gradient: Arc::new(gradient),
        }
    }

    pub(crate) fn recorded(&self) -> &Recorded {
        &self.recorded
    }

    /// The closure's answer, all slices of length n = 2m.
    pub(crate) fn supplied_gradient(&self, y: &[f64], gradient: &mut [f64]) {
        let m = y.len() / 2;
        let (dq, dp) = gradient.split_at_mut(m);
        (self.gradient)(&y[..m], &y[m..], dq, dp);
    }
}

impl<G: Fn(&[f64], &[f64], &mut [f64], &mut [f64])> System for Supplied<G> {
    type Evaluator<T: Float> = SuppliedEvaluator<G, T>;

    fn structure(&self) -> &Structure {
        self.recorded.structure()
    }

    fn evaluator<T: Float>(&self) -> SuppliedEvaluator<G, T> {
        let n = 2 * self.structure().degrees_of_freedom;
        let doubles = TypeId::of::<T>() == TypeId::of::<f64>();
        SuppliedEvaluator {
            tape: self.recorded.evaluator(),
            route: doubles.then(|| self.clone()),
            state: vec![0.0; n],
            slope: vec![0.0; n],
            points: Points::new(n),
        }
    }
}

/// Evaluates an energy with a supplied gradient in the float type `T`.
#[derive(Debug)]
pub struct SuppliedEvaluator<G, T: Float> {
    tape: RecordedEvaluator<T>,
    /// Present when `T` is `f64`.
    route: Option<Supplied<G>>,
    /// State and gradient as `f64`: without unsafe code the compiler cannot be told that `T` is `f64`.
    state: Vec<f64>,
    slope: Vec<f64>,
    points: Points<T>,
}

impl<G: Fn(&[f64], &[f64], &mut [f64], &mut [f64]), T: Float> SuppliedEvaluator<G, T> {
    fn supplied(&mut self, y: &[T], gradient: &mut [T]) -> bool {
        let Some(route) = &self.route else {
            return false;
        };
        assert!(
            y.len() == self.state.len() && gradient.len() == y.len(),
            "a state of this system has {} components",
            self.state.len()
        );
        self.state
            .iter_mut()
            .zip(y)
            .for_each(|(place, &x)| *place = x.to_f64());
        route.supplied_gradient(&self.state, &mut self.slope);
        gradient
            .iter_mut()
            .zip(&self.slope)
            .for_each(|(place, &x)| *place = T::exact(x));
        true
    }
}

impl<G, T: Float> Evaluate<T> for SuppliedEvaluator<G, T>
where
    G: Fn(&[f64], &[f64], &mut [f64], &mut [f64]),
{
    fn value(&mut self, y: &[T]) -> T {
        self.tape.value(y)
    }

    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        if self.supplied(y, gradient) {
            self.tape.value(y)
        } else {
            self.tape.gradient(y, gradient)
        }
    }

    fn compensated_value(&mut self, y: &[T]) -> T {
        self.tape.compensated_value(y)
    }

    fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        if self.supplied(y, gradient) {
            self.tape.compensated_value(y)
        } else {
            self.tape.gradient_with_compensated_value(y, gradient)
        }
    }

    fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        let h = self.gradient_with_compensated_value(y, gradient);
        (h, self.tape.bound(y))
    }

    fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            if !self.supplied(y, gradient) {
                self.tape.gradient(y, gradient);
            }
        }
    }

    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let Some(route) = &self.route else {
            return self
                .tape
                .gradients_by_component(states, gradients, stride, count);
        };
        check_batch(
            2 * route.structure().degrees_of_freedom,
            [states.len(), gradients.len()],
            stride,
            count,
        );
        let mut points = std::mem::take(&mut self.points);
        points.each(states, gradients, stride, count, |y, gradient| {
            self.supplied(y, gradient);
        });
        self.points = points;
    }

    fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let Some(route) = &self.route else {
            return self
                .tape
                .forces_by_component(positions, gradients, stride, count);
        };
        require_separable(route.structure());
        check_batch(
            route.structure().degrees_of_freedom,
            [positions.len(), gradients.len()],
            stride,
            count,
        );
        let mut points = std::mem::take(&mut self.points);
        points.each(positions, gradients, stride, count, |y, gradient| {
            self.supplied(y, gradient);
        });
        self.points = points;
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        self.tape.kinetic()
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        self.tape.set_instruction_set(set);
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.tape.hessian_vector(y, v, product);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        self.tape.hessian(y, entries);
    }
}
