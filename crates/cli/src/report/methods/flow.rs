//! [`Flow`]: y' = J∇H(y) by the library's own gradient, for the methods the report compares with.

use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;

/// The vector field of a Hamiltonian.
#[derive(Debug)]
pub(crate) struct Flow<T: Float, E> {
    evaluator: E,
    gradient: Vec<T>,
}

impl<T: Float, E: Evaluate<T>> Flow<T, E> {
    /// Of the system `system`.
    pub(crate) fn new(system: &impl System<Evaluator<T> = E>) -> Self {
        let n = 2 * system.degrees_of_freedom();
        Flow {
            evaluator: system.evaluator::<T>(),
            gradient: vec![T::int(0); n],
        }
    }

    /// y' into `dy`.
    pub(crate) fn derivative(&mut self, y: &[T], dy: &mut [T]) {
        let n = y.len();
        self.evaluator.gradients(y, &mut self.gradient, n);
        let ((dq, dp), (hq, hp)) = (dy.split_at_mut(n / 2), self.gradient.split_at(n / 2));
        dq.copy_from_slice(hp);
        for (force, &slope) in dp.iter_mut().zip(hq) {
            *force = -slope;
        }
    }

    /// The diagonal of ∂²H/∂p² where H = Σ p_i²/(2m_i) + U(q): the inverse masses; `None` for any other H.
    pub(crate) fn inverse_masses(
        system: &impl System<Evaluator<T> = E>,
        y: &[T],
    ) -> Option<Vec<T>> {
        let structure = system.structure();
        let m = structure.degrees_of_freedom;
        if !structure.separable || structure.degree_in_p.is_none_or(|d| d > 2) {
            return None;
        }
        let pattern = &structure.hessian;
        let mut entries = vec![T::int(0); pattern.len()];
        system.evaluator::<T>().hessian(y, &mut entries);
        let mut masses = vec![T::int(0); m];
        for (i, mass) in masses.iter_mut().enumerate() {
            for (k, column) in pattern.row(m + i) {
                if column != m + i {
                    return None;
                }
                *mass = entries[k];
            }
        }
        // A linear part of T would move q also at p = 0.
        let mut rest = y.to_vec();
        rest[m..].fill(T::int(0));
        let mut slope = rest.clone();
        Flow::new(system).derivative(&rest, &mut slope);
        slope[..m].iter().all(|&v| v == T::int(0)).then_some(masses)
    }
}
