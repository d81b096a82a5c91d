//! What a row of the table of references holds.

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
