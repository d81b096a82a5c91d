//! [`TableError`]: why a table or a function with its derivatives was not accepted.

/// Why data make no table, or a function has other derivatives than those given for it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Fewer knots than the spline needs.
    #[error("{found} knots are too few for this spline, which needs {needed}; give more points")]
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

    /// A knot is not above the one before.
    #[error("knot {index} is not above the one before; sort the knots and give each of them once")]
    NotAscending {
        /// Index of the knot, counted from 0.
        index: usize,
    },

    /// A number is NaN or infinite.
    #[error("{what} {index} is NaN or infinite; leave out points that were not measured")]
    NotFinite {
        /// `knot`, `value` or `condition at end`.
        what: &'static str,
        /// Its index, counted from 0.
        index: usize,
    },

    /// The spline does not fit into the range of numbers.
    #[error(
        "the spline overflows between knots {index} and {}; measure in other units, or move knots apart",
        index + 1
    )]
    Overflow {
        /// Index of the knot before.
        index: usize,
    },

    /// The table says nothing there.
    #[error("{x:e} is outside of the table, which begins at {first:e} and ends at {last:e}")]
    OutsideOfTable {
        /// Where a value was requested.
        x: f64,
        /// First knot.
        first: f64,
        /// Last knot.
        last: f64,
    },

    /// A derivative given with a function is not its derivative.
    #[error(
        "derivative {order} of the function is {given:e} at {x:e}, but differences of derivative {} give \
         {expected:e}; correct the closure",
        order - 1
    )]
    WrongDerivative {
        /// 1 for f′, 2 for f″.
        order: u8,
        /// Where.
        x: f64,
        /// What the closure says.
        given: f64,
        /// What differences say.
        expected: f64,
    },

    /// Bytes from which a table was to be made are not those of one.
    #[error(
        "these bytes are no table that this version knows; make the table anew from its points"
    )]
    Damaged,
}
