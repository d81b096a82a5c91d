//! Roots of switches that the signs of the switches at the positions of a [`Path`] do not show.
//!
//! A switch with kinks of its own, such as the one of the maximum in max(1 − |x|/w, 0), has its extrema at
//! the roots of other switches. It is evaluated there. [`crate::events::narrow`] treats smooth switches.
//!
//! Cost: for a step with a sign change and a switch with kinks, the root, about ten evaluations of the
//! switches, and one more. If lines intersect beyond zero, up to 25.

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
        let bends = (0..self.len()).any(|j| self.bends[j] && !is_passed[j]);
        (1..self.places.len()).any(|i| {
            let changes = self.changes_between(i, is_passed, starts_on);
            let narrows = |j: usize| self.narrows(j, i, starts_on[j].is_some());
            changes > 1
                || (changes > 0 && (bends || self.is_at_end(i)))
                || (0..self.len()).any(|j| !is_passed[j] && narrows(j))
        })
    }

    /// Looks for such roots, and for an end of the step and a root without a stage between them.
    pub(crate) fn look_for_hidden(&mut self, is_passed: &[bool], starts_on: &[Option<i8>]) {
        let bends = (0..self.len()).any(|j| self.bends[j] && !is_passed[j]);
        for i in 1..self.places.len() {
            let [a, b] = [self.places[i - 1], self.places[i]];
            let looks =
                bends || self.is_at_end(i) || self.changes_between(i, is_passed, starts_on) > 1;
            self.roots.clear();
            for j in (0..self.len()).filter(|&j| !is_passed[j]) {
                if self.is_full() {
                    return;
                }
                let begins = starts_on[j].filter(|_| i == 1);
                if looks && self.changes_at(j, i, begins) {
                    // A step that begins on a switch leaves it first.
                    let from = begins.map_or(Some(a), |begins| self.leaving(j, begins));
                    if let Some(from) = from {
                        let root = self.enclosed(j, from, b);
                        self.look_at(root, i, is_passed);
                    }
                } else if self.narrows(j, i, starts_on[j].is_some()) {
                    self.look_into(j, i, is_passed);
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

    fn changes_between(&self, i: usize, is_passed: &[bool], starts_on: &[Option<i8>]) -> usize {
        let begins = |j: usize| starts_on[j].filter(|_| i == 1);
        let changes = |&j: &usize| !is_passed[j] && self.changes_at(j, i, begins(j));
        (0..self.len()).filter(changes).count()
    }

    fn is_full(&self) -> bool {
        self.hidden.len() >= MOST_PAIRS || self.roots.len() + 2 >= 2 * MOST_PAIRS
    }

    /// Given a root between the positions i − 1 and i, checks whether switches with kinks have the opposite
    /// sign at the root.
    fn look_at(&mut self, root: T, i: usize, is_passed: &[bool]) {
        self.roots.push(root);
        for k in (0..self.len()).filter(|&k| !is_passed[k]) {
            if !self.bends[k] || self.is_full() {
                continue;
            }
            let [before, here] = [i - 1, i].map(|i| side(self.value(k, i)));
            if before != 0 && before == here && side(self.value_at(k, root)) == -here {
                self.hide(k, i, root, is_passed);
            }
        }
    }

    /// Looks for two roots of switch j between the positions i − 1 and i.
    fn look_into(&mut self, j: usize, i: usize, is_passed: &[bool]) {
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
            self.hide(j, i, place, is_passed);
        }
    }

    /// Records that switch k has another sign at `place` than at the positions i − 1 and i around it.
    fn hide(&mut self, k: usize, i: usize, place: T, is_passed: &[bool]) {
        let [a, b] = [self.places[i - 1], self.places[i]];
        let is_known = |hidden: &Hidden<T>| hidden.j == k && hidden.i == i;
        if !(place > a && place < b) || self.hidden.iter().any(is_known) {
            return;
        }
        let (first, second) = (self.enclosed(k, a, place), self.enclosed(k, place, b));
        self.hidden.push(Hidden {
            j: k,
            i,
            first,
            second,
        });
        self.look_at(first, i, is_passed);
        self.look_at(second, i, is_passed);
    }
}
