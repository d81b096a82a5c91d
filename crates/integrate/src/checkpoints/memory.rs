//! [`Memory`]: the numbers of a run, written to a checkpoint or read from it in the same order.
//!
//! Everything that a checkpoint stores is listed once. The same list writes the numbers of a run and restores
//! them. An error is kept until [`Memory::check`]; the numbers after it are then not restored.

use crate::checkpoints::exact::Exact;
use crate::error::IntegrateError;
use equip_scalar::Float;
use equip_solver::SolverMemory;
use std::slice::{self, from_mut};

/// Lists of numbers by name.
pub(crate) type Numbers = Vec<(String, Vec<Exact>)>;

/// The numbers of a checkpoint while they are written or read.
#[derive(Debug)]
pub(crate) struct Memory<'a> {
    numbers: Way<'a>,
    /// The first list that could not be read.
    damaged: Option<&'static str>,
}

#[derive(Debug)]
enum Way<'a> {
    Written(&'a mut Numbers),
    /// Those that have not been read yet.
    Read(slice::Iter<'a, (String, Vec<Exact>)>),
}

impl<'a> Memory<'a> {
    pub(crate) fn to_write(numbers: &'a mut Numbers) -> Self {
        Memory {
            numbers: Way::Written(numbers),
            damaged: None,
        }
    }

    pub(crate) fn to_read(numbers: &'a Numbers) -> Self {
        Memory {
            numbers: Way::Read(numbers.iter()),
            damaged: None,
        }
    }

    /// # Errors
    /// If a list was missing or damaged.
    pub(crate) fn check<T: Float>(&self) -> Result<(), IntegrateError<T>> {
        match self.damaged {
            Some(what) => Err(IntegrateError::CheckpointDamaged { what }),
            None => Ok(()),
        }
    }

    /// Writes or reads `values`, of which there are as many in the checkpoint.
    pub(crate) fn any<T: Float>(&mut self, name: &'static str, values: &mut [T]) {
        if let Some(stored) = self.next(name, || Exact::all(values)) {
            let read = Exact::read_all::<T>(stored, values, name);
            self.check_that(read.is_ok(), name);
        }
    }

    /// The same for values that must be finite.
    pub(crate) fn finite<T: Float>(&mut self, name: &'static str, values: &mut [T]) {
        self.any(name, values);
        self.check_that(values.iter().all(|x| x.is_finite()), name);
    }

    /// The same for values that a run may not have.
    pub(crate) fn optional<T: Float, const N: usize>(
        &mut self,
        name: &'static str,
        values: Option<[T; N]>,
    ) -> Option<[T; N]> {
        let stored = self.next(name, || values.map_or(Vec::new(), |x| Exact::all(&x)));
        let Some(stored) = stored else {
            return values;
        };
        if stored.is_empty() {
            return None;
        }
        let mut values = [T::int(0); N];
        let read = Exact::read_all(stored, &mut values, name);
        self.check_that(read.is_ok(), name);
        Some(values)
    }

    /// The same for one number that a run may not have.
    pub(crate) fn one<T: Float>(&mut self, name: &'static str, value: Option<T>) -> Option<T> {
        self.optional(name, value.map(|x| [x])).map(|[x]| x)
    }

    /// The same for a whole number, below 2⁵³.
    pub(crate) fn whole<T: Float>(&mut self, name: &'static str, number: i64) -> i64 {
        let mut stored = T::int(number);
        self.finite(name, from_mut(&mut stored));
        let number = stored.to_f64();
        self.check_that(number.abs() < 2_f64.powi(53) && number.fract() == 0.0, name);
        number as i64
    }

    /// The same for a count.
    pub(crate) fn count<T: Float>(&mut self, name: &'static str, count: u64) -> u64 {
        let count = self.whole::<T>(name, count as i64);
        self.check_that(count >= 0, name);
        count as u64
    }

    /// Writes a list, or returns the next one, which must have this name.
    fn next(
        &mut self,
        name: &'static str,
        written: impl FnOnce() -> Vec<Exact>,
    ) -> Option<&'a [Exact]> {
        match &mut self.numbers {
            Way::Written(numbers) => {
                numbers.push((name.to_owned(), written()));
                None
            }
            Way::Read(left) => {
                let next = left.next().filter(|(stored, _)| stored == name);
                self.check_that(next.is_some(), name);
                next.map(|(_, numbers)| numbers.as_slice())
            }
        }
    }

    /// Requires what holds of every run.
    pub(crate) fn check_that(&mut self, is_right: bool, name: &'static str) {
        if !is_right {
            self.damaged.get_or_insert(name);
        }
    }
}

/// The lists of the solver.
impl<T: Float> SolverMemory<T> for Memory<'_> {
    fn is_read(&self) -> bool {
        matches!(self.numbers, Way::Read(_))
    }

    fn list(&mut self, name: &'static str, numbers: &mut Vec<T>) {
        let Some(stored) = self.next(name, || Exact::all(numbers)) else {
            return;
        };
        let read = stored.iter().map(Exact::read);
        match read.collect::<Result<_, _>>() {
            Ok(read) => *numbers = read,
            Err(_) => self.check_that(false, name),
        }
        // The gradients begin with a state that is NaN if there are none.
        let is_none = name == "gradients" && numbers.first().is_some_and(|x| x.is_nan());
        self.check_that(is_none || !numbers.iter().any(|x| x.is_nan()), name);
    }

    fn check_that(&mut self, is_right: bool, name: &'static str) {
        Memory::check_that(self, is_right, name);
    }
}
