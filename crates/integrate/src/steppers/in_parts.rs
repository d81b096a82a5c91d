//! Fixed steps at switches of H ([`crate::events::crossings`]). A step of the grid that crosses a switch is
//! split into parts, up to the switch and from the switch on, each of full order. The grid does not change.
//!
//! Knots of tables are ignored: without a tolerance there is no criterion for those that matter. The rest of
//! a step after [`SOON`] switches is computed as if H were smooth.
//!
//! Cost: the switches at all stages of a step; for each crossing two to four steps without α to find it, and
//! one more step.

use crate::control::policy::{MOST_TRIES, SHORT, SOON};
use crate::control::stuck::shortest_at;
use crate::error::IntegrateError;
use crate::events::crossings::{Crossings, Meeting};
use crate::steppers::integration::{InParts, Integration};
use equip_autodiff::Switches;
use equip_scalar::Float;
use equip_solver::{Outcome, Part, State};
use equip_tableau::Coefficients;

/// The switches along the steps of a grid, and the parts of the last step.
#[derive(Debug)]
pub(super) struct Substeps<T: Float> {
    crossings: Crossings<T>,
    /// The state at the start of the step.
    start: State<T>,
    /// The data of the parts for dense output; empty if dense output is not needed.
    parts: Vec<Part<T>>,
    /// The number of crossings in the step.
    crossed: u64,
    /// Whether the step has more than one part.
    is_split: bool,
}

impl<T: Float> Substeps<T> {
    /// For steps of this method and states with n components. `None` if H has no such switches.
    pub(super) fn boxed(
        switches: &Switches,
        method: &Coefficients<T>,
        n: usize,
    ) -> Option<Box<dyn InParts<T>>> {
        // With tolerance zero crossings are located to rounding.
        let crossings = Crossings::but_knots(switches, method, n, T::int(0))?;
        Some(Box::new(Substeps {
            crossings,
            start: State::new(&vec![T::int(0); n], &[]),
            parts: Vec::new(),
            crossed: 0,
            is_split: false,
        }))
    }
}

impl<T: Float> InParts<T> for Substeps<T> {
    fn attempt(&mut self, run: &mut Integration<T>, h: T) -> Result<Outcome, IntegrateError<T>> {
        let time = run.time;
        self.start.copy_from(&run.y);
        self.parts.clear();
        (self.crossed, self.is_split) = (0, false);
        let measured = &run.measured;
        let before = (measured.discontinuities_crossed, measured.energy_jumps);
        let made = run.over_switches(self, h).and_then(|outcome| {
            run.check_domains((time + h) - run.time)?;
            Ok(outcome)
        });
        if made.is_err() && self.is_split {
            run.y.copy_from(&self.start);
            let measured = &mut run.measured;
            (measured.discontinuities_crossed, measured.energy_jumps) = before;
            run.core.refuse();
        }
        run.time = time;
        made
    }

    fn parts(&self) -> Option<&[Part<T>]> {
        self.is_split.then_some(&self.parts[..])
    }
}

impl<T: Float> Integration<T> {
    /// Checks that the last step, of size `h`, stays in the domain of H.
    pub(crate) fn check_domains(&mut self, h: T) -> Result<(), IntegrateError<T>> {
        let Some(domains) = &mut self.domains else {
            return Ok(());
        };
        domains.check_step(&mut self.core, (&self.y, &self.next), (self.time, h))
    }

    /// Time and (q, p) before a step after which [`has_left`](Self::has_left) decides about the domain of H.
    pub(crate) fn before_leaving(&self) -> Option<(T, Vec<T>)> {
        let domains = self.domains.as_ref()?;
        let view = self.view();
        (domains.may_end_before).then(|| (view.time, [view.q, view.p].concat()))
    }

    /// The error if the last step has left the domain of H, unless an event at this time and (q, p) comes
    /// before.
    pub(crate) fn has_left(&mut self, event: Option<(T, &[T])>) -> Option<IntegrateError<T>> {
        let event = event.map(|(time, state)| (time, self.as_in_h(state, time)));
        let direction = self.direction;
        let domains = self.domains.as_mut()?;
        domains.has_left(event.as_ref().map(|(time, y)| (*time, &y[..])), direction)
    }

