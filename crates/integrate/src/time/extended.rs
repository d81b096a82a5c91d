//! [`Extended`]: transformed time.
//!
//! *Time transformation* (Poincaré). Let time be a further position, q_{m+1} = t, with the further momentum
//! p_t. On K = 0 the Hamiltonian
//!
//! $$ K = \sigma(t, q, p) \, (H(t, q, p) + p_t), \qquad \sigma > 0, \qquad p_t(0) = -H(t_0, q_0, p_0) , $$
//!
//! has the trajectories of H in a transformed time τ with dt/dτ = σ. Fixed steps in τ are then steps of size
//! σ·h in t, short where σ is small. The transformation requires K = 0. EQUIP conserves K = 0 and therefore H
//! to round-off. If H does not depend on time, p_t is constant.
//!
//! For an H(t, q, p) without time transformation use [`Hamiltonian::with_time`].

use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_scalar::Float;

/// A Hamiltonian H(t, q, p) in a transformed time τ, on the extended phase space with positions (q, t) and
/// momenta (p, p_t).
///
/// ```
/// use equip_integrate::{Equip, Extended};
///
/// // Two bodies, e = 0.9, with dt/dτ = r: 40 equal steps in τ go once around.
/// let r = |q: &[equip_autodiff::Var]| (q[0] * q[0] + q[1] * q[1]).sqrt();
/// let transformed = Extended::transformed(
///     2,
///     |_, q, p| 0.5 * (p[0] * p[0] + p[1] * p[1]) - r(q).recip(),
///     |_, q, _| r(q),
/// )?;
/// let (q, p) = transformed.start(&[0.1, 0.0], &[0.0, 19f64.sqrt()], 0.0);
/// let around = std::f64::consts::TAU;
/// let run = Equip::stages(6)
///     .step(around / 40.0)
///     .integrate(transformed.hamiltonian(), &q, &p, 0.0..=around)?;
/// let (_, q, _) = run.last();
/// assert!((q[0] - 0.1).abs() < 1e-9 && (q[2] - around).abs() < 1e-9); // q[2] is the time
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
    /// H(t, q, p) with m degrees of freedom and dt/dτ = σ(t, q, p) > 0. The independent variable of the run
    /// is τ, and the run conserves K = σ (H + p_t) = 0.
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
        let energy = Hamiltonian::new(m + 1, |q, p| energy(q[m], &q[..m], &p[..m]))?;
        Ok(Extended { system, energy, m })
    }

    /// K, with m + 1 degrees of freedom.
    pub fn hamiltonian(&self) -> &Hamiltonian {
        &self.system
    }

    /// H on the extended phase space, to be monitored as an [`Invariant`](crate::Invariant).
    pub fn energy(&self) -> &Hamiltonian {
        &self.energy
    }

    /// The extended initial state (q, t0), (p, −H), for which K = 0.
    ///
    /// # Panics
    /// If `q` and `p` do not have m components.
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
