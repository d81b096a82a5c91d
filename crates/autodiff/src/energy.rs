//! [`Energy`]: an energy as one generic method, for speed where the system is small.

use equip_scalar::{Float, Num, Scalar};

/// An energy H(q, p) written once for every kind of number.
///
/// What a closure cannot be: generic over the number. The compiler turns it into machine code for floats and
/// for dual numbers, which for up to four degrees of freedom beats any tape. A comparison of the state does
/// not compile here, as [`Num`] has none; use `.min()`, `.max()`, `.abs()` and `.select()`. Mark the method
/// `#[inline(always)]`: it is compiled together with the stage sweeps then, which take half the time.
///
/// The macro [`hamiltonian!`](crate::hamiltonian) writes such a type from closure-like text.
///
/// ```
/// use equip_autodiff::{Energy, Hamiltonian, System};
/// use equip_scalar::{Num, Scalar};
///
/// struct Kepler {
///     mu: f64,
/// }
///
/// impl Energy for Kepler {
///     fn degrees_of_freedom(&self) -> usize {
///         2
///     }
///     #[inline(always)]
///     fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
///         0.5 * (p[0] * p[0] + p[1] * p[1]) - self.mu / (q[0] * q[0] + q[1] * q[1]).sqrt()
///     }
/// }
///
/// let kepler = Hamiltonian::from_energy(Kepler { mu: 1.0 })?;
/// assert!(kepler.structure().separable);
/// # Ok::<(), equip_autodiff::BuildError>(())
/// ```
pub trait Energy {
    /// Number m of positions, and of momenta.
    fn degrees_of_freedom(&self) -> usize;

    /// H(q, p); both slices have length m.
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S>;

    /// A gradient written by hand: ∂H/∂q into `dq`, ∂H/∂p into `dp`, and `true` if it is given. It is
    /// used instead of automatic differentiation, so check it once with
    /// [`check_gradient`](crate::Hamiltonian::check_gradient).
    ///
    /// ```
    /// # use equip_autodiff::{Energy, Evaluate, Hamiltonian, System};
    /// # use equip_scalar::{Float, Num, Scalar};
    /// struct Pendulum;
    ///
    /// impl Energy for Pendulum {
    ///     fn degrees_of_freedom(&self) -> usize {
    ///         1
    ///     }
    ///     fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
    ///         0.5 * p[0] * p[0] - q[0].cos()
    ///     }
    ///     fn gradient<T: Float>(&self, q: &[T], p: &[T], dq: &mut [T], dp: &mut [T]) -> bool {
    ///         dq[0] = q[0].sin();
    ///         dp[0] = p[0];
    ///         true
    ///     }
    /// }
    ///
    /// let pendulum = Hamiltonian::from_energy(Pendulum)?;
    /// pendulum.check_gradient(&[0.3, 0.1])?;
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    fn gradient<T: Float>(&self, q: &[T], p: &[T], dq: &mut [T], dp: &mut [T]) -> bool {
        let _ = (q, p, dq, dp);
        false
    }
}
