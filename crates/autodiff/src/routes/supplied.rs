//! [`Supplied`]: a recorded energy with a gradient closure over `f64`, used whenever the float is `f64`.

use crate::replay::point::{Points, check_batch, require_separable};
use crate::routes::check::{Checked, compare};
use crate::{
    BuildError, Evaluate, Hamiltonian, Kinetic, Recorded, RecordedEvaluator, Structure, Switches,
    System, WrongGradient,
};
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
    fn new(recorded: Recorded, gradient: G) -> Self {
        Supplied {
            recorded,
            gradient: Arc::new(gradient),
        }
    }

    /// The closure's answer, all slices of length n = 2m.
    fn supplied_gradient(&self, y: &[f64], gradient: &mut [f64]) {
        let m = y.len() / 2;
        let (dq, dp) = gradient.split_at_mut(m);
        (self.gradient)(&y[..m], &y[m..], dq, dp);
    }
}

impl Hamiltonian<Recorded> {
    /// The same energy with a gradient written by hand, used in place of automatic differentiation when the
    /// float type is `f64`: `gradient(q, p, dq, dp)` writes ∂H/∂q into `dq` and ∂H/∂p into `dp`. Where H
    /// depends on time these are (q, t) and (p, p_t), and ∂/∂p_t is 1.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?
    ///     .with_gradient(|q, p, dq, dp| {
    ///         dq[0] = q[0].sin();
    ///         dp[0] = p[0];
    ///     });
    /// pendulum.check_gradient(&[0.3, 0.1])?;
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn with_gradient<G>(self, gradient: G) -> Hamiltonian<Supplied<G>>
    where
        G: Fn(&[f64], &[f64], &mut [f64], &mut [f64]),
    {
        Hamiltonian {
            route: Supplied::new(self.route, gradient),
            alone: self.alone,
        }
    }
}

impl<G: Fn(&[f64], &[f64], &mut [f64], &mut [f64])> Hamiltonian<Supplied<G>> {
    /// Compares the supplied gradient with automatic differentiation at the state y = (q, p). Components may
    /// differ by √ε of the largest one: enough for any rounding, too little for a wrong term.
    ///
    /// # Errors
    /// [`BuildError::WrongGradient`] names the first component that differs.
    ///
    /// # Panics
    /// If `y` does not have length n = 2m.
    ///
    /// ```
    /// use equip_autodiff::{BuildError, Hamiltonian};
    /// let wrong = Hamiltonian::new(1, |q, p| p[0] * p[0] - q[0].cos())?
    ///     .with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (q[0].sin(), p[0]));
    /// let found = wrong.check_gradient(&[0.3, 0.1]);
    /// assert!(matches!(found, Err(BuildError::WrongGradient { component: 1, .. })));
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn check_gradient(&self, y: &[f64]) -> Result<(), BuildError> {
        let mut given = vec![0.0; y.len()];
        let mut expected = given.clone();
        self.route.recorded.evaluator().gradient(y, &mut expected);
        self.route.supplied_gradient(y, &mut given);
        Ok(compare(&given, &expected)?)
    }
}

impl<G: Fn(&[f64], &[f64], &mut [f64], &mut [f64])> System for Supplied<G> {
    type Evaluator<T: Float> = SuppliedEvaluator<G, T>;

    fn structure(&self) -> &Structure {
        self.recorded.structure()
    }

    fn switches(&self) -> Switches {
        self.recorded.switches()
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
            checked: doubles.then(|| Checked::new(n)),
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
    /// Room to check it.
    checked: Option<Checked<T>>,
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

    fn check_gradient(&mut self, y: &[T]) -> Result<(), WrongGradient<T>> {
        let Some(mut checked) = self.checked.take() else {
            return Ok(());
        };
        let agreed = checked.at(y, |y, given, expected| {
            self.supplied(y, given);
            self.tape.gradient(y, expected);
        });
        self.checked = Some(checked);
        agreed
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        self.tape.kinetic()
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        self.tape.set_instruction_set(set);
    }

    fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        self.tape.gradient_rounding(y, off);
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.tape.hessian_vector(y, v, product);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        self.tape.hessian(y, entries);
    }

    fn hessians_by_component(
        &mut self,
        states: &[T],
        entries: &mut [T],
        stride: usize,
        count: usize,
    ) {
        self.tape
            .hessians_by_component(states, entries, stride, count);
    }
}
