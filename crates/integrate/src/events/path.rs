//! [`Path`]: the switches of H along a step, from their values at its start, its stages and its end.
//!
//! A sign change between neighbours of these s + 2 positions encloses a root. So does a dip towards zero
//! whose minimum, by parabolas through three positions, has the opposite sign. Two roots between neighbours
//! are searched where lines through the values on either side intersect beyond zero: an obstacle max(1 −
//! |x|/w, 0) much thinner than the step does not show in the signs of the s + 2 values. Two roots of which the
//! values give no indication are not found.

use crate::control::policy::{MOST_TRIES, PART};
use crate::dense::polynomial::Polynomial;
use crate::events::narrow::{Hidden, MOST_PAIRS, vertex};
use crate::events::roots::{Interval, enclose};
use equip_autodiff::{SwitchEvaluator, SwitchKind, Switches};
use equip_scalar::Float;
use equip_solver::{Core, State};

/// A root of a switch, or a position so close to zero that the polynomial cannot decide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place<T> {
    /// A root, and a second one close behind, if there is one.
    Root(T, Option<T>),
    Touch(T),
}

impl<T: Float> Place<T> {
    /// The position in units of the step.
    pub(crate) fn place(self) -> T {
        match self {
            Place::Root(place, _) | Place::Touch(place) => place,
        }
    }
}

/// The switches along a step.
#[derive(Debug)]
pub(crate) struct Path<T: Float> {
    switches: SwitchEvaluator<T>,
    /// For every switch, whether it belongs to knots.
    pub(super) is_of_knots: Vec<bool>,
    /// Roots that the values at the positions do not show.
    pub(super) hidden: Vec<Hidden<T>>,
    /// Neighbouring roots without a position between them.
    pub(crate) pairs: Vec<[T; 2]>,
    pub(super) roots: Vec<T>,
    /// 0, c_1, …, c_s, 1.
    pub(super) places: Vec<T>,
    /// g of all switches at each position.
    values: Vec<T>,
    polynomial: Polynomial<T>,
    stages: Vec<T>,
    y: Vec<T>,
    g: Vec<T>,
    /// The relative error of the polynomial between its stages.
    vague: T,
}

impl<T: Float> Path<T> {
    /// For steps with these nodes, states with n components, and a tolerance.
    pub(crate) fn new(switches: &Switches, nodes: &[T], n: usize, tolerance: T) -> Self {
        let zeros = |count: usize| vec![T::int(0); count];
        let ends = [[T::int(0)], [T::int(1)]];
        Path {
            switches: switches.evaluator(),
            is_of_knots: (switches.kinds().iter())
                .map(|&kind| kind == SwitchKind::Knots)
                .collect(),
            hidden: Vec::with_capacity(MOST_PAIRS),
            pairs: Vec::with_capacity(2 * MOST_PAIRS),
            roots: Vec::with_capacity(2 * MOST_PAIRS),
            places: [&ends[0][..], nodes, &ends[1][..]].concat(),
            values: zeros((nodes.len() + 2) * switches.len()),
            polynomial: Polynomial {
                start: State::new(&zeros(n), &[]),
                coefficients: zeros(nodes.len() * n),
            },
            stages: zeros(nodes.len() * n),
            y: zeros(n),
            g: zeros(switches.len()),
            vague: tolerance.sqrt(),
        }
    }

    /// The number of switches.
    pub(crate) fn len(&self) -> usize {
        self.g.len()
    }

    /// The number of stages.
    pub(crate) fn stages(&self) -> usize {
        self.places.len() - 2
    }

    /// h γ_k of component c of the polynomial.
    pub(crate) fn coefficient(&self, k: usize, c: usize) -> T {
        self.polynomial.coefficients[k * self.y.len() + c]
    }

