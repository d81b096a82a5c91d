//! [`Reference`]: a stored end state, computed once with more digits than any run here.

use crate::instance::{read, state};
use crate::model::AnyModel;
use crate::references;
use equip_scalar::Float;

/// Initial data that are doubles in every float type.
#[derive(Debug, PartialEq)]
pub(crate) struct Doubles {
    pub(crate) q: &'static [f64],
    pub(crate) v: &'static [f64],
}

/// The time of an end state.
#[derive(Debug, PartialEq)]
pub(crate) enum End {
    /// This double in every float type.
    Double(f64),
    /// Read in each.
    Decimal(&'static str),
}

/// A row of the table of references.
#[derive(Debug)]
pub(crate) struct ReferenceData {
    pub(crate) name: &'static str,
    pub(crate) scene: &'static str,
    pub(crate) parameters: &'static [(&'static str, &'static str)],
    /// Doubles to start from, or nothing if it starts like the scene.
    pub(crate) start: Option<Doubles>,
    pub(crate) end: End,
    pub(crate) q: &'static [&'static str],
    /// Velocities; momenta are masses times these.
    pub(crate) v: &'static [&'static str],
    pub(crate) energy: &'static str,
    pub(crate) energy_error: f64,
    pub(crate) trusted_error: f64,
}

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
        state(self.model, self.data.q, self.data.v)
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

/// The names [`Instance::from_reference`](crate::Instance::from_reference) knows.
pub fn reference_names() -> impl Iterator<Item = &'static str> {
    references::ALL.iter().map(|r| r.name)
}
