//! The invariants of a scene besides H.

use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_scalar::{Num, Scalar};

/// How an invariant depends on the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InvariantKind {
    /// Linear in (q, p): conserved by every Runge–Kutta method.
    Linear,
    /// Quadratic in (q, p): conserved by the Gauss and EQUIP methods.
    Quadratic,
    /// Anything else: not conserved by construction.
    Other,
}

/// A function I(q, p) with {I, H} = 0.
#[derive(Debug)]
pub struct Invariant {
    /// The name, for messages and for columns of tables.
    pub name: &'static str,
    /// Linear, quadratic or neither.
    pub kind: InvariantKind,
    /// I(q, p), traced like an energy.
    pub quantity: Hamiltonian,
}

impl Invariant {
    pub(crate) fn record(
        name: &'static str,
        kind: InvariantKind,
        degrees_of_freedom: usize,
        quantity: impl FnOnce(&[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        Ok(Invariant {
            name,
            kind,
            quantity: Hamiltonian::new(degrees_of_freedom, quantity)?,
        })
    }

    /// Whether methods that conserve quadratic invariants conserve this one.
    pub fn is_at_most_quadratic(&self) -> bool {
        self.kind != InvariantKind::Other
    }
}

/// The components of the total momentum and angular momentum of bodies in d = 2 or 3 dimensions.
pub(crate) fn all_momenta(bodies: usize, d: usize) -> Result<Vec<Invariant>, BuildError> {
    let mut all = linear_momenta(bodies, d)?;
    all.extend(angular_momenta(bodies, d)?);
    Ok(all)
}

/// The i-th component of the total momentum of bodies in d dimensions: Σ_b p_{db+i}.
fn linear_momenta(bodies: usize, d: usize) -> Result<Vec<Invariant>, BuildError> {
    const NAMES: [&str; 3] = ["momentum x", "momentum y", "momentum z"];
    (0..d.min(3))
        .map(|i| {
            Invariant::record(NAMES[i], InvariantKind::Linear, bodies * d, |_, p| {
                p.iter().skip(i).step_by(d).copied().sum()
            })
        })
        .collect()
}

/// The components of the total angular momentum of bodies in d = 2 or 3 dimensions.
pub(crate) fn angular_momenta(bodies: usize, d: usize) -> Result<Vec<Invariant>, BuildError> {
    let planes: &[_] = match d {
        3 => &[
            ("angular momentum z", 0, 1),
            ("angular momentum x", 1, 2),
            ("angular momentum y", 2, 0),
        ],
        _ => &[("angular momentum", 0, 1)],
    };
    let component = |&(name, a, b): &(&'static str, usize, usize)| {
        Invariant::record(name, InvariantKind::Quadratic, bodies * d, |q, p| {
            let moments = (0..bodies).map(|j| moment(q, p, d * j + a, d * j + b));
            moments.sum()
        })
    };
    planes.iter().map(component).collect()
}

/// q_a p_b − q_b p_a.
pub(crate) fn moment<S: Scalar>(q: &[Num<S>], p: &[Num<S>], a: usize, b: usize) -> Num<S> {
    q[a] * p[b] - q[b] * p[a]
}
