//! The largest frequency at a state, ω = max |λ(J∇²H)|, by [`PowerIteration`].
//!
//! The phase error of the Gauss method for an oscillation is about
//!
//! $$ \frac{(s!)^2}{(2s)!\,(2s+1)!} (h\omega)^{2s+1} $$
//!
//! per step. Steps resolve hω up to s, where the phase error is 0.04, 0.01, 5e-4 for s = 2, 4, 8.
//!
//! Cost: one Hessian, and the power iteration.

use equip_autodiff::{Evaluator, Hamiltonian, Pattern};
use equip_scalar::Float;
use equip_solver::PowerIteration;

/// The pattern of ∇²H, and workspace that is allocated on first use.
#[derive(Debug)]
pub(crate) struct Frequency<T> {
    pattern: Pattern,
    entries: Vec<T>,
    iteration: PowerIteration,
}

impl<T: Float> Frequency<T> {
    pub(crate) fn new(system: &Hamiltonian) -> Self {
        Frequency {
            pattern: system.structure().hessian.to_pattern(),
            entries: Vec::new(),
            iteration: PowerIteration::default(),
        }
    }

    /// ω at `y`, per unit of time; 0 for free motion, or if ∇²H is not finite.
    pub(crate) fn at(&mut self, energy: &mut Evaluator<T>, y: &[T]) -> f64 {
        self.entries.resize(self.pattern.len(), T::int(0));
        energy.hessian(y, &mut self.entries);
        let entries = self.entries.iter().map(|x| x.to_f64());
        self.iteration.set(&self.pattern, entries);
        self.iteration.fastest(&self.pattern)
    }
}
