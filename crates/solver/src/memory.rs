//! [`SolverMemory`]: where the state of a solver between steps is written to, or restored from.

use equip_scalar::Float;
use std::slice::from_mut;

/// Everything on which the next step depends, apart from state, time and size, as named lists of numbers. A
/// solver that restores it continues bit for bit. The meaning of the names is internal to the solver. Each
/// list is named once: the same call writes it, or replaces it by the stored one.
pub trait SolverMemory<T: Float> {
    /// Whether lists are restored.
    fn is_read(&self) -> bool;

    /// Writes `numbers` under this name, or replaces them by the stored list of this name.
    fn list(&mut self, name: &'static str, numbers: &mut Vec<T>);

    /// Called with what holds of the list of this name in every memory. If it does not hold, the solver must
    /// be discarded.
    fn check_that(&mut self, is_right: bool, name: &'static str);

    /// [`list`](Self::list) for a list whose length does not change.
    fn numbers(&mut self, name: &'static str, numbers: &mut [T]) {
        let mut list = numbers.to_vec();
        self.list(name, &mut list);
        self.check_that(list.len() == numbers.len(), name);
        if list.len() == numbers.len() {
            numbers.copy_from_slice(&list);
        }
    }

    /// [`list`](Self::list) for one double.
    fn double(&mut self, name: &'static str, number: &mut f64) {
        let mut stored = T::exact(*number);
        self.numbers(name, from_mut(&mut stored));
        if self.is_read() {
            *number = stored.to_f64();
        }
    }
}
