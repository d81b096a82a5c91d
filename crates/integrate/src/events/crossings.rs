//! [`Crossings`]: where a step crosses the switches of H, and on which switches it begins or ends.
//!
//! As long as no switch changes sign, H is smooth and a step has its full order. A step that crosses a switch
//! is repeated so that it ends on the switch. Its size is multiplied by the position of the root on its
//! polynomial, and again by the position on the polynomial of the shorter step, which has seen one side only,
//! until the size converges. Near the root the end point is a smooth function of the size on both sides of
//! the switch, since all stages are before the root.
//!
//! *Which side.* If a step begins on a switch, g is rounding there, and the step begins on the side to which
//! the motion leads. If H is continuous, H = H₁ on one side and H₁ + gK on the other, and ġ = {g, H} is the
//! same on both: {g, gK} = g{g, K} = 0 for g = 0. So a motion that meets a switch with ġ ≠ 0 crosses it, and
//! no motion slides along it. If ġ is rounding too, the side is that of the first stage.

use crate::checkpoints::memory::Memory;
use crate::control::estimate::Decay;
use crate::control::policy::{BESIDE, MOST_TRIES, ROUNDING, SOON};
use crate::events::path::{Path, Place, side as side_of};
use crate::events::roughness::Roughness;
use equip_autodiff::{SwitchKind, Switches};
use equip_scalar::Float;
use equip_solver::{Core, State};
use equip_tableau::Coefficients;

/// Where a step meets the first switch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Meeting<T> {
    /// At this position, in units of the step: within the step, or slightly beyond its end if the step was to
    /// end on the switch. The second number is a further root close behind.
    At(T, Option<T>),
    /// The end of the step is on a switch.
    End,
    /// The step comes so close to a switch here that only a step that ends here can decide.
    Touch(T),
    /// The step crossed a switch, and no attempt has ended on the switch.
    Missed,
}

/// The switches along the steps of a run.
#[derive(Debug)]
pub(crate) struct Crossings<T: Float> {
    pub(crate) path: Path<T>,
    /// For every switch: `None` if the step does not begin on the switch, else the sign with which it
    /// continues, zero if unknown.
    sides: Vec<Option<i8>>,
    /// The switches on which the step ends, and their signs after the step.
    met: Vec<(usize, i8)>,
    /// The switch on which the step is to end.
    aim: Option<usize>,
    /// The distance of the end of the last attempt from this switch.
    miss: T,
    looks: u32,
    halvings: u32,
    /// Whether the step was shortened to a position where it may touch a switch.
    pub(crate) has_touched: bool,
    /// Whether the step before met a switch that may have hidden others, such as knots of a table.
    pub(crate) is_among_knots: bool,
    has_knots: bool,
    /// The switches that are ignored.
    is_passed: Vec<bool>,
    /// The switches at which the value of H may jump.
    may_jump: Vec<bool>,
    /// Workspace for ∇H.
    gradient: Vec<T>,
    roughness: Roughness<T>,
    /// A root this close to the end of a step is at the end.
    close: T,
}

impl<T: Float> Crossings<T> {
    /// For steps of this method and states with n components. `None` if H has no switches.
    pub(crate) fn new(
        switches: &Switches,
        method: &Coefficients<T>,
        n: usize,
        tolerance: T,
    ) -> Option<Self> {
        let count = switches.len();
        if count == 0 {
            return None;
        }
        Some(Crossings {
            path: Path::new(switches, method.nodes(), n, tolerance),
            roughness: Roughness::new(method, n)?,
            sides: vec![None; count],
            met: Vec::with_capacity(count),
            aim: None,
            miss: T::int(0),
            looks: 0,
            halvings: 0,
            has_touched: false,
            is_among_knots: false,
            is_passed: vec![false; count],
            has_knots: switches.kinds().contains(&SwitchKind::Knots),
            may_jump: (switches.kinds().iter())
                .map(|kind| {
                    matches!(
                        kind,
                        SwitchKind::Sign | SwitchKind::Selection | SwitchKind::Step
                    )
                })
                .collect(),
            gradient: vec![T::int(0); n],
            close: (tolerance / T::int(1000)).max(T::int(8) * T::EPSILON),
        })
    }

    /// The same, ignoring knots of tables. `None` if there are no other switches.
    pub(crate) fn but_knots(
        switches: &Switches,
        method: &Coefficients<T>,
        n: usize,
        tolerance: T,
    ) -> Option<Self> {
        let mut crossings = Self::new(switches, method, n, tolerance)?;
        let kinds = switches.kinds().iter();
        crossings.is_passed = kinds.map(|&kind| kind == SwitchKind::Knots).collect();
        crossings.has_knots = false;
        crossings.is_passed.contains(&false).then_some(crossings)
    }