    /// Evaluates the switches along the step from `y` to `end`.
    pub(crate) fn follow(&mut self, core: &mut Core<T>, y: &State<T>, end: &State<T>) {
        core.stages_by_stage(y, &mut self.stages);
        let (n, count) = (y.hi.len(), self.g.len());
        let stages = self.stages.chunks_exact(n);
        let points = std::iter::once(&y.hi[..])
            .chain(stages)
            .chain(std::iter::once(&end.hi[..]));
        for (point, g) in points.zip(self.values.chunks_exact_mut(count)) {
            self.switches.values(point, g);
        }
        self.hidden.clear();
        self.pairs.clear();
    }

    /// Stores the polynomial of the last step, which started at `y`.
    pub(crate) fn take_polynomial(&mut self, core: &Core<T>, y: &State<T>) {
        let Polynomial {
            start,
            coefficients,
        } = &mut self.polynomial;
        start.hi.copy_from_slice(&y.hi);
        start.lo.copy_from_slice(&y.lo);
        core.legendre_coefficients(coefficients);
    }

    /// The state at `place`, by the polynomial.
    pub(crate) fn state_at(&mut self, place: T) -> &[T] {
        let integrals = self.polynomial.integrals(place);
        for (j, y) in self.y.iter_mut().enumerate() {
            *y = self.polynomial.component(j, &integrals);
        }
        &self.y
    }

    /// Switch j at `place`, by the polynomial.
    pub(crate) fn value_at(&mut self, j: usize, place: T) -> T {
        self.state_at(place);
        self.switches.values(&self.y, &mut self.g);
        self.g[j]
    }

    /// Switch j at position i.
    pub(super) fn value(&self, j: usize, i: usize) -> T {
        self.values[i * self.g.len() + j]
    }

    /// The sign of switch j at the start of the step.
    pub(crate) fn side_at_start(&self, j: usize) -> i8 {
        side(self.value(j, 0))
    }

    /// The sign of switch j at the first stage.
    pub(crate) fn side_at_first_stage(&self, j: usize) -> i8 {
        side(self.value(j, 1))
    }

    /// The sign of switch j at the end of the step.
    pub(crate) fn side_at_end(&self, j: usize) -> i8 {
        side(self.value(j, self.places.len() - 1))
    }

    /// Whether switch j may have a root in the step if it has the sign `begins` after the start.
    pub(crate) fn may_meet(&self, j: usize, begins: i8) -> bool {
        let last = self.places.len() - 1;
        let differs = |i: usize| side(self.value(j, i)) != begins;
        (1..=last).any(differs)
            || (1..last).any(|i| self.dips(j, i))
            || self.hidden.iter().any(|hidden| hidden.j == j)
    }

    /// Whether the parabola through position i and its neighbours has its vertex between them, with the
    /// opposite sign or less than half their distance from zero. Also true if the values differ so much that
    /// a parabola cannot decide.
    fn dips(&self, j: usize, i: usize) -> bool {
        let [a, b, c] = [i - 1, i, i + 1].map(|i| (self.places[i], self.value(j, i)));
        let [x, y, z] = [a, b, c].map(|point| point.1.abs());
        let (least, most) = (x.min(y).min(z), x.max(y).max(z));
        vertex([a, b, c]).is_some_and(|(_, lowest)| {
            side(lowest) != side(b.1)
                || T::int(2) * lowest.abs() < least
                || T::int(PART) * least < most
        })
    }

    /// The first root of switch j after the start of the step, or the first position where it may have one.
    /// At the start the switch has the sign `begins`, or, if that is zero, the sign at the first stage.
    pub(crate) fn first_root(
        &mut self,
        j: usize,
        begins: i8,
        starts_on_it: bool,
    ) -> Option<Place<T>> {
        let last = self.places.len() - 1;
        let mut before = begins;
        for i in 1..=last {
            let here = side(self.value(j, i));
            if before == 0 {
                before = here;
                continue;
            }
            if here != before {
                let from = if starts_on_it && i == 1 {
                    self.leaving(j, before)
                } else {
                    Some(self.places[i - 1])
                };
                if let Some(from) = from {
                    let root = self.enclosed(j, from, self.places[i]);
                    return Some(Place::Root(root, None));
                }
                before = here;
            } else if let Some(hidden) = self.hidden_between(j, i) {
                return Some(Place::Root(hidden.first, Some(hidden.second)));
            } else if i < last && self.dips(j, i) && !(starts_on_it && i == 1) {
                let root = self.within_dip(j, i, before);
                if root.is_some() {
                    return root;
                }
            }
        }
        None
    }