    fn over_switches(
        &mut self,
        substeps: &mut Substeps<T>,
        h: T,
    ) -> Result<Outcome, IntegrateError<T>> {
        let (time, mut left) = (self.time, h);
        let mut worst: Option<Outcome> = None;
        substeps.crossings.begin();
        loop {
            let (mut size, mut made, is_one) = self.attempt_in_one(left)?;
            let may_meet = is_one && substeps.crossed < SOON.unsigned_abs();
            let meeting = may_meet.then(|| self.first_meeting(substeps)).flatten();
            let mut ends_on_one = meeting == Some(Meeting::End);
            if let Some(Meeting::At(root, _)) = meeting
                && root < T::int(1)
            {
                if let Some(part) = self.up_to_switch(substeps, (size, root))? {
                    (size, made, ends_on_one) = part;
                    // A part that turns back before the switch counts as well, so that the number of parts is
                    // bounded.
                    substeps.crossed += u64::from(!ends_on_one);
                } else {
                    self.core.refuse();
                    made = self.attempt(size)?;
                }
            }
            if ends_on_one {
                self.cross_in_step(substeps);
            }
            let outcome = worst.map_or(made, |worst| worst.max(made));
            let is_last = size == left;
            if substeps.is_split || !is_last {
                substeps.parts.extend_from_slice(self.core.parts());
            }
            if is_last {
                return Ok(outcome);
            }
            worst = Some(outcome);
            std::mem::swap(&mut self.y, &mut self.next);
            left -= size;
            self.time = time + (h - left);
            substeps.is_split = true;
            substeps.crossings.accept((ends_on_one, ends_on_one));
        }
    }

    /// Attempts a step of size `left`, or of half the size, and so on, if the stages do not converge because
    /// the force jumps within the step. Returns its size, its outcome, and whether it was not halved by the
    /// solver.
    fn attempt_in_one(&mut self, left: T) -> Result<(T, Outcome, bool), IntegrateError<T>> {
        let mut size = left;
        for _ in 0..SHORT.ilog2() {
            let (halvings, outcome) = (self.core.counts().halvings, self.attempt(size)?);
            if self.core.counts().halvings == halvings {
                return Ok((size, outcome, true));
            }
            self.core.refuse();
            size /= T::int(2);
        }
        Ok((left, self.attempt(left)?, false))
    }

    /// Records that the step, or a part of it, ends on a switch.
    fn cross_in_step(&mut self, substeps: &mut Substeps<T>) {
        let (met, jump) = (
            substeps.crossings.met(),
            substeps.crossings.jump(&mut self.core),
        );
        self.measured.cross(met, jump);
        substeps.crossed += met;
    }

    /// Where the last step meets the first switch.
    fn first_meeting(&mut self, substeps: &mut Substeps<T>) -> Option<Meeting<T>> {
        let Integration { core, y, next, .. } = self;
        substeps.crossings.begin_step();
        substeps.crossings.look(core, y, next)
    }

    /// Attempts the part of a step of size `left` up to the switch that the step meets at `root`. If the
    /// motion turns back before the switch, the part ends there. Returns its size, its outcome, and whether
    /// it ends on a switch; `None` if there is no such part.
    fn up_to_switch(
        &mut self,
        substeps: &mut Substeps<T>,
        (left, root): (T, T),
    ) -> Result<Option<(T, Outcome, bool)>, IntegrateError<T>> {
        let constraints = self.core.replace_constraints(Vec::new());
        let size = self.size_to_switch(substeps, (left, root));
        self.core.replace_constraints(constraints);
        let Some((size, is_on_one)) = size? else {
            return Ok(None);
        };
        self.core.refuse();
        Ok(Some((size, self.attempt(size)?, is_on_one)))
    }

    /// The size of that part, from steps with α = 0, and whether it ends on a switch.
    fn size_to_switch(
        &mut self,
        substeps: &mut Substeps<T>,
        (left, root): (T, T),
    ) -> Result<Option<(T, bool)>, IntegrateError<T>> {
        let mut size = left * root;
        for _ in 0..MOST_TRIES {
            if size.abs() <= shortest_at(self.time) || size.abs() >= left.abs() {
                return Ok(None);
            }
            self.core.refuse();
            self.attempt(size)?;
            let Integration { core, y, next, .. } = self;
            match substeps.crossings.look(core, y, next) {
                Some(Meeting::End) => return Ok(Some((size, true))),
                Some(Meeting::At(root, _)) => size *= root,
                // The motion turns back before, for example at an obstacle that the longer step has not seen.
                None => return Ok(Some((size, false))),
                Some(Meeting::Touch(_) | Meeting::Missed) => return Ok(None),
            }
        }
        Ok(None)
    }
}
