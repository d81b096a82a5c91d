//! [`BuildError`]: why an energy was rejected; [`BytesError`]: why an energy could not be written or read.

use std::panic::Location;

/// Why a Hamiltonian could not be built, or a supplied gradient is wrong.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// There is no degree of freedom.
    #[error("the number of degrees of freedom is 0; give the number of positions, at least 1")]
    NoDegreesOfFreedom,

    /// There are more degrees of freedom than a trace can hold.
    #[error(
        "{m} degrees of freedom exceed the limit of 2^29; \
         use fewer, or integrate independent parts one by one"
    )]
    TooManyDegreesOfFreedom {
        /// The number of degrees of freedom requested.
        m: usize,
    },

    /// There are more operations than a trace can hold.
    #[error(
        "the energy exceeds the limit of 2^31 operations; \
         omit negligible terms, such as forces between distant particles"
    )]
    TooManyOperations,

    /// The energy compares the state with something.
    #[error(
        "the energy compares variables of the state at {location}, but H is traced once, before any state is known; \
         write the piecewise part with .min(), .max(), .abs() or .select(), or choose between two Hamiltonians outside H"
    )]
    Branch {
        /// The source location of the comparison.
        location: &'static Location<'static>,
    },

    /// The energy reads a number out of the state.
    #[error(
        "the energy converts a variable of the state to a number at {location}, but H is traced before any state is \
         known; compute with the variable itself (it has .sqrt(), .sin(), .powf(), ...)"
    )]
    ReadOut {
        /// The source location of the read-out.
        location: &'static Location<'static>,
    },

    /// The energy uses a variable of another trace.
    #[error(
        "the energy uses a variable of another energy; capture plain numbers \
         (f64, ratio, decimal, DoubleDouble) and derive variables from q, p and these numbers only"
    )]
    ForeignVariable,

    /// A constant of the energy is NaN.
    #[error(
        "a constant of the energy is NaN; check the captured parameters, and products, quotients and \
         roots of constants, such as 0/0"
    )]
    ConstantNotANumber,

    /// A constant of the energy is infinite.
    #[error(
        "a constant of the energy is infinite; check the captured parameters, and quotients and powers \
         of constants, such as 1/0; omit infinite bounds"
    )]
    ConstantInfinite,

    /// An invalid entry of a bracket.
    #[error(
        "entry ({row}, {column}) of the bracket is on the diagonal, outside the {components} components, or \
         given twice; give each pair of components once, counted from 0: the transposed entry follows with the \
         opposite sign"
    )]
    BracketEntry {
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
        /// The number of components of the state.
        components: usize,
    },

    /// A bracket was given for an energy that depends on time.
    #[error(
        "an energy that depends on time cannot have a bracket; make time a component of the state, with a \
         conjugate momentum, or omit the bracket"
    )]
    BracketWithTime,

    /// The accuracy of an external energy is not a relative rounding error.
    #[error(
        "the accuracy {accuracy:e} of an external energy must be the relative error of its values; give 2.2e-16 \
         for values in double precision, 1e-7 for values in single precision"
    )]
    Accuracy {
        /// The accuracy given.
        accuracy: f64,
    },

    /// A mass of an external potential has no finite inverse.
    #[error(
        "mass {component} is {mass:e}; give one finite mass, not 0, for each component of q, in units in which \
         1/m is finite too"
    )]
    Mass {
        /// The component, counted from 0.
        component: usize,
        /// The mass given.
        mass: f64,
    },

    /// The supplied gradient is not the gradient of the energy.
    #[error(
        "component {component} of the supplied gradient is {given:e}, but that of the energy is {expected:e} \
         (components 0..m are ∂H/∂q, m..2m are ∂H/∂p); correct the gradient, or omit it"
    )]
    WrongGradient {
        /// The component of (∂H/∂q, ∂H/∂p), counted from 0.
        component: usize,
        /// The component of the supplied gradient.
        given: f64,
        /// The derivative of the energy by automatic differentiation.
        expected: f64,
    },
}

/// Why an energy could not be written as bytes or read from bytes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BytesError {
    /// The energy calls a function that cannot be written as data.
    #[error(
        "the energy uses {function}, which is code and cannot be stored; write it with the functions of H, or \
         give it as a table"
    )]
    NotData {
        /// The description of the function.
        function: String,
    },

    /// H is an external energy.
    #[error("an external energy cannot be stored; write it as a closure of q and p")]
    External,

    /// H has many components, and depends on few of them.
    #[error(
        "the energy has {components} components but depends on few of them, and cannot be stored; omit the \
         components on which H does not depend"
    )]
    ComponentsNotUsed {
        /// The number of components of the state.
        components: usize,
    },

    /// There is not enough memory for the trace.
    #[error(
        "not enough memory for an energy of {components} components; read it on a machine with more memory, or \
         end other programs"
    )]
    OutOfMemory {
        /// The number of components of the state.
        components: usize,
    },

    /// The bytes do not begin like an energy.
    #[error("these bytes are not an energy; give all bytes that Hamiltonian::to_bytes returned")]
    NotAnEnergy,

    /// The bytes have another version of the format.
    #[error(
        "these bytes have format {found}, but this version of the library reads format {known}; trace the \
         energy again"
    )]
    Format {
        /// The format of the bytes.
        found: u32,
        /// The supported format.
        known: u32,
    },

    /// The checksum or the number of bytes is wrong.
    #[error("these bytes are damaged: {what}; trace the energy again, or use another copy")]
    Damaged {
        /// What is wrong.
        what: &'static str,
    },

    /// A table in the bytes could not be read.
    #[error(
        "the energy has an external function that was not read; give from_bytes_with a reader for it, such as \
         tables::from_bytes"
    )]
    UnknownFunction,

    /// The bytes are complete, but the energy in them is invalid.
    #[error(transparent)]
    Refused(#[from] BuildError),
}
