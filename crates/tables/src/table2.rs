//! [`Table2`]: the bicubic spline through values on a grid.

use crate::alternating::Alternating;
use crate::bytes;
use crate::error::TableError;
use crate::knots::Knots;
use crate::polynomial::{derivative, words};
use crate::spline::{End, check_ends, spline};
use crate::table::finite_values;
use equip_scalar::{DoubleDouble, Float, Num, Outside, Scalar};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The bicubic spline z(x, y) through values on a rectangular grid: the spline in x of the splines in y.
///
/// z and its derivatives up to ∂⁴z/∂x²∂y² are continuous; third derivatives in one variable jump at the grid
/// lines. **If the motion leaves the grid, the run ends with an error**, unless the table is
/// [`extrapolated`](Self::extrapolated). End conditions, accuracy and errors are those of
/// [`Table`](crate::Table). Memory: 400 bytes per cell.
///
/// ```
/// use equip_tables::Table2;
/// let (x, y) = ([0.0, 1.0, 2.0, 4.0], [-1.0, 0.0, 1.0, 2.0, 3.0]);
/// let f = |x: f64, y: f64| x * x * x * y + x * y * y;
/// let values: Vec<f64> = x.iter().flat_map(|&x| y.map(|y| f(x, y))).collect();
/// let v = Table2::not_a_knot(&x, &y, &values)?;
/// assert!((v.value(1.5, 0.3)? - f(1.5, 0.3)).abs() < 1e-14);
/// # Ok::<(), equip_tables::TableError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Table2 {
    interpolant: Arc<Interpolant>,
}

impl Table2 {
    /// The spline with ∂²z/∂x² = 0 at the first and last x, and ∂²z/∂y² = 0 at the first and last y; 2 knots
    /// or more in each variable. The value at (x_i, y_j) is `values[i * y.len() + j]`.
    ///
    /// # Errors
    /// [`TableError`] if there are too few knots, not as many values as points of the grid, if a number is
    /// NaN or infinite, if the knots are not ascending, or if the spline overflows.
    pub fn natural<X: Into<DoubleDouble> + Copy>(
        x: &[X],
        y: &[X],
        values: &[X],
    ) -> Result<Self, TableError> {
        Self::new(x, y, values, End::Curvature(DoubleDouble::ZERO))
    }

    /// The spline with continuous third derivatives at the second grid line from each edge; 4 knots or more
    /// in each variable. The value at (x_i, y_j) is `values[i * y.len() + j]`.
    ///
    /// # Errors
    /// As [`natural`](Self::natural).
    pub fn not_a_knot<X: Into<DoubleDouble> + Copy>(
        x: &[X],
        y: &[X],
        values: &[X],
    ) -> Result<Self, TableError> {
        Self::new(x, y, values, End::NotAKnot)
    }

    pub(crate) fn new<X: Into<DoubleDouble> + Copy>(
        x: &[X],
        y: &[X],
        values: &[X],
        end: End,
    ) -> Result<Self, TableError> {
        let knots = [Arc::new(Knots::new(x)?), Arc::new(Knots::new(y)?)];
        for knots in &knots {
            check_ends(knots.len(), [end; 2])?;
        }
        let values = finite_values(values, knots[0].len() * knots[1].len())?;
        let cells = cells(&knots, &values, [end; 2]);
        let rounded: Vec<[[f64; 4]; 4]> = (cells.iter())
            .map(|cell| cell.map(|row| row.map(|c| c.hi())))
            .collect();
        let is_finite = |cell: &[[f64; 4]; 4]| cell.as_flattened().iter().all(|c| c.is_finite());
        if let Some(cell) = rounded.iter().position(|cell| !is_finite(cell)) {
            let index = cell / (knots[1].len() - 1);
            return Err(TableError::Overflow { index });
        }
        let interpolant = Interpolant {
            kinks: [0, 1].map(|axis| Alternating::of(&knots[axis], axis, 2)),
            knots,
            values,
            end,
            is_extrapolated: false,
            cells,
            rounded,
        };
        Ok(Table2 {
            interpolant: Arc::new(interpolant),
        })
    }

    /// The same table, continued beyond the grid with the polynomials of the cells at its edge. Runs continue
    /// there, although there is no data.
    #[must_use]
    pub fn extrapolated(&self) -> Self {
        let mut table = self.clone();
        Arc::make_mut(&mut table.interpolant).is_extrapolated = true;
        table
    }

    pub(crate) fn outside(&self) -> Arc<dyn Outside> {
        self.interpolant.clone()
    }

    /// z(x, y), in an energy: `v.at(q[0], q[1])`.
    #[inline]
    pub fn at<S: Scalar>(&self, x: Num<S>, y: Num<S>) -> Num<S> {
        Num(S::outside(&self.outside(), [0, 0], [x.0, y.0]))
    }