    /// Begins or continues a run at a state that may be anywhere.
    pub(crate) fn begin(&mut self) {
        self.sides.fill(None);
        self.is_among_knots = false;
        self.begin_step();
    }

    /// Reverses the direction of time.
    pub(crate) fn turn_back(&mut self) {
        for side in self.sides.iter_mut().flatten() {
            *side = -*side;
        }
    }

    pub(crate) fn begin_step(&mut self) {
        (self.looks, self.halvings, self.has_touched) = (0, 0, false);
        self.stop_aiming();
    }

    /// The next attempt is not to end on a switch.
    pub(crate) fn stop_aiming(&mut self) {
        self.aim = None;
    }

    /// Whether the last attempt was to end on a switch.
    pub(crate) fn is_aimed(&self) -> bool {
        self.aim.is_some()
    }

    /// The number of switches on which the last step examined ends.
    pub(crate) fn met(&self) -> u64 {
        self.met.len() as u64
    }

    /// Whether the step begins on a switch.
    pub(crate) fn begins_on_one(&self) -> bool {
        self.sides.iter().any(Option::is_some)
    }

    /// Accepts the last step examined. It met a switch if `meets_one`, and ended on the met switches if
    /// `ends_on_one`.
    pub(crate) fn accept(&mut self, (meets_one, ends_on_one): (bool, bool)) {
        self.is_among_knots = meets_one && self.has_knots;
        self.sides.fill(None);
        if ends_on_one {
            for &(j, side) in &self.met {
                self.sides[j] = Some(side);
            }
        }
    }

    /// Writes or reads the state of the switches for the next step.
    pub(crate) fn remember(&mut self, memory: &mut Memory<'_>) {
        for side in &mut self.sides {
            let sign = side.map(|sign| T::int(sign.into()));
            *side = memory.one("the sides of the switches", sign).map(side_of);
        }
        let is_among_knots = u64::from(self.is_among_knots);
        self.is_among_knots = memory.count::<T>("the knots", is_among_knots) != 0;
    }

    /// Whether the effect of discontinuities on the last step examined exceeds its tolerance. The step has
    /// the size `h`, its first two roots are `roots`, and `decay` holds its estimate with ϱ and the rounding
    /// of ∇H.
    pub(crate) fn is_rough(
        &mut self,
        core: &mut Core<T>,
        (h, roots): (T, [T; 2]),
        decay: (&Decay<T>, f64, &[T]),
    ) -> bool {
        let Crossings {
            roughness, path, ..
        } = self;
        // NaN counts as rough.
        !(roughness.of_step(core, path, (h, roots), decay) <= 1.0)
            || !(roughness.between_pairs(core, path, h, (decay.0, decay.2)) <= 1.0)
    }

    /// Whether a step is to be halved before it is shortened to end on a switch. This holds if H has tables,
    /// whose knots may be close together, and the step has not been halved often.
    pub(crate) fn may_halve(&mut self) -> bool {
        self.halvings += 1;
        self.has_knots && self.halvings <= SOON.ilog2()
    }

    /// Where the step from `y` to `end` meets the first switch. The next attempt is to end there.
    pub(crate) fn look(
        &mut self,
        core: &mut Core<T>,
        y: &State<T>,
        end: &State<T>,
    ) -> Option<Meeting<T>> {
        self.looks += 1;
        let aim = self.aim.take();
        self.path.follow(core, y, end);
        self.begin_on_roots();
        if self.path.may_hide(&self.is_passed, &self.sides) {
            self.path.take_polynomial(core, y);
            self.path.look_for_hidden(&self.is_passed, &self.sides);
        }
        let may_meet = |j: usize| !self.is_passed[j] && self.path.may_meet(j, self.begins(j));
        let meets_none = aim.is_none() && !(0..self.path.len()).any(may_meet);
        if meets_none && !self.is_among_knots {
            return None;
        }
        if self.looks > MOST_TRIES {
            return Some(Meeting::Missed);
        }
        self.path.take_polynomial(core, y);
        let (j, place) = self.first(aim)?;
        let Place::Root(root, next) = place else {
            self.has_touched = true;
            return Some(Meeting::Touch(place.place()));
        };
        let miss = (root - T::int(1)).abs();
        let rests = aim == Some(j) && T::int(4) * miss >= self.miss;
        if miss <= self.close || (rests && miss * miss <= T::EPSILON) {
            self.meet(j, root);
            return Some(Meeting::End);
        }
        (self.aim, self.miss) = (Some(j), miss);
        Some(Meeting::At(root, next))
    }

