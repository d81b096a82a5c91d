//! [`Formula`]: the formula of an energy, traced from a closure.

use crate::hamiltonian::Hamiltonian;
use crate::recording::op::Op;
use crate::recording::recorder::Recording;
use crate::recording::trace::record;
use crate::routes::traced::Traced;
use crate::{BuildError, Var};

/// The formula of an energy, traced from a closure in this thread. Another thread may build the
/// [`Hamiltonian`] from it.
#[derive(Debug)]
pub struct Formula {
    route: Recording,
    alone: Option<Recording>,
}

impl Formula {
    /// Traces H(q, p) like [`Hamiltonian::new`].
    ///
    /// # Errors
    /// The errors of [`Hamiltonian::new`], except for constants that are not finite.
    pub fn new(m: usize, energy: impl FnOnce(&[Var], &[Var]) -> Var) -> Result<Self, BuildError> {
        Ok(Formula {
            route: record(m, energy)?,
            alone: None,
        })
    }

    /// Traces H(t, q, p) like [`Hamiltonian::with_time`].
    ///
    /// # Errors
    /// The errors of [`Hamiltonian::with_time`], except for constants that are not finite.
    pub fn with_time(
        m: usize,
        energy: impl FnOnce(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        if m == 0 {
            return Err(BuildError::NoDegreesOfFreedom);
        }
        let alone = record(m + 1, |q, p| energy(q[m], &q[..m], &p[..m]))?;
        let mut recorder = alone.resume();
        let momentum_of_time = 2 * m as u32 + 1;
        let sum = recorder.apply(Op::Add, alone.root, momentum_of_time);
        if recorder.overflow {
            return Err(BuildError::TooManyOperations);
        }
        Ok(Formula {
            route: recorder.finish(sum),
            alone: Some(alone),
        })
    }

    /// The number of traced operations, including the components of the state.
    pub fn len(&self) -> usize {
        self.route.operations.nodes.len()
    }

    /// Whether the trace is empty, which is the case for no energy.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Builds the energy.
    ///
    /// # Errors
    /// [`BuildError`] if a constant is NaN or infinite.
    ///
    /// ```
    /// use equip_autodiff::Formula;
    /// let formula = Formula::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let pendulum = std::thread::spawn(move || formula.hamiltonian()).join().unwrap()?;
    /// assert_eq!(pendulum.operations(), 4);
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn hamiltonian(self) -> Result<Hamiltonian, BuildError> {
        let alone = self.alone.map(Traced::of).transpose()?;
        Ok(Hamiltonian::traced(Traced::of(self.route)?, alone))
    }
}

impl Hamiltonian {
    /// Traces the energy of a system with m degrees of freedom. The closure is called once, here. Captured
    /// numbers become constants, which each floating-point type reads in its own precision.
    ///
    /// # Errors
    /// [`BuildError`] if m = 0, if the closure compares the state or reads a number out of the state, if it
    /// uses variables of another trace, if a constant is NaN or infinite, or if there are more degrees of
    /// freedom or operations than a trace can hold.
    ///
    /// # Panics
    /// If the closure panics, or if it waits in an endless loop for a comparison of the state to become true.
    ///
    /// ```
    /// use equip_autodiff::{BuildError, Hamiltonian};
    /// let branching = Hamiltonian::new(1, |q, p| if q[0] < 0.0 { -q[0] } else { p[0] });
    /// assert!(matches!(branching, Err(BuildError::Branch { location }) if location.line() > 0));
    /// ```
    pub fn new(m: usize, energy: impl FnOnce(&[Var], &[Var]) -> Var) -> Result<Self, BuildError> {
        Formula::new(m, energy)?.hamiltonian()
    }

    /// Traces an energy H(t, q, p) that depends on time, for a system with m degrees of freedom. Runs of it
    /// take and return (q, p) like all others. As an invariant or event function it is H itself.
    ///
    /// The integrator integrates an energy that can be conserved, with time as a further position and its
    /// momentum p_t as a further momentum,
    ///
    /// $$ K = H(t, q, p) + p_t, \qquad \frac{dt}{dt} = 1, \qquad \frac{dp_t}{dt} = -\frac{\partial
    /// H}{\partial t} , $$
    ///
    /// on states (q, t, p, p_t). With p_t = 0 at the start, −p_t is the energy supplied since the start, and
    /// K is H minus this energy: K is constant.
    ///
    /// # Errors
    /// See [`new`](Self::new).
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    ///
    /// // An oscillator that is pushed: q'' = −q + cos t/2.
    /// let pushed = Hamiltonian::with_time(1, |t, q, p| {
    ///     0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * (0.5 * t).cos()
    /// })?;
    /// assert!(pushed.has_time());
    /// let mut energy = pushed.function::<f64>();
    /// assert_eq!(energy.value(0.0, &[2.0], &[1.0]), 0.5);
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn with_time(
        m: usize,
        energy: impl FnOnce(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        Formula::with_time(m, energy)?.hamiltonian()
    }
}
