//! [`Table`]: the cubic spline through points.

use crate::alternating::Alternating;
use crate::bytes;
use crate::error::TableError;
use crate::knots::Knots;
use crate::polynomial::{derivative, words};
use crate::spline::{End, check_ends, spline};
use equip_scalar::{DoubleDouble, Num, Outside, Scalar};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The cubic spline y(x) through the points (x_i, y_i), with ascending knots x_i of any spacing.
///
/// y, y′ and y″ are continuous; y‴ jumps at the knots, where it has the value of the interval above. **If the
/// motion leaves the range of the table, the run ends with an error**, which has the time and the argument.
/// [`extrapolated`](Self::extrapolated) continues the polynomials of the end intervals instead. If you
/// evaluate H yourself, outside of a run, H always uses the continued polynomials.
///
/// x and y are doubles or double-doubles. The spline is computed in double-double, so in a double-double run
/// it interpolates the given numbers to 31 digits. For smooth y its error is O(h⁴), with h the distance of
/// the knots. Near natural ends at which the true y″ is not 0, the error is O(h²).
///
/// A copy refers to the same table and costs a pointer.
///
/// ```
/// use equip_tables::Table;
/// let x: Vec<f64> = (-40..=40).map(|i| 0.1 * f64::from(i)).collect();
/// let y: Vec<f64> = x.iter().map(|x| -x.cos()).collect();
/// let v = Table::not_a_knot(&x, &y)?;
/// let [y, slope, curvature, _] = v.derivatives(1.234)?;
/// assert!((y + 1.234_f64.cos()).abs() < 3e-7);
/// assert!((slope - 1.234_f64.sin()).abs() < 2e-5);
/// assert!((curvature - 1.234_f64.cos()).abs() < 1e-3);
/// # Ok::<(), equip_tables::TableError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Table {
    interpolant: Arc<Interpolant>,
}

impl Table {
    /// The spline with y″ = 0 at both ends, through 2 points or more.
    ///
    /// # Errors
    /// [`TableError`] if there are too few knots, not as many values as knots, if a number is NaN or
    /// infinite, if the knots are not ascending, or if the spline overflows.
    ///
    /// ```
    /// use equip_tables::{Table, TableError};
    /// let unsorted = Table::natural(&[0.0, 2.0, 1.0], &[0.0; 3]);
    /// assert_eq!(unsorted.err(), Some(TableError::NotAscending { index: 2 }));
    /// ```
    pub fn natural<X: Into<DoubleDouble> + Copy>(x: &[X], y: &[X]) -> Result<Self, TableError> {
        Self::new(x, y, [End::Curvature(DoubleDouble::ZERO); 2])
    }

    /// The spline with given y′ at both ends, through 2 points or more.
    ///
    /// # Errors
    /// As [`natural`](Self::natural).
    pub fn clamped<X: Into<DoubleDouble> + Copy>(
        x: &[X],
        y: &[X],
        slopes: [X; 2],
    ) -> Result<Self, TableError> {
        Self::new(x, y, slopes.map(|slope| End::Slope(slope.into())))
    }

    /// The spline with given y″ at both ends, through 2 points or more.
    ///
    /// # Errors
    /// As [`natural`](Self::natural).
    pub fn with_curvatures<X: Into<DoubleDouble> + Copy>(
        x: &[X],
        y: &[X],
        curvatures: [X; 2],
    ) -> Result<Self, TableError> {
        let end = |curvature: X| End::Curvature(curvature.into());
        Self::new(x, y, curvatures.map(end))
    }

    /// The spline with continuous y‴ at the second and the last but one knot, through 4 points or more. Use
    /// it if nothing is known about y at the ends. It reproduces cubic polynomials.
    ///
    /// # Errors
    /// As [`natural`](Self::natural).
    pub fn not_a_knot<X: Into<DoubleDouble> + Copy>(x: &[X], y: &[X]) -> Result<Self, TableError> {
        Self::new(x, y, [End::NotAKnot; 2])
    }

    pub(crate) fn new<X: Into<DoubleDouble> + Copy>(
        x: &[X],
        y: &[X],
        ends: [End; 2],
    ) -> Result<Self, TableError> {
        let knots = Arc::new(Knots::new(x)?);
        check_ends(knots.len(), ends)?;
        let y = finite_values(y, knots.len())?;
        let pieces = spline(&knots.pairs, &y, ends);
        let rounded: Vec<[f64; 4]> = (pieces.iter()).map(|piece| piece.map(|c| c.hi())).collect();
        if let Some(index) = rounded
            .iter()
            .position(|c| !c.iter().all(|c| c.is_finite()))
        {
            return Err(TableError::Overflow { index });
        }
        let starts = knots.pairs.iter().map(|x| x.hi());
        let interpolant = Interpolant {
            rounded: starts.zip(rounded).collect(),
            pieces,
            kinks: Alternating::of(&knots, 0, 1),
            values: y,
            ends,
            knots,
            is_extrapolated: false,
        };
        Ok(Table {
            interpolant: Arc::new(interpolant),
        })
    }

