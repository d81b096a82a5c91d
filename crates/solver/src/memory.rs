//! [`SolverMemory`]: what a solver has learnt from the steps so far, as named lists of numbers.

use crate::outcome::failure::Damaged;
use equip_scalar::Float;

/// Everything the next step depends on besides state, time and size, so that a solver that is given it goes
/// on bit for bit. What the names stand for is the solver's own affair; numbers are exact, counts among them
/// up to 2⁵³.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverMemory<T> {
    parts: Vec<(String, Vec<T>)>,
}

impl<T: Float> SolverMemory<T> {
    /// One of these parts, as [`parts`](Self::parts) gives them.
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

    pub(crate) fn put_counts(&mut self, name: &str, counts: impl IntoIterator<Item = u64>) {
        let number = |count| T::int(i64::try_from(count).unwrap_or(i64::MAX));
        self.put(name, counts.into_iter().map(number));
    }

    /// The part of this name, if there is one.
    pub(crate) fn find(&self, name: &str) -> Option<&[T]> {
        let mut parts = self.parts.iter();
        parts
            .find(|part| part.0 == name)
            .map(|part| part.1.as_slice())
    }

    /// Reads the part of this name into `out`, which it has to fill.
    pub(crate) fn read(&self, name: &'static str, out: &mut [T]) -> Result<(), Damaged> {
        match self.find(name) {
            Some(part) if part.len() == out.len() => {
                out.copy_from_slice(part);
                Ok(())
            }
            _ => Err(Damaged { what: name }),
        }
    }

    /// So many numbers.
    pub(crate) fn numbers<const N: usize>(&self, name: &'static str) -> Result<[T; N], Damaged> {
        let mut numbers = [T::int(0); N];
        self.read(name, &mut numbers)?;
        Ok(numbers)
    }

    /// So many counts.
    pub(crate) fn counts<const N: usize>(&self, name: &'static str) -> Result<[u64; N], Damaged> {
        let numbers = self.numbers::<N>(name)?;
        let mut counts = [0; N];
        for (count, number) in counts.iter_mut().zip(numbers) {
            *count = as_count(number).ok_or(Damaged { what: name })?;
        }
        Ok(counts)
    }
}

/// A number that is a count.
pub(crate) fn as_count<T: Float>(number: T) -> Option<u64> {
    let count = number.to_f64();
    let whole = (0.0..9.1e15).contains(&count) && count.fract() == 0.0;
    (whole && T::exact(count) == number).then_some(count as u64)
}
