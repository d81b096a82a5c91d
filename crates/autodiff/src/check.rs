//! Hand-written gradients, held against automatic differentiation.

use crate::{BuildError, Energy, Evaluate, Hamiltonian, Recorded, Static, Supplied, System};
use equip_scalar::Float;

impl Hamiltonian<Recorded> {
    /// The same energy with a gradient written by hand, used in place of automatic differentiation when the
    /// float type is `f64`: `gradient(q, p, dq, dp)` writes ∂H/∂q into `dq` and ∂H/∂p into `dp`.
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
        let expected = by_tape(self.route.recorded(), y);
        self.route.supplied_gradient(y, &mut given);
        compare(&given, &expected)
    }
}

impl<E: Energy> Hamiltonian<Static<E>> {
    /// Compiles an energy given as a type with one generic method.
    ///
    /// # Errors
    /// [`BuildError`] if the number of degrees of freedom is 0 or too large, or a constant is NaN or infinite.
    ///
    /// ```
    /// use equip_autodiff::{Energy, Hamiltonian, System};
    /// use equip_scalar::{Num, Scalar};
    ///
    /// struct Oscillator;
    /// impl Energy for Oscillator {
    ///     fn degrees_of_freedom(&self) -> usize {
    ///         1
    ///     }
    ///     fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
    ///         (p[0] * p[0] + q[0] * q[0]) / 2.0
    ///     }
    /// }
    /// assert!(Hamiltonian::from_energy(Oscillator)?.structure().is_quadratic());
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn from_energy(energy: E) -> Result<Self, BuildError> {
        Ok(Hamiltonian {
            route: Static::new(energy)?,
        })
    }

    /// Compares the hand-written gradient, if there is one, with automatic differentiation at the state
    /// y = (q, p). Components may differ by √ε of the largest one.
    ///
    /// # Errors
    /// [`BuildError::WrongGradient`] names the first component that differs.
    ///
    /// # Panics
    /// If `y` does not have length n = 2m.
    pub fn check_gradient<T: Float>(&self, y: &[T]) -> Result<(), BuildError> {
        let mut given = vec![T::NAN; y.len()];
        let expected = by_tape(self.route.recorded(), y);
        if self.route.supplied_gradient(y, &mut given) {
            compare(&given, &expected)
        } else {
            Ok(())
        }
    }
}

fn by_tape<T: Float>(recorded: &Recorded, y: &[T]) -> Vec<T> {
    let mut gradient = vec![T::int(0); y.len()];
    recorded.evaluator::<T>().gradient(y, &mut gradient);
    gradient
}

fn compare<T: Float>(given: &[T], expected: &[T]) -> Result<(), BuildError> {
    let size = |x: &T| x.abs();
    let largest = expected
        .iter()
        .map(size)
        .fold(T::int(0), |a, b| if b > a { b } else { a });
    let allowed = largest * T::EPSILON.sqrt();
    for (component, (&given, &expected)) in given.iter().zip(expected).enumerate() {
        let agrees = given == expected || size(&(given - expected)) <= allowed;
        if !agrees {
            return Err(BuildError::WrongGradient {
                component,
                given: given.to_f64(),
                expected: expected.to_f64(),
            });
        }
    }
    Ok(())
}
