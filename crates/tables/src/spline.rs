//! The cubic spline through points: y″ is continuous.
//!
//! With M_i = y″(x_i) and h_i = x_{i+1} − x_i, y′ is continuous at x_i if
//!
//! h_{i−1} M_{i−1} + 2(h_{i−1} + h_i) M_i + h_i M_{i+1} = 6((y_{i+1} − y_i)/h_i − (y_i − y_{i−1})/h_{i−1})
//!
//! [de Boor 1978, chapter IV; Stoer, Bulirsch, section 2.4]. The system is diagonally dominant and is solved
//! without pivoting. All arithmetic is in double-double; tables in `f64` round the result.

use super::error::TableError;
use equip_scalar::DoubleDouble;

/// What holds at an end.
#[derive(Debug, Clone, Copy)]
pub(super) enum End {
    /// y′ is given.
    Slope(DoubleDouble),
    /// y″ is given.
    Curvature(DoubleDouble),
    /// y‴ is continuous at the second knot from here.
    NotAKnot,
}

impl End {
    /// Knots that a spline with this end needs.
    pub(super) fn needs(self) -> usize {
        match self {
            End::NotAKnot => 4,
            _ => 2,
        }
    }

    fn number(self) -> DoubleDouble {
        match self {
            End::Slope(x) | End::Curvature(x) => x,
            End::NotAKnot => DoubleDouble::ZERO,
        }
    }
}

/// Refuses ends that are not numbers, and what has too few knots for them.
pub(super) fn check_ends(knots: usize, ends: [End; 2]) -> Result<(), TableError> {
    let needed = ends[0].needs().max(ends[1].needs());
    if knots < needed {
        let found = knots;
        return Err(TableError::TooFewKnots { found, needed });
    }
    match ends.iter().position(|end| !end.number().is_finite()) {
        Some(index) => Err(TableError::NotFinite {
            what: "condition at end",
            index,
        }),
        None => Ok(()),
    }
}

/// The coefficients c_k of Σ c_k (x − x_i)ᵏ for each interval from x_i on.
pub(super) fn spline(
    x: &[DoubleDouble],
    y: &[DoubleDouble],
    ends: [End; 2],
) -> Vec<[DoubleDouble; 4]> {
    let widths: Vec<DoubleDouble> = x.windows(2).map(|x| x[1] - x[0]).collect();
    let rises: Vec<DoubleDouble> = (y.windows(2).zip(&widths))
        .map(|(y, &h)| (y[1] - y[0]) / h)
        .collect();
    let bends = second_derivatives(&widths, &rises, ends);
    let three = DoubleDouble::from(3.0);
    let pieces = widths.iter().zip(&rises).zip(bends.windows(2)).zip(y);
    let coefficients = pieces.map(|(((&h, &rise), bend), &y)| {
        let third = (bend[1] - bend[0]) / (three * h);
        let slope = rise - h * (bend[0] + bend[0] + bend[1]) / (three + three);
        [y, slope, half(bend[0]), half(third)]
    });
    coefficients.collect()
}

fn half(x: DoubleDouble) -> DoubleDouble {
    x * DoubleDouble::from(0.5)
}

/// One equation: `before` M_{i−1} + `own` M_i + `after` M_{i+1} = `right`.
#[derive(Clone, Copy)]
struct Row {
    before: DoubleDouble,
    own: DoubleDouble,
    after: DoubleDouble,
    right: DoubleDouble,
}

/// The M_i.
fn second_derivatives(
    widths: &[DoubleDouble],
    rises: &[DoubleDouble],
    ends: [End; 2],
) -> Vec<DoubleDouble> {
    let six = DoubleDouble::from(6.0);
    let inner = widths.windows(2).zip(rises.windows(2)).map(|(h, rise)| {
        let both = h[0] + h[1];
        Row {
            before: h[0],
            own: both + both,
            after: h[1],
            right: six * (rise[1] - rise[0]),
        }
    });
    let last = widths.len();
    let mut rows = vec![end_row(ends[0], widths[0], rises[0])];
    rows.extend(inner);
    let end = end_row(ends[1], widths[last - 1], rises[last - 1]);
    let is_derivative = matches!(ends[1], End::Slope(_));
    rows.push(Row {
        before: end.after,
        after: DoubleDouble::ZERO,
        right: if is_derivative { -end.right } else { end.right },
        ..end
    });
    // M_0 = (1 + r) M_1 − r M_2 with r = h_0/h_1, put into the next row; at the other end likewise.
    let ratios = [
        (widths[0], widths[1.min(last - 1)]),
        (widths[last - 1], widths[last.saturating_sub(2)]),
    ];
    let [first, second] = ratios.map(|(outer, inner)| outer / inner);
    if let End::NotAKnot = ends[0] {
        let row = &mut rows[1];
        row.own += row.before * (DoubleDouble::ONE + first);
        row.after -= row.before * first;
        row.before = DoubleDouble::ZERO;
    }
    if let End::NotAKnot = ends[1] {
        let row = &mut rows[last - 1];
        row.own += row.after * (DoubleDouble::ONE + second);
        row.before -= row.after * second;
        row.after = DoubleDouble::ZERO;
    }
    let mut bends = solve(rows);
    if let End::NotAKnot = ends[0] {
        bends[0] = bends[1] + first * (bends[1] - bends[2]);
    }
    if let End::NotAKnot = ends[1] {
        bends[last] = bends[last - 1] + second * (bends[last - 1] - bends[last - 2]);
    }
    bends
}

/// The row of the first knot. Without a condition of its own it says M = 0, which is overwritten.
fn end_row(end: End, width: DoubleDouble, rise: DoubleDouble) -> Row {
    let zero = DoubleDouble::ZERO;
    match end {
        End::Slope(slope) => Row {
            before: zero,
            own: width + width,
            after: width,
            right: DoubleDouble::from(6.0) * (rise - slope),
        },
        End::Curvature(_) | End::NotAKnot => Row {
            before: zero,
            own: DoubleDouble::ONE,
            after: zero,
            right: end.number(),
        },
    }
}

/// Gaussian elimination without pivoting; the rows are diagonally dominant.
fn solve(mut rows: Vec<Row>) -> Vec<DoubleDouble> {
    for i in 1..rows.len() {
        let Row {
            own, after, right, ..
        } = rows[i - 1];
        let factor = rows[i].before / own;
        rows[i].own -= factor * after;
        rows[i].right -= factor * right;
    }
    let mut solution = vec![DoubleDouble::ZERO; rows.len()];
    let mut next = DoubleDouble::ZERO;
    for (place, row) in solution.iter_mut().zip(&rows).rev() {
        next = (row.right - row.after * next) / row.own;
        *place = next;
    }
    solution
}