    /// The jump of H at the end of the last step examined, if it ends on a switch.
    pub(crate) fn jump(&mut self, core: &mut Core<T>) -> Option<T> {
        let may_jump = self.met.iter().any(|&(j, _)| self.may_jump[j]);
        may_jump.then(|| self.across(core, T::int(1))).flatten()
    }

    /// The jump of H at the first switch that the step meets.
    pub(crate) fn jump_at(&mut self, core: &mut Core<T>, root: T) -> Option<T> {
        let may_jump = self.aim.is_some_and(|j| self.may_jump[j]);
        may_jump.then(|| self.across(core, root)).flatten()
    }

    /// The jump of H at a root, if it exceeds rounding: the difference of H slightly behind and before the
    /// root, extrapolated to distance zero. If only a derivative of H jumps, the limit is zero, and the
    /// extrapolations of first and second degree differ by more than a quarter.
    fn across(&mut self, core: &mut Core<T>, root: T) -> Option<T> {
        let mut rounding = T::int(0);
        let mut across = |distance: T| {
            let [before, beyond] = [-distance, distance].map(|distance| {
                let y = self.path.state_at(root + distance);
                let (energy, counts) = core.energy_and_counts();
                counts.gradients += 1;
                let (value, bound) = energy.gradient_with_bound(y, &mut self.gradient);
                rounding = rounding.max(T::int(ROUNDING) * T::EPSILON * bound);
                value
            });
            beyond - before
        };
        let [first, second, third] = [1, 2, 3].map(|times| across(T::ratio(times, BESIDE)));
        let jump = T::int(2) * first - second;
        let is_limit = T::int(4) * (first - T::int(2) * second + third).abs() <= jump.abs();
        // The root is accurate to `close`.
        let shift = (second - first).abs() * T::int(BESIDE) * self.close;
        (is_limit && jump.abs() > rounding + shift).then_some(jump)
    }

    /// A step that starts at g = 0 exactly begins on the switch, and continues on the side of the first
    /// stage.
    fn begin_on_roots(&mut self) {
        for j in (0..self.path.len()).filter(|&j| !self.is_passed[j]) {
            let first = self.path.side_at_first_stage(j);
            if self.sides[j].is_none() && self.path.side_at_start(j) == 0 && first != 0 {
                self.sides[j] = Some(first);
            }
        }
    }

    /// The sign of switch j at the beginning of the step.
    fn begins(&self, j: usize) -> i8 {
        self.sides[j].unwrap_or_else(|| self.path.side_at_start(j))
    }

    /// The switch that is met first, and where.
    fn first(&mut self, aim: Option<usize>) -> Option<(usize, Place<T>)> {
        let mut first: Option<(usize, Place<T>)> = None;
        for j in 0..self.path.len() {
            if self.is_passed[j] {
                continue;
            }
            let mut place = self.first_root(j);
            if place.is_none() && aim == Some(j) {
                place = (self.path.root_beyond(j)).map(|root| Place::Root(root, None));
            }
            if let Some(place) = place
                && first.is_none_or(|(_, before)| place.place() < before.place())
            {
                first = Some((j, place));
            }
        }
        first
    }

    fn first_root(&mut self, j: usize) -> Option<Place<T>> {
        let starts_on_it = self.sides[j].is_some();
        let begins = self.begins(j);
        if !self.path.may_meet(j, begins) {
            return None;
        }
        let mut place = self.path.first_root(j, begins, starts_on_it)?;
        if place.place() <= self.close && !starts_on_it {
            // The step begins on the switch, up to rounding.
            self.sides[j] = Some(-begins);
            place = self.path.first_root(j, -begins, true)?;
        }
        // A touch counts once in a step.
        let is_root = matches!(place, Place::Root(..));
        (is_root || !self.has_touched).then_some(place)
    }

    /// The step ends on switch j at this root, and on all other switches with a root there.
    fn meet(&mut self, j: usize, root: T) {
        self.met.clear();
        for other in 0..self.path.len() {
            if self.is_passed[other] {
                continue;
            }
            let is_met = other == j
                || self.path.side_at_end(other) == 0
                || self
                    .first_root(other)
                    .is_some_and(|place| (place.place() - root).abs() <= self.close);
            if is_met {
                let side = self.path.side_after(other, root);
                self.met.push((other, side));
            }
        }
    }
}