    /// z(x, y), for plots and checks.
    ///
    /// # Errors
    /// [`TableError::OutsideOfTable`] if the point is outside the grid.
    pub fn value(&self, x: f64, y: f64) -> Result<f64, TableError> {
        for (x, range) in [x, y].into_iter().zip(self.range()) {
            if !range.contains(&x) {
                let (first, last) = (*range.start(), *range.end());
                return Err(TableError::OutsideOfTable { x, first, last });
            }
        }
        Ok(self.interpolant.derivative([0, 0], [x, y]))
    }

    /// The ranges of x and of y, from the first to the last knot.
    pub fn range(&self) -> [RangeInclusive<f64>; 2] {
        (self.interpolant.knots.each_ref()).map(|knots| knots.first()..=knots.last())
    }
}

/// Coefficients c_kl of Σ c_kl (x − x_i)ᵏ (y − y_j)ˡ, cell by cell, those of one i together.
fn cells(
    knots: &[Arc<Knots>; 2],
    values: &[DoubleDouble],
    ends: [End; 2],
) -> Vec<[[DoubleDouble; 4]; 4]> {
    let (rows, columns) = (knots[0].len(), knots[1].len());
    let in_y: Vec<Vec<[DoubleDouble; 4]>> = (values.chunks_exact(columns))
        .map(|values| spline(&knots[1].pairs, values, ends))
        .collect();
    let mut cells = vec![[[DoubleDouble::ZERO; 4]; 4]; (rows - 1) * (columns - 1)];
    for j in 0..columns - 1 {
        for l in 0..4 {
            let along_x: Vec<DoubleDouble> = in_y.iter().map(|row| row[j][l]).collect();
            let pieces = spline(&knots[0].pairs, &along_x, ends);
            for (i, piece) in pieces.into_iter().enumerate() {
                for (k, c) in piece.into_iter().enumerate() {
                    cells[i * (columns - 1) + j][k][l] = c;
                }
            }
        }
    }
    cells
}

/// Polynomials in the cells of a grid.
#[derive(Debug, Clone)]
struct Interpolant {
    knots: [Arc<Knots>; 2],
    kinks: [Option<Arc<dyn Outside>>; 2],
    /// What the polynomials are made of.
    values: Vec<DoubleDouble>,
    end: End,
    /// Whether runs may leave the table.
    is_extrapolated: bool,
    cells: Vec<[[DoubleDouble; 4]; 4]>,
    rounded: Vec<[[f64; 4]; 4]>,
}

impl Interpolant {
    #[inline(always)]
    fn cell(&self, [i, j]: [usize; 2]) -> usize {
        i * (self.knots[1].len() - 1) + j
    }
}

/// A derivative of the polynomial of a cell.
#[inline(always)]
fn in_cell<T: Float>(cell: &[[T; 4]; 4], orders: [u8; 2], t: [T; 2]) -> T {
    derivative(
        cell.map(|row| derivative(row, orders[1], t[1])),
        orders[0],
        t[0],
    )
}

impl Outside for Interpolant {
    fn variables(&self) -> usize {
        2
    }

    #[inline(always)]
    fn derivative(&self, orders: [u8; 2], [x, y]: [f64; 2]) -> f64 {
        let [in_x, in_y] = &self.knots;
        let (i, j) = (in_x.before(x), in_y.before(y));
        let t = [x - in_x.pairs[i].hi(), y - in_y.pairs[j].hi()];
        in_cell(&self.rounded[self.cell([i, j])], orders, t)
    }

    fn derivative_in_pairs(&self, orders: [u8; 2], at: [[f64; 2]; 2]) -> [f64; 2] {
        let [x, y] = at.map(|[hi, lo]| DoubleDouble::new(hi, lo));
        let [in_x, in_y] = &self.knots;
        let (i, j) = (in_x.before_pair(x), in_y.before_pair(y));
        let t = [x - in_x.pairs[i], y - in_y.pairs[j]];
        words(in_cell(&self.cells[self.cell([i, j])], orders, t))
    }

    fn to_bytes(&self) -> Option<Vec<u8>> {
        let [x, y] = self.knots.each_ref().map(|knots| &knots.pairs[..]);
        let flag = self.is_extrapolated;
        Some(bytes::write(([self.end; 2], flag), &[x, y], &self.values))
    }

    fn domain(&self, axis: usize) -> Option<[f64; 2]> {
        let knots = &self.knots[axis];
        (!self.is_extrapolated).then(|| [knots.first(), knots.last()])
    }

    fn kinks(&self) -> Vec<Arc<dyn Outside>> {
        self.kinks.iter().flatten().cloned().collect()
    }
}
