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
        "{m} degrees of freedom are more than the 2^29 of which a recording has places; \
         write the energy with fewer, or integrate independent parts one by one"
    )]
    TooManyDegreesOfFreedom {
        /// The number of degrees of freedom requested.
        m: usize,
    },

    /// There are more operations than a trace can hold.
    #[error(
        "the energy has more than the 2^31 operations of which a recording has places; \
         leave out what is too small to matter, such as forces between distant particles"
    )]
    TooManyOperations,

    /// The energy compares the state with something.
    #[error(
        "the energy compares the state at {location}, but it is recorded once and replayed at every state; \
         write the piecewise part with .min(), .max(), .abs() or .select(), or choose between two Hamiltonians outside"
    )]
    Branch {
        /// The source location of the comparison.
        location: &'static Location<'static>,
    },

    /// The energy reads a number out of the state.
    #[error(
        "the energy reads a number out of the state at {location}, but it is recorded before any state is \
         known; compute with the variable itself (it has .sqrt(), .sin(), .powf(), ...)"
    )]
    ReadOut {
        /// The source location of the read-out.
        location: &'static Location<'static>,
    },

    /// The energy uses a variable of another trace.
    #[error(
        "the energy uses a variable that was not made inside it; capture plain numbers \
         (f64, ratio, decimal, DoubleDouble) and make variables from q, p and these only"
    )]
    ForeignVariable,

    /// A constant of the energy is NaN.
    #[error(
        "a constant of the energy is NaN; check the parameters captured by it, and products, quotients and \
         roots of constants such as 0/0"
    )]
    ConstantNotANumber,

    /// A constant of the energy is infinite.
    #[error(
        "a constant of the energy is infinite; check the parameters captured by it, and quotients and powers \
         of constants such as 1/0, and leave out bounds that are infinite"
    )]
    ConstantInfinite,

    /// An invalid entry of a bracket.
    #[error(
        "entry ({row}, {column}) of the bracket is on the diagonal, outside of the {components} components, or \
         named twice; name each pair of two components once, counted from 0: the other entry follows with the \
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
        "the energy depends on time and has a bracket of its own, which is not integrated; make time a \
         component of the state with an energy that moves it, or leave out the bracket"
    )]
    BracketWithTime,

    /// The accuracy of an external energy is not a relative rounding error.
    #[error(
        "the accuracy {accuracy:e} of an external energy is no relative error of its values; give 2.2e-16 for \
         values computed in doubles, 1e-7 for those in single precision"
    )]
    Accuracy {
        /// The accuracy given.
        accuracy: f64,
    },

    /// The supplied gradient is not the gradient of the energy.
    #[error(
        "component {component} of the supplied gradient is {given:e}, but the energy has {expected:e} there \
         (components 0..m are the derivatives by q, m..2m those by p); correct it, or leave it out"
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
        "the energy uses {function}, which is code and cannot be written; write it with the functions of H, or \
         give it as a table"
    )]
    NotData {
        /// The description of the function.
        function: String,
    },

    /// H is an external energy.
    #[error(
        "the energy is computed by code of its own and cannot be written; write it as a closure of q and p"
    )]
    External,

    /// H has many components, and depends on few of them.
    #[error(
        "the energy has {components} components and depends on few of them, which bytes of a recording do not \
         hold; leave the others out, they do not move H"
    )]
    ComponentsNotUsed {
        /// The number of components of the state.
        components: usize,
    },

    /// There is not enough memory for the trace.
    #[error(
        "there is no memory for an energy of {components} components; read it on a machine with more, or end \
         other programs"
    )]
    OutOfMemory {
        /// The number of components of the state.
        components: usize,
    },

    /// The bytes do not begin like an energy.
    #[error("these bytes are no energy; give those that Hamiltonian::to_bytes made, all of them")]
    NotAnEnergy,

    /// The bytes have another version of the format.
    #[error(
        "these bytes have format {found}, and this version of the library reads format {known}; record the \
         energy anew"
    )]
    Format {
        /// The format of the bytes.
        found: u32,
        /// The supported format.
        known: u32,
    },

    /// The checksum or the number of bytes is wrong.
    #[error("these bytes are damaged: {what}; record the energy anew, or use another copy")]
    Damaged {
        /// What is wrong.
        what: &'static str,
    },

    /// A table in the bytes could not be read.
    #[error(
        "the energy has a function from outside that was not read; give from_bytes_with what reads it, as \
         tables::from_bytes does"
    )]
    UnknownFunction,

    /// The bytes are complete, but the energy in them is invalid.
    #[error(transparent)]
    Refused(#[from] BuildError),
}
