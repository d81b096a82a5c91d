//! [`Hamiltonian`]: an energy with everything derived from it.

use crate::external::energy::External;
use crate::external::given::GivenGradient;
use crate::recording::bytes::{self, Content};
use crate::recording::read;
use crate::routes::traced::Traced;
use crate::structure::bracket::Bracket;
use crate::{BuildError, BytesError, Structure};
use equip_scalar::Outside;
use std::sync::Arc;

/// A scalar energy H(q, p): its value, gradient, Hessian and structure, in any float type.
///
/// An invariant is a scalar function of (q, p) as well, and is given the same way.
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
    /// A gradient of the user's own, for doubles.
    pub(crate) gradient: Option<GivenGradient>,
    /// H(t, q, p) alone, where the trace has H + p_t.
    pub(crate) alone: Option<Traced>,
    /// Of y' = B(y)∇H(y), if B is not J.
    pub(crate) bracket: Option<Box<(Traced, Bracket)>>,
    /// Components of the state: an odd number if the last place is left free.
    pub(crate) components: usize,
}

/// Where H comes from.
#[derive(Debug, Clone)]
pub(crate) enum Energy {
    Traced(Traced),
    External(External),
}

impl Hamiltonian {
    pub(crate) fn traced(energy: Traced, alone: Option<Traced>) -> Self {
        Hamiltonian {
            components: 2 * energy.shared.structure.degrees_of_freedom,
            energy: Energy::Traced(energy),
            gradient: None,
            alone,
            bracket: None,
        }
    }

    /// With the bracket of this bilinear form.
    pub(crate) fn set_bracket(&mut self, form: Traced) {
        let bracket = Bracket::new(self.energy_structure(), &form.shared.structure);
        self.bracket = Some(Box::new((form, bracket)));
    }

    /// What is recorded, as a function of the state alone: H, also where H depends on time, which is the last
    /// position then.
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

    /// The recorded energy as bytes, with its constants to all their digits and its tables:
    /// [`from_bytes`](Self::from_bytes) makes it again, on any machine, without the closure.
    ///
    /// # Errors
    /// [`BytesError::External`] if H is external; [`BytesError::NotData`] if it calls closures, as those of
    /// `Custom`;
    /// [`BytesError::ComponentsNotUsed`] if it has more than 65 536 components and depends on few of them.
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
            alone: self.alone.as_ref().map(Traced::recording),
            form: self.bracket.as_ref().map(|of| of.0.recording()),
            is_odd: self.components % 2 == 1,
        })
    }

    /// The energy of which [`to_bytes`](Self::to_bytes) made these bytes: all bits of its values, derivatives
    /// and runs are the same.
    ///
    /// # Errors
    /// [`BytesError`] if they are damaged, of another format, or those of no energy, if a constant is NaN or
    /// infinite, or if there are tables in them. Memory is bounded by the number of bytes, whatever stands in
    /// them.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BytesError> {
        Self::from_bytes_with(bytes, |_| None)
    }

    /// The same with functions from outside, which `functions` makes of what [`Outside::to_bytes`] has made
    /// of them: for tables `|bytes| equip_tables::from_bytes(bytes).ok()`.
    ///
    /// # Errors
    /// As [`from_bytes`](Self::from_bytes); [`BytesError::UnknownFunction`] where `functions` answers `None`.
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

    /// Arithmetic operations and function calls of one evaluation of H as it is replayed: repeated
    /// subexpressions counted once, those of constants and those that do not reach H not at all. 0 of an
    /// external energy.
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

    /// The same for all entries of ∇²H. Where these are too many to be recorded, and are made by products
    /// with vectors, three evaluations of ∇H are counted for each.
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

/// What is known of H, and what evaluates it.
impl Hamiltonian {
    /// Degrees of freedom m; the state y = (q, p) has 2m components. Where H depends on time it counts as
    /// one, the last.
    pub fn degrees_of_freedom(&self) -> usize {
        self.structure().degrees_of_freedom
    }

    /// Whether H depends on time, which is the last position then, and K = H + p_t is what is integrated
    /// ([`with_time`](Self::with_time)).
    pub fn has_time(&self) -> bool {
        self.alone.is_some()
    }

    /// Separability, degree and sparsity of H. Of a system with a bracket the pattern is that of w'
    /// ([`Evaluator`](crate::Evaluator)), and H does not separate.
    pub fn structure(&self) -> &Structure {
        match &self.bracket {
            Some(of) => &of.1.structure,
            None => self.energy_structure(),
        }
    }

    pub(crate) fn energy_structure(&self) -> &Structure {
        match &self.energy {
            Energy::Traced(traced) => &traced.shared.structure,
            Energy::External(external) => &external.structure,
        }
    }
}

/// Functions of the user's own.
impl Hamiltonian {
    /// An energy computed by code of its own, in doubles: C code, an interpolator, a learned energy.
    /// `value(q, p)` is H, `gradient(q, p, dq, dp)` writes ∂H/∂q into `dq` and ∂H/∂p into `dp`; all slices
    /// have length m. `accuracy` is the relative rounding error of the values: [`f64::EPSILON`] in doubles.
    ///
    /// A run compares the gradient with differences of H where it starts, and now and then on its way. The
    /// structure of H is unknown: ∇²H is made by 2n gradients and has n² entries, kinks are not seen, and a
    /// run in another float knows H and ∇H to doubles only. A closure of [`new`](Self::new) is faster.
    ///
    /// # Errors
    /// [`BuildError::NoDegreesOfFreedom`], [`BuildError::TooManyDegreesOfFreedom`]; [`BuildError::Accuracy`]
    /// outside of ε ≤ `accuracy` < 1.
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
        Ok(Hamiltonian {
            energy: Energy::External(External::new(m, accuracy, Arc::new(value), gradient)?),
            gradient: None,
            alone: None,
            bracket: None,
            components: 2 * m,
        })
    }

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

    /// Compares a gradient written by hand with H at the state y = (q, p), length n: with automatic
    /// differentiation to √ε of the largest component, or, of an external energy, with differences.
    ///
    /// # Errors
    /// [`BuildError::WrongGradient`] names the first component that differs.
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
