//! [`StateFunction`]: a traced function of time and state, evaluated at (t, q, p).

use crate::{Evaluator, Hamiltonian};
use equip_scalar::Float;

/// A traced function (t, q, p) ↦ g in one floating-point type, from [`Hamiltonian::function`]. Its constants
/// are as accurate as those of an energy.
#[derive(Debug)]
pub struct StateFunction<T: Float> {
    evaluator: Evaluator<T>,
    has_time: bool,
    /// (q, p), or (q, t, p, 0).
    y: Vec<T>,
}

impl Hamiltonian {
    /// H as a function (t, q, p) ↦ H in one floating-point type, for observers. t is ignored if H does not
    /// depend on time.
    pub fn function<T: Float>(&self) -> StateFunction<T> {
        StateFunction::new(self)
    }
}

impl<T: Float> StateFunction<T> {
    fn new(function: &Hamiltonian) -> Self {
        let alone = function.alone();
        StateFunction {
            evaluator: alone.evaluator::<T>(),
            has_time: function.has_time(),
            y: vec![T::int(0); 2 * alone.degrees_of_freedom()],
        }
    }

    /// The number m of degrees of freedom, without time.
    pub fn degrees_of_freedom(&self) -> usize {
        self.y.len() / 2 - usize::from(self.has_time)
    }

    /// g at time `t`, positions `q` and momenta `p`, each of length m.
    ///
    /// # Panics
    /// If `q` or `p` has another length.
    pub fn value(&mut self, t: T, q: &[T], p: &[T]) -> T {
        self.place(t, q, p);
        self.evaluator.value(&self.y)
    }

    /// The same, with long sums [compensated](Evaluator::compensated_value).
    ///
    /// # Panics
    /// If `q` or `p` has another length.
    pub fn compensated_value(&mut self, t: T, q: &[T], p: &[T]) -> T {
        self.place(t, q, p);
        self.evaluator.compensated_value(&self.y)
    }

    /// The evaluator, and the point (t, `q`, `p`) in the form that it takes.
    #[doc(hidden)]
    pub fn evaluator_at(&mut self, t: T, q: &[T], p: &[T]) -> (&mut Evaluator<T>, &[T]) {
        self.place(t, q, p);
        (&mut self.evaluator, &self.y)
    }

    fn place(&mut self, t: T, q: &[T], p: &[T]) {
        let m = self.degrees_of_freedom();
        let (positions, momenta) = self.y.split_at_mut(m + usize::from(self.has_time));
        positions[..m].copy_from_slice(q);
        momenta[..m].copy_from_slice(p);
        if let Some(time) = positions.get_mut(m) {
            *time = t;
        }
    }
}
