//! Roots of switches that the signs of the switches at the positions of a [`Path`] do not show, by
//! [`crate::events::narrow`], and neighbouring roots without a position between them.
//!
//! Cost: for such a pair its roots, about ten evaluations of the switches each.

use crate::events::narrow::{self, Hidden, MOST_PAIRS};
use crate::events::path::{Path, side};
use equip_scalar::Float;
use std::cmp::Ordering;

impl<T: Float> Path<T> {
    /// Whether switch j may have two roots between the positions i − 1 and i, where it has the same sign.
    fn narrows(&self, j: usize, i: usize, starts_on_it: bool) -> bool {
        let [a, b] = [i - 1, i].map(|i| self.value(j, i));
        let [sign, other] = [a, b].map(side);
        if sign == 0 || sign != other || self.is_of_knots[j] || (starts_on_it && i == 1) {
            return false;
        }
        let point = |i: usize| {
            let value = self.value(j, i);
            (side(value) == sign).then_some((self.places[i], value.abs()))
        };
        let outer = |i: Option<usize>| i.filter(|&i| i < self.places.len()).and_then(point);
        let inner = [(self.places[i - 1], a.abs()), (self.places[i], b.abs())];
        let met = narrow::meeting(outer(i.checked_sub(2)), inner, outer(Some(i + 1)));
        met.is_some_and(|(_, lowest)| lowest <= T::int(0))
    }

    /// Whether there may be roots that the signs do not show, or neighbouring roots without a position
    /// between them. Ignored switches are left out, and switches on which the step starts (`starts_on`) are
    /// left out near its start.
    pub(crate) fn may_hide(&self, is_passed: &[bool], starts_on: &[Option<i8>]) -> bool {
        (1..self.places.len()).any(|i| {
            let narrows = |j: usize| self.narrows(j, i, starts_on[j].is_some());
            self.has_pairs(i, is_passed, starts_on)
                || (0..self.len()).any(|j| !is_passed[j] && narrows(j))
        })
    }

    /// Looks for such roots, and for an end of the step and a root without a stage between them.
    pub(crate) fn look_for_hidden(&mut self, is_passed: &[bool], starts_on: &[Option<i8>]) {
        for i in 1..self.places.len() {
            let [a, b] = [self.places[i - 1], self.places[i]];
            let has_pairs = self.has_pairs(i, is_passed, starts_on);
            self.roots.clear();
            for j in (0..self.len()).filter(|&j| !is_passed[j]) {
                if self.is_full() {
                    return;
                }
                let begins = starts_on[j].filter(|_| i == 1);
                if has_pairs && self.changes_at(j, i, begins) {
                    // A step that begins on a switch leaves it first.
                    let from = begins.map_or(Some(a), |begins| self.leaving(j, begins));
                    if let Some(from) = from {
                        let root = self.enclosed(j, from, b);
                        self.roots.push(root);
                    }
                } else if self.narrows(j, i, starts_on[j].is_some()) {
                    self.look_into(j, i);
                }
            }
            // There is no stage at the ends of the step either.
            if !self.roots.is_empty() && self.is_at_end(i) {
                self.roots.push(if i == 1 { a } else { b });
            }
            let by_place = |a: &T, b: &T| a.partial_cmp(b).unwrap_or(Ordering::Equal);
            self.roots.sort_unstable_by(by_place);
            for two in self.roots.windows(2) {
                if self.pairs.len() < 2 * MOST_PAIRS && two[0] < two[1] {
                    self.pairs.push([two[0], two[1]]);
                }
            }
        }
    }

    /// Whether position i is the first stage or the end of the step.
    fn is_at_end(&self, i: usize) -> bool {
        i == 1 || i + 1 == self.places.len()
    }

    /// Whether switch j, unless it belongs to knots, changes sign between the positions i − 1 and i. At i − 1
    /// it has the sign `begins` if it is given.
    fn changes_at(&self, j: usize, i: usize, begins: Option<i8>) -> bool {
        let [before, here] = [i - 1, i].map(|i| side(self.value(j, i)));
        begins.unwrap_or(before) * here < 0 && !self.is_of_knots[j]
    }

    /// Whether there are roots between the positions i − 1 and i, or a root and an end of the step, without a
    /// stage between them.
    fn has_pairs(&self, i: usize, is_passed: &[bool], starts_on: &[Option<i8>]) -> bool {
        let begins = |j: usize| starts_on[j].filter(|_| i == 1);
        let changes = |&j: &usize| !is_passed[j] && self.changes_at(j, i, begins(j));
        let count = (0..self.len()).filter(changes).count();
        count > 1 || (count > 0 && self.is_at_end(i))
    }

    fn is_full(&self) -> bool {
        self.hidden.len() >= MOST_PAIRS || self.roots.len() + 2 >= 2 * MOST_PAIRS
    }

    /// Looks for two roots of switch j between the positions i − 1 and i.
    fn look_into(&mut self, j: usize, i: usize) {
        let sign = T::int(i64::from(side(self.value(j, i))));
        let mut points = [(T::int(0), T::int(0)); 4];
        let mut count = 0;
        for at in i.saturating_sub(2)..=(i + 1).min(self.places.len() - 1) {
            let value = sign * self.value(j, at);
            if value > T::int(0) {
                points[count] = (self.places[at], value);
                count += 1;
            }
        }
        let g = |place: T| sign * self.value_at(j, place);
        if let Some(place) = narrow::place_beyond(&points[..count], g) {
            self.hide(j, i, place);
        }
    }

    /// Records that switch j has another sign at `place` than at the positions i − 1 and i around it.
    fn hide(&mut self, j: usize, i: usize, place: T) {
        let [a, b] = [self.places[i - 1], self.places[i]];
        if !(place > a && place < b) {
            return;
        }
        let (first, second) = (self.enclosed(j, a, place), self.enclosed(j, place, b));
        self.hidden.push(Hidden {
            j,
            i,
            first,
            second,
        });
        self.roots.extend([first, second]);
    }
}
