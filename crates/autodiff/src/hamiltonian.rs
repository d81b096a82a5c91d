//! [`Hamiltonian`]: an energy, and everything derived from it.

use crate::external::energy::External;
use crate::external::given::GivenGradient;
use crate::recording::bytes::{self, Content};
use crate::recording::read;
use crate::routes::traced::Traced;
use crate::structure::bracket::Bracket;
use crate::{BuildError, BytesError, Structure};
use equip_scalar::Outside;
use std::sync::Arc;

/// A scalar energy H(q, p): its value, gradient, Hessian and structure, in any floating-point type.
///
/// An invariant is a scalar function of (q, p) as well, and is given in the same way.
///
/// ```
/// use equip_autodiff::Hamiltonian;
///
/// let mu = 1.0;
/// let kepler = Hamiltonian::new(2, |q, p| {
///     0.5 * (p[0] * p[0] + p[1] * p[1]) - mu / (q[0] * q[0] + q[1] * q[1]).sqrt()
/// })?;
/// assert!(kepler.structure().separable);
///
/// let mut evaluator = kepler.evaluator::<f64>();
/// let mut gradient = [0.0; 4];
/// assert_eq!(evaluator.gradient(&[2.0, 0.0, 0.0, 0.5], &mut gradient), -0.375);
/// assert_eq!(gradient, [0.25, 0.0, 0.0, 0.5]);
/// # Ok::<(), equip_autodiff::BuildError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Hamiltonian {
    pub(crate) energy: Energy,
    /// A user-supplied gradient, for doubles.
    pub(crate) gradient: Option<GivenGradient>,
    /// H(t, q, p) alone, if the trace is that of H + p_t.
    pub(crate) alone: Option<Arc<Traced>>,
    /// The bracket of y' = B(y)∇H(y), if B is not J.
    pub(crate) bracket: Option<Box<(Arc<Traced>, Bracket)>>,
    /// The number of components of the state. It is odd if the last component is unused.
    pub(crate) components: usize,
}

/// The source of H.
#[derive(Debug, Clone)]
pub(crate) enum Energy {
    Traced(Arc<Traced>),
    External(External),
}

impl Hamiltonian {
    pub(crate) fn traced(energy: Arc<Traced>, alone: Option<Arc<Traced>>) -> Self {
        Hamiltonian {
            components: 2 * energy.structure.degrees_of_freedom,
            energy: Energy::Traced(energy),
            gradient: None,
            alone,
            bracket: None,
        }
    }

    /// Sets the bracket given by this bilinear form.
    pub(crate) fn set_bracket(&mut self, form: Arc<Traced>) {
        let bracket = Bracket::new(self.energy_structure(), &form.structure);
        self.bracket = Some(Box::new((form, bracket)));
    }

    /// The trace as a function of the state alone: H. If H depends on time, time is the last position.
    #[must_use]
    pub fn alone(&self) -> Hamiltonian {
        match &self.alone {
            Some(alone) => Hamiltonian::traced(alone.clone(), None),
            None => Hamiltonian {
                bracket: None,
                ..self.clone()
            },
        }
    }

