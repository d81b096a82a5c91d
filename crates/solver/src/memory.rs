//! [`SolverMemory`]: the state of a solver between steps, as named lists of numbers.

use crate::outcome::failure::Damaged;
use equip_scalar::Float;

/// Everything on which the next step depends, apart from state, time and size. A solver that restores it
/// continues bit for bit. The meaning of the names is internal to the solver.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverMemory<T> {
    parts: Vec<(String, Vec<T>)>,
}

impl<T: Float> SolverMemory<T> {
    /// A memory with these parts, as returned by [`parts`](Self::parts).
    pub fn from_parts(parts: Vec<(String, Vec<T>)>) -> Self {
        SolverMemory { parts }
    }

    /// The parts, each with its name.
    pub fn parts(&self) -> &[(String, Vec<T>)] {
        &self.parts
    }

    pub(crate) fn put(&mut self, name: &str, numbers: impl IntoIterator<Item = T>) {
        let numbers = numbers.into_iter().collect();
        self.parts.push((name.to_owned(), numbers));
    }

    /// The part of this name, if there is one.
    pub(crate) fn find(&self, name: &str) -> Option<&[T]> {
        let mut parts = self.parts.iter();
        parts
            .find(|part| part.0 == name)
            .map(|part| part.1.as_slice())
    }

    /// Reads the part of this name into `out`. Their lengths must agree.
    pub(crate) fn read(&self, name: &'static str, out: &mut [T]) -> Result<(), Damaged> {
        match self.find(name) {
            Some(part) if part.len() == out.len() => {
                out.copy_from_slice(part);
                Ok(())
            }
            _ => Err(Damaged { what: name }),
        }
    }

    /// Reads the part of this name as N numbers.
    pub(crate) fn numbers<const N: usize>(&self, name: &'static str) -> Result<[T; N], Damaged> {
        let mut numbers = [T::int(0); N];
        self.read(name, &mut numbers)?;
        Ok(numbers)
    }
}
