//! [`Knots`]: ascending numbers, and the interval that contains a given number.
//!
//! The range is divided into cells of equal width, as many as there are intervals. Each cell stores the first
//! interval that overlaps it. One product gives the cell of a number, and only the intervals in this cell are
//! searched: one or two for uniform knots, log₂ of their number if they are crowded.

use super::error::TableError;
use equip_scalar::DoubleDouble;

#[derive(Debug)]
pub(super) struct Knots {
    /// At least two.
    pub(super) pairs: Vec<DoubleDouble>,
    heads: Vec<f64>,
    /// The first knot.
    origin: f64,
    cells: i32,
    /// Cells in a unit of x.
    density: f64,
    /// The first interval of each cell, and the last one of all.
    first: Vec<u32>,
}

impl Knots {
    pub(super) fn new<X: Into<DoubleDouble> + Copy>(x: &[X]) -> Result<Self, TableError> {
        let pairs: Vec<DoubleDouble> = x.iter().map(|&x| x.into()).collect();
        let heads: Vec<f64> = pairs.iter().map(|x| x.hi()).collect();
        if let Some(index) = heads.iter().position(|x| !x.is_finite()) {
            return Err(TableError::NotFinite {
                what: "knot",
                index,
            });
        }
        if let Some(before) = heads.windows(2).position(|x| x[0] >= x[1]) {
            let index = before + 1;
            return Err(TableError::NotAscending { index });
        }
        let &[first, .., last] = &heads[..] else {
            return Err(TableError::TooFewKnots {
                found: heads.len(),
                needed: 2,
            });
        };
        let cells = heads.len() - 1;
        let mut knots = Knots {
            origin: first,
            cells: i32::try_from(cells).unwrap_or(i32::MAX),
            density: cells as f64 / (last - first),
            first: Vec::with_capacity(cells + 1),
            pairs,
            heads,
        };
        let mut interval = 0;
        for cell in 0..cells {
            while interval + 1 < cells && knots.cell(knots.heads[interval + 1]) < cell {
                interval += 1;
            }
            knots.first.push(interval as u32);
        }
        knots.first.push(cells as u32 - 1);
        Ok(knots)
    }

    pub(super) fn len(&self) -> usize {
        self.heads.len()
    }

    pub(super) fn first(&self) -> f64 {
        self.heads[0]
    }

    pub(super) fn last(&self) -> f64 {
        self.heads[self.heads.len() - 1]
    }

    /// Never decreases with x; numbers outside of the range are in the cells at its ends.
    #[inline(always)]
    fn cell(&self, x: f64) -> usize {
        let cell = ((x - self.origin) * self.density) as i32;
        cell.clamp(0, self.cells - 1) as usize
    }

    /// Index of the knot before x; at a knot this one, outside of the range that of the interval next to it.
    #[inline(always)]
    pub(super) fn before(&self, x: f64) -> usize {
        let cell = self.cell(x);
        let (low, high) = (self.first[cell] as usize, self.first[cell + 1] as usize);
        // Of uniform knots there is at most one to compare with; which is not to be predicted.
        if high - low <= 1 {
            low + usize::from((low < high) & (self.heads[low + 1] <= x))
        } else {
            low + self.heads[low + 1..=high].partition_point(|&knot| knot <= x)
        }
    }

    /// The same for a number of which the knots' upper words do not say enough.
    pub(super) fn before_pair(&self, x: DoubleDouble) -> usize {
        let mut at = self.before(x.hi());
        while at > 0 && x < self.pairs[at] {
            at -= 1;
        }
        while at + 2 < self.pairs.len() && x >= self.pairs[at + 1] {
            at += 1;
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::Knots;

    fn check(x: &[f64]) {
        let knots = Knots::new(x).unwrap();
        let least = |y: f64| {
            let after = x.iter().filter(|&&knot| knot <= y).count();
            after.clamp(1, x.len() - 1) - 1
        };
        let tried = |y: f64| assert_eq!(knots.before(y), least(y), "{y} in {x:?}");
        for w in x.windows(2) {
            tried(0.5 * (w[0] + w[1]));
        }
        for &y in x {
            [y.next_down(), y, y.next_up()].into_iter().for_each(tried);
        }
        [x[0] - 1.0, 1e300, -1e300].into_iter().for_each(tried);
        assert_eq!(knots.before(f64::NAN), 0);
    }

    #[test]
    fn the_interval_of_every_number() {
        check(&[1.0, 2.0]);
        check(&[-0.1, 0.0, 0.1, 0.3, 1e6, 1e6 + 1.0]);
        for n in [3_u32, 10, 64, 1000] {
            let uniform: Vec<f64> = (0..=n).map(|i| -4.0 + 0.1 * f64::from(i)).collect();
            let crowded: Vec<f64> = (0..=n).map(|i| f64::from(i).powi(5)).collect();
            let both: Vec<f64> = (0..=n).map(|i| (f64::from(i) - 5.0).cbrt()).collect();
            check(&uniform);
            check(&crowded);
            check(&both);
        }
        check(&[0.0, 5e-324, 1e-323]);
        check(&[-1.7e308, 0.0, 1.7e308]);
    }
}