    /// The traced energy as bytes, with all digits of its constants and with its tables.
    /// [`from_bytes`](Self::from_bytes) restores the energy on any machine without the closure.
    ///
    /// # Errors
    /// [`BytesError::External`] if H is external; [`BytesError::NotData`] if it calls closures such as those
    /// of `Custom`; [`BytesError::ComponentsNotUsed`] if it has more than 65 536 components and depends on
    /// few of them.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let again = Hamiltonian::from_bytes(&pendulum.to_bytes()?)?;
    /// let y = [0.3, 0.4];
    /// assert_eq!(again.evaluator().value(&y), pendulum.evaluator().value(&y));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_bytes(&self) -> Result<Vec<u8>, BytesError> {
        let Energy::Traced(energy) = &self.energy else {
            return Err(BytesError::External);
        };
        bytes::write(&Content {
            energy: energy.recording(),
            alone: self.alone.as_deref().map(Traced::recording),
            form: self.bracket.as_ref().map(|of| of.0.recording()),
            is_odd: self.components % 2 == 1,
        })
    }

    /// Restores the energy from the bytes of [`to_bytes`](Self::to_bytes). Its values, derivatives and runs
    /// agree bit for bit.
    ///
    /// # Errors
    /// [`BytesError`] if the bytes are damaged, have another format, or are not an energy, if a constant is
    /// NaN or infinite, or if they contain tables. Memory is bounded by the number of bytes, whatever their
    /// content.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BytesError> {
        Self::from_bytes_with(bytes, |_| None)
    }

    /// The same with external functions, which `functions` restores from the bytes of [`Outside::to_bytes`]:
    /// for tables `|bytes| equip_tables::from_bytes(bytes).ok()`.
    ///
    /// # Errors
    /// The errors of [`from_bytes`](Self::from_bytes); [`BytesError::UnknownFunction`] if `functions` returns
    /// `None`.
    pub fn from_bytes_with(
        bytes: &[u8],
        functions: impl Fn(&[u8]) -> Option<Arc<dyn Outside>>,
    ) -> Result<Self, BytesError> {
        let read = read::read(bytes, &functions)?;
        let alone = read.alone.map(Traced::of).transpose()?;
        let mut system = Hamiltonian::traced(Traced::of(read.energy)?, alone);
        if let Some(form) = read.form {
            system.set_bracket(Traced::of(form)?);
        }
        system.components -= usize::from(read.is_odd);
        Ok(system)
    }

    /// The number of arithmetic operations and function calls of one evaluation of H, as it is replayed.
    /// Repeated subexpressions count once. Operations on constants, and those that H does not depend on, do
    /// not count. 0 for an external energy.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let h = Hamiltonian::new(1, |q, p| (q[0] * p[0]).sin() + (p[0] * q[0]).cos())?;
    /// assert_eq!(h.operations(), 4);
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn operations(&self) -> usize {
        self.counted(Traced::operations)
    }

    /// The same for one evaluation of ∇H.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let h = Hamiltonian::new(1, |q, p| p[0] * p[0] + q[0].cos())?;
    /// assert_eq!(h.gradient_operations(), 3); // 2 p, sin q, −sin q
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn gradient_operations(&self) -> usize {
        self.counted(Traced::gradient_operations)
    }

    /// The same for all entries of ∇²H. If the entries are too many to be traced, they are computed by
    /// products with vectors, and each product counts as three evaluations of ∇H.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let h = Hamiltonian::new(1, |q, p| p[0] * p[0] + q[0].cos())?;
    /// assert_eq!(h.hessian_operations(), 2); // cos q, −cos q; the other entry is 2
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn hessian_operations(&self) -> usize {
        self.counted(Traced::hessian_operations)
    }

    fn counted(&self, operations: impl Fn(&Traced) -> usize) -> usize {
        match &self.energy {
            Energy::Traced(traced) => operations(traced),
            Energy::External(_) => 0,
        }
    }
}

/// Properties of H, and its evaluation.
impl Hamiltonian {
    /// The number m of degrees of freedom; the state y = (q, p) has 2m components. If H depends on time, time
    /// counts as the last degree of freedom.
    pub fn degrees_of_freedom(&self) -> usize {
        self.structure().degrees_of_freedom
    }

    /// Whether H depends on time. Time is then the last position, and K = H + p_t is integrated
    /// ([`with_time`](Self::with_time)).
    pub fn has_time(&self) -> bool {
        self.alone.is_some()
    }

    /// Separability, degree and sparsity of H. For a system with a bracket the pattern is that of w'
    /// ([`Evaluator`](crate::Evaluator)), and H counts as not separable.
    pub fn structure(&self) -> &Structure {
        match &self.bracket {
            Some(of) => &of.1.structure,
            None => self.energy_structure(),
        }
    }

    pub(crate) fn energy_structure(&self) -> &Structure {
        match &self.energy {
            Energy::Traced(traced) => &traced.structure,
            Energy::External(external) => &external.structure,
        }
    }
}

