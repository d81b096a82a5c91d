//! [`Extended`]: energies that depend on time, and time that runs at a rate of its own.
//!
//! With time as a further position, q_{m+1} = t, and its momentum p_t as a further momentum, a Hamiltonian
//! with m degrees of freedom becomes an autonomous one with m + 1:
//!
//! $$ K = H(t, q, p) + p_t, \qquad \frac{dt}{d\tau} = 1, \qquad \frac{dp_t}{d\tau} = -\frac{\partial H}{\partial t} . $$
//!
//! p_t(0) = −H(t_0, q_0, p_0), so K = 0, and K is what the α's keep: p_t tells exactly how much energy went
//! in or out.
//!
//! *Time transformation* (Poincaré). K = σ(t, q, p) (H(t, q, p) + p_t) with σ > 0 has, on K = 0, the same
//! trajectories at another rate: dt/dτ = σ. Fixed steps in τ are then steps of σ·h in t, short where σ is
//! small. EQUIP keeps K = 0 and so H exactly, which is what the transformation stands on. If H does not
//! depend on time, p_t is constant.

use equip_autodiff::{BuildError, Evaluate, Hamiltonian, System, Var};
use equip_scalar::Float;

/// A Hamiltonian H(t, q, p) in the extended phase space: positions (q, t), momenta (p, p_t).
///
/// ```
/// use equip_integrate::{Equip, Extended};
///
/// // An oscillator that is pushed: q'' = −q + cos t/2.
/// let pushed = Extended::time_dependent(1, |t, q, p| {
///     0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * (0.5 * t).cos()
/// })?;
/// let (q, p) = pushed.start(&[0.0], &[0.0], 0.0);
/// let run = Equip::stages(4).tolerance(1e-12).integrate(pushed.hamiltonian(), &q, &p, 0.0..=10.0)?;
/// let (_, q, _) = run.last();
/// let exact = 4.0 / 3.0 * (5f64.cos() - 10f64.cos());
/// assert!((q[0] - exact).abs() < 1e-10);
/// assert!((q[1] - 10.0).abs() < 1e-14); // time
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Extended {
    system: Hamiltonian,
    /// H alone, on the extended phase space.
    energy: Hamiltonian,
    m: usize,
}

impl Extended {
    /// H(t, q, p) with m degrees of freedom. What a run keeps as its energy is K = H + p_t.
    ///
    /// # Errors
    /// See [`Hamiltonian::new`].
    pub fn time_dependent(
        m: usize,
        energy: impl Fn(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        let system = Hamiltonian::new(m + 1, |q, p| energy(q[m], &q[..m], &p[..m]) + p[m])?;
        Self::of(m, system, energy)
    }

    /// The same at the rate dt/dτ = σ(t, q, p) > 0: the independent variable of the run is τ, and what it
    /// keeps is K = σ (H + p_t) = 0.
    ///
    /// # Errors
    /// See [`Hamiltonian::new`].
    pub fn transformed(
        m: usize,
        energy: impl Fn(Var, &[Var], &[Var]) -> Var,
        rate: impl Fn(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        let system = Hamiltonian::new(m + 1, |q, p| {
            let (t, x, y) = (q[m], &q[..m], &p[..m]);
            rate(t, x, y) * (energy(t, x, y) + p[m])
        })?;
        Self::of(m, system, energy)
    }

    fn of(
        m: usize,
        system: Hamiltonian,
        energy: impl Fn(Var, &[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        let energy = Hamiltonian::new(m + 1, |q, p| energy(q[m], &q[..m], &p[..m]))?;
        Ok(Extended { system, energy, m })
    }

    /// K, with m + 1 degrees of freedom.
    pub fn hamiltonian(&self) -> &Hamiltonian {
        &self.system
    }

    /// H on the extended phase space, to be watched as an [`Invariant`](crate::Invariant).
    pub fn energy(&self) -> &Hamiltonian {
        &self.energy
    }

    /// The extended start (q, t0), (p, −H): K = 0 there.
    ///
    /// # Panics
    /// When `q` and `p` do not have m components.
    pub fn start<T: Float>(&self, q: &[T], p: &[T], t0: T) -> (Vec<T>, Vec<T>) {
        assert!(q.len() == self.m && p.len() == self.m, "m components each");
        let (mut q, mut p) = (q.to_vec(), p.to_vec());
        q.push(t0);
        p.push(T::int(0));
        let state = [q.as_slice(), &p].concat();
        p[self.m] = -self.energy.evaluator::<T>().value(&state);
        (q, p)
    }
}
