//! [`Formula`]: the formula of an energy, recorded from a closure.

use crate::hamiltonian::Hamiltonian;
use crate::recording::recorder::Recording;
use crate::recording::trace::record;
use crate::routes::traced::Traced;
use crate::{BuildError, Var};

/// The formula of an energy, recorded from a closure in this thread: another thread may make the
/// [`Hamiltonian`] of it.
#[derive(Debug)]
pub struct Formula {
    route: Recording,
    alone: Option<Recording>,
}

impl Formula {
    /// Records H(q, p) as [`Hamiltonian::new`] does.
    ///
    /// # Errors
    /// Those of [`Hamiltonian::new`], but for constants that are not finite.
    pub fn new(m: usize, energy: impl FnOnce(&[Var], &[Var]) -> Var) -> Result<Self, BuildError> {
        Ok(Formula {
            route: record(m, energy)?,
            alone: None,
        })
    }

    /// Records H(t, q, p) as [`Hamiltonian::with_time`] does.
    ///
    /// # Errors
    /// Those of [`Hamiltonian::with_time`], but for constants that are not finite.
    pub fn with_time(
        m: usize,
        energy: impl Fn(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        if m == 0 {
            return Err(BuildError::NoDegreesOfFreedom);
        }
        Ok(Formula {
            alone: Some(record(m + 1, |q, p| energy(q[m], &q[..m], &p[..m]))?),
            route: record(m + 1, |q, p| energy(q[m], &q[..m], &p[..m]) + p[m])?,
        })
    }

    /// Operations as they were recorded, components of the state included.
    pub fn len(&self) -> usize {
        self.route.operations.nodes.len()
    }

    /// Whether nothing was recorded, which no energy is.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The energy.
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
    /// Records the energy of a system with m degrees of freedom. The closure is called once, here; what it
    /// captures is recorded as constants, which each float type reads in its own precision.
    ///
    /// # Errors
    /// [`BuildError`] if m = 0, if the closure compares the state or reads a number out of it, if it uses
    /// variables of another recording, if a constant is NaN or infinite, or if there are more degrees of
    /// freedom or operations than a recording has places for.
    ///
    /// # Panics
    /// If the closure panics, and if it waits in an endless loop for a comparison of the state to come true.
    ///
    /// ```
    /// use equip_autodiff::{BuildError, Hamiltonian};
    /// let branching = Hamiltonian::new(1, |q, p| if q[0] < 0.0 { -q[0] } else { p[0] });
    /// assert!(matches!(branching, Err(BuildError::Branch { location }) if location.line() > 0));
    /// ```
    pub fn new(m: usize, energy: impl FnOnce(&[Var], &[Var]) -> Var) -> Result<Self, BuildError> {
        Formula::new(m, energy)?.hamiltonian()
    }

    /// Records an energy H(t, q, p) that depends on time, of a system with m degrees of freedom. Runs of it
    /// start, and are read, like all others; as a function to be watched or to find events of it is H itself.
    ///
    /// What is integrated is an energy that can be conserved: time as a further position, and its
    /// momentum p_t as a further one,
    ///
    /// $$ K = H(t, q, p) + p_t, \qquad \frac{dt}{dt} = 1, \qquad \frac{dp_t}{dt} = -\frac{\partial
    /// H}{\partial t} , $$
    ///
    /// of states (q, t, p, p_t). With p_t = 0 at the start −p_t is the energy that has gone in since, and K
    /// is H less that: it stays what it was.
    ///
    /// # Errors
    /// See [`new`](Self::new). The closure is called twice.
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
        energy: impl Fn(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        Formula::with_time(m, energy)?.hamiltonian()
    }
}