/// User-supplied functions.
impl Hamiltonian {
    /// An energy computed by user code, in doubles: C code, an interpolator, a learned energy. `value(q, p)`
    /// is H, `gradient(q, p, dq, dp)` writes ∂H/∂q to `dq` and ∂H/∂p to `dp`. All slices have length m.
    /// `accuracy` is the relative rounding error of the values, and of the gradient relative to its largest
    /// component: [`f64::EPSILON`] in doubles.
    ///
    /// A run compares the gradient with differences of H at its start and occasionally later. The structure
    /// of H is unknown: ∇²H takes 2n gradients and has n² entries, discontinuities are not detected, and a
    /// run in another floating-point type knows H and ∇H in double precision only. A closure of
    /// [`new`](Self::new) is faster.
    ///
    /// # Errors
    /// [`BuildError::NoDegreesOfFreedom`], [`BuildError::TooManyDegreesOfFreedom`]; [`BuildError::Accuracy`]
    /// unless ε ≤ `accuracy` < 1.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let pendulum = Hamiltonian::external(
    ///     1,
    ///     f64::EPSILON,
    ///     |q, p| 0.5 * p[0] * p[0] - q[0].cos(),
    ///     |q, p, dq, dp| (dq[0], dp[0]) = (q[0].sin(), p[0]),
    /// )?;
    /// assert_eq!(pendulum.evaluator().value(&[0.0, 1.0]), -0.5);
    /// pendulum.check_gradient(&[0.3, 0.1])?;
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn external(
        m: usize,
        accuracy: f64,
        value: impl Fn(&[f64], &[f64]) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&[f64], &[f64], &mut [f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Result<Self, BuildError> {
        let gradient = GivenGradient(Arc::new(gradient));
        External::new(m, accuracy, Arc::new(value), gradient).map(Self::of_external)
    }

    /// The energy Σ_c p_c²/(2 m_c) + U(q) with a potential U computed by user code, in doubles: a force
    /// field, a learned potential. `masses` has one mass for each of the m components of q, `value(q)` is U,
    /// and `gradient(q, dq)` writes ∂U/∂q to `dq`; slices have length m. `accuracy` is as in
    /// [`external`](Self::external).
    ///
    /// Since the kinetic energy is known, the iteration takes half as many gradients as with `external`, and
    /// ∇²H takes n of them in place of 2n.
    ///
    /// # Errors
    /// Those of [`external`](Self::external); [`BuildError::Mass`] if a mass or its inverse is 0, infinite or
    /// not a number.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// let pendulum = Hamiltonian::external_potential(
    ///     &[2.0],
    ///     f64::EPSILON,
    ///     |q| -q[0].cos(),
    ///     |q, dq| dq[0] = q[0].sin(),
    /// )?;
    /// assert_eq!(pendulum.evaluator().value(&[0.0, 1.0]), -0.75);
    /// assert!(pendulum.structure().separable);
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn external_potential(
        masses: &[f64],
        accuracy: f64,
        value: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Result<Self, BuildError> {
        External::of_potential(masses, accuracy, value, gradient).map(Self::of_external)
    }

    fn of_external(external: External) -> Self {
        Hamiltonian {
            components: 2 * external.structure.degrees_of_freedom,
            energy: Energy::External(external),
            gradient: None,
            alone: None,
            bracket: None,
        }
    }

    /// The same energy with a user-supplied gradient, which replaces automatic differentiation if the float
    /// type is `f64`. `gradient(q, p, dq, dp)` writes ∂H/∂q to `dq` and ∂H/∂p to `dp`. If H depends on time,
    /// these are (q, t) and (p, p_t), and ∂/∂p_t is 1.
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
    #[must_use]
    pub fn with_gradient(
        mut self,
        gradient: impl Fn(&[f64], &[f64], &mut [f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        let gradient = GivenGradient(Arc::new(gradient));
        match &mut self.energy {
            Energy::Traced(_) => self.gradient = Some(gradient),
            Energy::External(external) => external.gradient = gradient,
        }
        self
    }

    /// Compares a user-supplied gradient with H at the state y = (q, p), length n: with automatic
    /// differentiation to √ε of the largest component, or with differences if the energy is external.
    ///
    /// # Errors
    /// [`BuildError::WrongGradient`] with the first component that differs.
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
        Ok(self.evaluator().check_gradient(y)?)
    }
}
