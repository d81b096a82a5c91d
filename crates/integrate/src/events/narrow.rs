//! Two roots of a function between neighbouring positions at which it has the same sign.
//!
//! If |g| decreases up to one position and increases from the next one on, the lines through two positions on
//! either side intersect between them. If |g| is convex, such as the distance to an obstacle that is passed
//! closely, the intersection is below the minimum: if it is above zero, there is no root. The minimum is
//! searched at such intersections.

use crate::control::policy::MOST_TRIES;
use equip_scalar::Float;

/// The maximum number of pairs of roots examined in one step, hidden or not.
pub(crate) const MOST_PAIRS: usize = 16;

/// Two roots of switch j between the positions i − 1 and i, where it has the same sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hidden<T> {
    pub(crate) j: usize,
    pub(crate) i: usize,
    pub(crate) first: T,
    pub(crate) second: T,
}

/// A position and the value there.
pub(crate) type Point<T> = (T, T);

/// The intersection of the lines through (`before`, `a`) and (`b`, `after`), if |g| decreases along the
/// first, increases along the second, and the intersection is between `a` and `b`. Without one of the outer
/// points its line has the opposite derivative of the other line. Values are |g|.
pub(crate) fn meeting<T: Float>(
    before: Option<Point<T>>,
    [a, b]: [Point<T>; 2],
    after: Option<Point<T>>,
) -> Option<Point<T>> {
    let zero = T::int(0);
    let falls = before.is_none_or(|before| before.1 > a.1);
    let rises = after.is_none_or(|after| after.1 > b.1);
    if !(falls && rises) {
        return None;
    }
    let gradient = |from: Point<T>, to: Point<T>| (to.1 - from.1) / (to.0 - from.0);
    let left = before.map(|before| gradient(before, a));
    let right = after.map(|after| gradient(b, after));
    let left = left.or(right.map(|right| -right))?;
    let right = right.unwrap_or(-left);
    let x = a.0 + ((b.1 - a.1) - right * (b.0 - a.0)) / (left - right);
    let is_between = x > a.0 && x < b.0 && left < zero && right > zero;
    is_between.then(|| (x, a.1 + left * (x - a.0)))
}

/// The vertex of the parabola through three points, if it is between them, and its value.
pub(crate) fn vertex<T: Float>([a, b, c]: [Point<T>; 3]) -> Option<Point<T>> {
    let [first, second] = [(a, b), (b, c)].map(|(a, b)| (b.1 - a.1) / (b.0 - a.0));
    let bend = (second - first) / (c.0 - a.0);
    let x = (a.0 + b.0 - first / bend) / T::int(2);
    let value = a.1 + (x - a.0) * (first + bend * (x - b.0));
    (x > a.0 && x < c.0 && x != b.0).then_some((x, value))
}

/// The points around a minimum of |g|, in order.
struct Around<T> {
    points: [Point<T>; 5 + MOST_TRIES as usize],
    count: usize,
}

impl<T: Float> Around<T> {
    fn get(&self, i: usize) -> Option<Point<T>> {
        self.points[..self.count].get(i).copied()
    }

    /// The index of the lowest point that has two neighbours.
    fn lowest(&self) -> usize {
        let inner = 1..self.count.saturating_sub(1);
        let is_below = |i: usize, j: usize| self.points[i].1 < self.points[j].1;
        inner.fold(1, |low, i| if is_below(i, low) { i } else { low })
    }

    /// The lower one of the intersections between the lowest point and its neighbours.
    fn meeting(&self) -> Option<Point<T>> {
        let low = self.lowest();
        let between = |i: usize| {
            let ends = [self.get(i)?, self.get(i + 1)?];
            meeting(
                i.checked_sub(1).and_then(|i| self.get(i)),
                ends,
                self.get(i + 2),
            )
        };
        let both = [between(low.saturating_sub(1)), between(low)];
        let found = both.into_iter().flatten();
        found.reduce(|a, b| if b.1 < a.1 { b } else { a })
    }

    fn add(&mut self, point: Point<T>) {
        let after = self.points[..self.count].partition_point(|p| p.0 < point.0);
        self.points.copy_within(after..self.count, after + 1);
        self.points[after] = point;
        self.count += 1;
    }
}

/// A position at which g has changed sign, between the positions of `places`: up to five in order, with |g|.
/// `g` is the function times its sign at these. `None` if none is found.
pub(crate) fn place_beyond<T: Float>(places: &[Point<T>], mut g: impl FnMut(T) -> T) -> Option<T> {
    let mut around = Around {
        points: [(T::int(0), T::int(0)); 5 + MOST_TRIES as usize],
        count: places.len().min(5),
    };
    around.points[..around.count].copy_from_slice(&places[..around.count]);
    for _ in 0..MOST_TRIES {
        let (x, lowest) = around.meeting()?;
        let is_new = around.points[..around.count].iter().all(|p| p.0 != x);
        if lowest > T::int(0) || !is_new {
            return None;
        }
        let value = g(x);
        if value < T::int(0) {
            return Some(x);
        }
        around.add((x, value));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::place_beyond;

    fn finds(f: impl Fn(f64) -> f64, at: &[f64]) -> Option<f64> {
        let points: Vec<_> = at.iter().map(|&x| (x, f(x))).collect();
        assert!(points.iter().all(|p| p.1 > 0.0));
        place_beyond(&points, &f)
    }

    #[test]
    fn thin_dips_are_found_and_near_misses_are_not() {
        let at = [-7.0, -3.9, -1.2, 1.5, 4.4];
        for width in [1.0, 0.1, 1e-3, 1e-6] {
            for b in [0.0, 0.1, 0.9] {
                let lens = |x: f64| ((x - 0.3).hypot(b * width) - width) / width;
                let x = finds(lens, &at);
                assert!(x.is_some_and(|x| lens(x) < 0.0), "{width} {b}: {x:?}");
            }
            let miss = |x: f64| ((x - 0.3).hypot(1.01 * width) - width) / width;
            assert_eq!(finds(miss, &at), None, "{width}");
        }
        let well = |x: f64| (x - 0.3).powi(2) - 1e-4;
        assert!(finds(well, &at).is_some_and(|x| well(x) < 0.0));
        assert!(finds(|x| (x - 0.3).powi(2) + 0.1, &at).is_none());
    }
}
