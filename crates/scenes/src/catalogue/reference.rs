//! [`Reference`]: a stored end state, computed once with more digits than the runs that use it.

use super::any_model::{AnyModel, with_model};
use crate::model::{momenta, read};
use crate::reference::{self, End, ReferenceData};
use equip_scalar::Float;

/// A stored end state, with a bound on its error.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    pub(crate) data: &'static ReferenceData,
    pub(crate) model: &'a AnyModel,
}

impl Reference<'_> {
    /// Name, as in [`Instance::from_reference`](crate::Instance::from_reference).
    pub fn name(&self) -> &'static str {
        self.data.name
    }

    /// The time of the end state.
    pub fn end<T: Float>(&self) -> T {
        match self.data.end {
            End::Double(end) => T::exact(end),
            End::Decimal(end) => read(end),
        }
    }

    /// (q, p) at the end.
    pub fn state<T: Float>(&self) -> (Vec<T>, Vec<T>) {
        let q = self.data.q.iter().map(|text| read(text)).collect();
        let velocities = self.data.v.iter().map(|text| read(text));
        (q, with_model!(self.model, m => momenta(m, velocities)))
    }

    /// H along the solution.
    pub fn energy<T: Float>(&self) -> T {
        read(self.data.energy)
    }

    /// Bound on the error of [`energy`](Self::energy), from its digits.
    pub fn energy_error(&self) -> f64 {
        self.data.energy_error
    }

    /// Bound on the error of every component of [`state`](Self::state).
    pub fn trusted_error(&self) -> f64 {
        self.data.trusted_error
    }
}

/// The names that [`Instance::from_reference`](crate::Instance::from_reference) accepts.
pub fn reference_names() -> impl Iterator<Item = &'static str> {
    reference::ALL.iter().map(|r| r.name)
}