    /// The same table, continued beyond its ends with the polynomials of its end intervals. Runs continue
    /// there, although there is no data.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_tables::Table;
    ///
    /// let v = Table::natural(&[0.0, 1.0, 2.0], &[0.0, -0.5, 0.0])?;
    /// let may_leave = |v: &Table| {
    ///     let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap();
    ///     h.switches().domains().is_empty()
    /// };
    /// assert!(!may_leave(&v) && may_leave(&v.extrapolated()));
    /// # Ok::<(), equip_tables::TableError>(())
    /// ```
    #[must_use]
    pub fn extrapolated(&self) -> Self {
        let mut table = self.clone();
        Arc::make_mut(&mut table.interpolant).is_extrapolated = true;
        table
    }

    pub(crate) fn outside(&self) -> Arc<dyn Outside> {
        self.interpolant.clone()
    }

    /// y(x), in an energy: `v.at(q[0])`.
    #[inline]
    pub fn at<S: Scalar>(&self, x: Num<S>) -> Num<S> {
        Num(S::outside(&self.outside(), [0, 0], [x.0, x.0]))
    }

    /// y′(x), in an energy.
    #[inline]
    pub fn derivative_at<S: Scalar>(&self, x: Num<S>) -> Num<S> {
        Num(S::outside(&self.outside(), [1, 0], [x.0, x.0]))
    }

    /// \[y, y′, y″, y‴\] at x, for plots and checks.
    ///
    /// # Errors
    /// [`TableError::OutsideOfTable`] if x is outside the range of the table.
    pub fn derivatives(&self, x: f64) -> Result<[f64; 4], TableError> {
        let (first, last) = (*self.range().start(), *self.range().end());
        if !(first <= x && x <= last) {
            return Err(TableError::OutsideOfTable { x, first, last });
        }
        Ok([0, 1, 2, 3].map(|order| self.interpolant.derivative([order, 0], [x, x])))
    }

    /// The range from the first to the last knot.
    pub fn range(&self) -> RangeInclusive<f64> {
        let knots = &self.interpolant.knots;
        knots.first()..=knots.last()
    }

    /// The number of intervals.
    pub fn intervals(&self) -> usize {
        self.interpolant.pieces.len()
    }
}

/// The values, one for each knot.
pub(crate) fn finite_values<X: Into<DoubleDouble> + Copy>(
    values: &[X],
    knots: usize,
) -> Result<Vec<DoubleDouble>, TableError> {
    let values: Vec<DoubleDouble> = values.iter().map(|&y| y.into()).collect();
    if values.len() != knots {
        let values = values.len();
        return Err(TableError::Lengths { knots, values });
    }
    match values.iter().position(|y| !y.is_finite()) {
        Some(index) => Err(TableError::NotFinite {
            what: "value",
            index,
        }),
        None => Ok(values),
    }
}

/// Polynomials between knots.
#[derive(Debug, Clone)]
struct Interpolant {
    knots: Arc<Knots>,
    kinks: Option<Arc<dyn Outside>>,
    /// What the polynomials are made of.
    values: Vec<DoubleDouble>,
    ends: [End; 2],
    /// Whether runs may leave the table.
    is_extrapolated: bool,
    /// Coefficients of each interval.
    pieces: Vec<[DoubleDouble; 4]>,
    /// Its first knot and its coefficients, as doubles.
    rounded: Vec<(f64, [f64; 4])>,
}

impl Interpolant {
    /// Compiled for each order that is used.
    #[inline(always)]
    fn each(&self, order: u8, x: &[f64], results: &mut [f64]) {
        for (result, &x) in results.iter_mut().zip(x) {
            *result = self.derivative([order, 0], [x, x]);
        }
    }
}

impl Outside for Interpolant {
    fn variables(&self) -> usize {
        1
    }

    #[inline(always)]
    fn derivative(&self, [order, _]: [u8; 2], [x, _]: [f64; 2]) -> f64 {
        let (start, coefficients) = self.rounded[self.knots.before(x)];
        derivative(coefficients, order, x - start)
    }

    fn derivatives(&self, [order, _]: [u8; 2], [x, _]: [&[f64]; 2], results: &mut [f64]) {
        match order {
            0 => self.each(0, x, results),
            1 => self.each(1, x, results),
            2 => self.each(2, x, results),
            order => self.each(order, x, results),
        }
    }

    fn derivative_in_pairs(&self, [order, _]: [u8; 2], [[hi, lo], _]: [[f64; 2]; 2]) -> [f64; 2] {
        let x = DoubleDouble::new(hi, lo);
        let interval = self.knots.before_pair(x);
        let t = x - self.knots.pairs[interval];
        words(derivative(self.pieces[interval], order, t))
    }

    fn to_bytes(&self) -> Option<Vec<u8>> {
        let flag = self.is_extrapolated;
        let knots = &self.knots.pairs[..];
        Some(bytes::write((self.ends, flag), &[knots], &self.values))
    }

    fn domain(&self, _axis: usize) -> Option<[f64; 2]> {
        (!self.is_extrapolated).then(|| [self.knots.first(), self.knots.last()])
    }

    fn kinks(&self) -> Vec<Arc<dyn Outside>> {
        self.kinks.iter().cloned().collect()
    }
}
