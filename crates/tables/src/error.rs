//! [`TableError`]: why a table, or a function with its derivatives, was rejected.

/// Why a table could not be built from data, or why a function was rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Fewer knots than the spline needs.
    #[error("this spline needs at least {needed} knots, not {found}; give more points")]
    TooFewKnots {
        /// Knots given.
        found: usize,
        /// Knots needed.
        needed: usize,
    },

    /// Not one value for each knot.
    #[error("{values} values were given for {knots} knots; give one value for each knot")]
    Lengths {
        /// Knots given; in two variables their product.
        knots: usize,
        /// Values given.
        values: usize,
    },

    /// The knots do not ascend.
    #[error("knot {index} is not larger than the knot before; sort the knots and give each once")]
    NotAscending {
        /// Index of the knot, counted from 0.
        index: usize,
    },

    /// A number is NaN or infinite.
    #[error("{what} {index} is NaN or infinite; omit missing points")]
    NotFinite {
        /// `knot`, `value` or `condition at end`.
        what: &'static str,
        /// Its index, counted from 0.
        index: usize,
    },

    /// The spline does not fit into the range of numbers.
    #[error(
        "the spline overflows between knots {index} and {}; use other units, or move the knots apart",
        index + 1
    )]
    Overflow {
        /// Index of the knot before.
        index: usize,
    },

    /// The argument is outside the range of the table.
    #[error("{x:e} is outside the range of the table, {first:e} to {last:e}")]
    OutsideOfTable {
        /// The argument.
        x: f64,
        /// First knot.
        first: f64,
        /// Last knot.
        last: f64,
    },

    /// A closure for a derivative disagrees with differences of the function.
    #[error(
        "at {x:e} derivative {order} of the function is {given:e}, but differences of derivative {} give \
         {expected:e}; correct the closure",
        order - 1
    )]
    WrongDerivative {
        /// 1 for f′, 2 for f″.
        order: u8,
        /// The argument.
        x: f64,
        /// The value of the closure.
        given: f64,
        /// The value from differences.
        expected: f64,
    },

    /// The bytes are not a table.
    #[error("these bytes are not a table of this version; build the table again from its points")]
    Damaged,
}
