//! Further quantities to monitor or conserve in a run.

use equip_autodiff::Hamiltonian;

/// A named function of the state, traced like an energy. The certificate shows its change over the run.
///
/// EQUIP and Gauss conserve quadratic invariants of the flow (angular and linear momentum, norms) for any
/// step size. Other invariants are measured only.
#[derive(Debug, Clone)]
pub struct Invariant {
    name: String,
    function: Hamiltonian,
}

impl Invariant {
    /// A quantity I(q, p) with a name, traced by [`Hamiltonian::new`], or I(t, q, p) traced by
    /// [`Hamiltonian::with_time`].
    pub fn new(name: impl Into<String>, function: Hamiltonian) -> Self {
        Invariant {
            name: name.into(),
            function,
        }
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The function.
    pub fn function(&self) -> &Hamiltonian {
        &self.function
    }

    /// Whether the function is at most quadratic. If it is an invariant of the flow, the method then
    /// conserves it at no cost.
    pub fn is_quadratic(&self) -> bool {
        self.function.structure().is_quadratic()
    }
}
