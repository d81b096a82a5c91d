//! Further quantities to watch or to keep along a run.

use equip_autodiff::Hamiltonian;

/// A named function of the state, recorded like an energy, whose change along the run the certificate shows.
///
/// Quadratic invariants of the flow (angular and linear momentum, norms) are kept by EQUIP and Gauss for
/// any step; others are measured only.
#[derive(Debug, Clone)]
pub struct Invariant {
    name: String,
    function: Hamiltonian,
}

impl Invariant {
    /// A quantity I(q, p) under a name, recorded by [`Hamiltonian::new`], or I(t, q, p) by
    /// [`Hamiltonian::with_time`].
    pub fn new(name: impl Into<String>, function: Hamiltonian) -> Self {
        Invariant {
            name: name.into(),
            function,
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The function.
    pub fn function(&self) -> &Hamiltonian {
        &self.function
    }

    /// Whether it is at most quadratic, and so kept for free if the flow keeps it.
    pub fn is_quadratic(&self) -> bool {
        self.function.structure().is_quadratic()
    }
}