    fn hidden_between(&self, j: usize, i: usize) -> Option<Hidden<T>> {
        let is_there = |hidden: &&Hidden<T>| hidden.j == j && hidden.i == i;
        self.hidden.iter().find(is_there).copied()
    }

    /// A position before the first stage where switch j, on which the step begins, has the sign `wanted`.
    pub(super) fn leaving(&mut self, j: usize, wanted: i8) -> Option<T> {
        let mut place = self.places[1];
        (0..MOST_TRIES).find_map(|_| {
            place /= T::int(2);
            (side(self.value_at(j, place)) == wanted).then_some(place)
        })
    }

    pub(super) fn enclosed(&mut self, j: usize, a: T, b: T) -> T {
        let [at_a, at_b] = [a, b].map(|place| self.value_at(j, place));
        if at_b == T::int(0) || side(at_a) == side(at_b) {
            return b;
        }
        let ends = Interval { a, b, at_a, at_b };
        let resolution = T::EPSILON / T::int(4) * b;
        enclose(&mut |place| self.value_at(j, place), ends, resolution)
    }

    /// A root of switch j near position i, where it dips towards zero. Elsewhere it has the sign `wanted`.
    fn within_dip(&mut self, j: usize, i: usize, wanted: i8) -> Option<Place<T>> {
        let [mut a, mut b, mut c] = [i - 1, i, i + 1].map(|i| (self.places[i], self.value(j, i)));
        let sizes = (0..self.places.len()).map(|i| self.value(j, i).abs());
        let vague = self.vague * sizes.fold(T::int(0), |most, size| most.max(size));
        for _ in 0..MOST_TRIES {
            let Some((x, _)) = vertex([a, b, c]) else {
                break;
            };
            let here = (x, self.value_at(j, x));
            let (lower, upper) = if x < b.0 { (a, b) } else { (b, c) };
            if side(here.1) != wanted {
                let first = self.enclosed(j, lower.0, x);
                let second = self.enclosed(j, x, upper.0);
                return Some(Place::Root(first, Some(second)));
            }
            (a, b, c) = match (here.1.abs() < b.1.abs(), x < b.0) {
                (true, _) => (lower, here, upper),
                (false, true) => (here, b, c),
                (false, false) => (a, b, here),
            };
        }
        (b.1.abs() < vague).then_some(Place::Touch(b.0))
    }

    /// The root of switch j slightly beyond the end of the step, or before the end by rounding. Computed by
    /// the secant method as long as it converges.
    pub(crate) fn root_beyond(&mut self, j: usize) -> Option<T> {
        let mut before = T::int(1) - T::ratio(1, 64);
        let mut here = T::int(1);
        let mut at_before = self.value_at(j, before);
        let mut least = T::ratio(1, 4);
        let mut root = None;
        for _ in 0..MOST_TRIES {
            let at_here = self.value_at(j, here);
            let next = here - at_here * ((here - before) / (at_here - at_before));
            let moved = (next - here).abs();
            // Also ends for NaN, which occurs if values differ by rounding alone.
            if !(moved < least) {
                break;
            }
            (least, root) = (moved, Some(next));
            (before, at_before, here) = (here, at_here, next);
        }
        root
    }

    /// The sign of switch j after `place`.
    pub(crate) fn side_after(&mut self, j: usize, place: T) -> i8 {
        let before = self.value_at(j, place - T::ratio(1, 64));
        side(self.value_at(j, place) - before)
    }
}

/// −1, 0 or 1; 0 for NaN.
pub(super) fn side<T: Float>(g: T) -> i8 {
    i8::from(g > T::int(0)) - i8::from(g < T::int(0))
}
