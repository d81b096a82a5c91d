//! Whether a step stays in the domain of H, within the tables that do not extrapolate.
//!
//! Cost: the arguments of these tables at the stages and the end of each accepted step.

use crate::error::IntegrateError;
use crate::time::direction::TimeDirection;
use equip_autodiff::{DomainEvaluator, OutsideDomain, Switches};
use equip_scalar::Float;
use equip_solver::{Core, State};

/// The domains of H along the steps of a run.
#[derive(Debug)]
pub(crate) struct WithinDomains<T: Float> {
    evaluator: DomainEvaluator<T>,
    stages: Vec<T>,
    /// The number of halvings before the step. The stages of a halved step are those of its last part.
    halvings: u64,
    /// Whether an event may end the run, or change its state, before it leaves the domain.
    pub(crate) may_end_before: bool,
    /// The error of the last step, if an event may have ended the run before.
    pub(crate) outside: Option<IntegrateError<T>>,
}

impl<T: Float> WithinDomains<T> {
    /// For steps with this number of stages and states with n components. `None` if H is defined everywhere.
    pub(crate) fn new(switches: &Switches, stages: usize, n: usize) -> Option<Self> {
        let domains = switches.domains();
        (!domains.is_empty()).then(|| WithinDomains {
            evaluator: domains.evaluator(),
            stages: vec![T::int(0); stages * n],
            halvings: 0,
            may_end_before: false,
            outside: None,
        })
    }

    /// Checks that the state `y` at `time` is within all domains.
    ///
    /// # Errors
    /// [`IntegrateError::OutsideOfTable`] if it is not.
    pub(crate) fn check(&mut self, time: T, y: &[T]) -> Result<(), IntegrateError<T>> {
        let outside = self.evaluator.check(y);
        outside.map_err(|outside| {
            let OutsideDomain {
                argument,
                first,
                last,
            } = outside;
            IntegrateError::OutsideOfTable {
                time,
                argument,
                first,
                last,
            }
        })
    }

    /// The error if the last step has left the domain. `event` is the time and the state of the event that
    /// ends the run or changes its state: there is no error if it is in the domain, and before the first
    /// state outside.
    pub(crate) fn has_left(
        &mut self,
        event: Option<(T, &[T])>,
        direction: TimeDirection,
    ) -> Option<IntegrateError<T>> {
        let error = self.outside.take()?;
        let IntegrateError::OutsideOfTable { time: left, .. } = error else {
            return Some(error);
        };
        match event {
            Some((time, y)) if !direction.is_before(left, time) => self.check(time, y).err(),
            _ => Some(error),
        }
    }

    /// Checks that the step of size `h` from `y` to `next` stays within all domains: at its end, and at its
    /// stages unless it was halved.
    ///
    /// # Errors
    /// The error of the first state outside. The next step then has no initial guess from this step. If an
    /// event may end the run before, the error is stored and not returned.
    pub(crate) fn check_step(
        &mut self,
        core: &mut Core<T>,
        (y, next): (&State<T>, &State<T>),
        (time, h): (T, T),
    ) -> Result<(), IntegrateError<T>> {
        let halvings = core.counts().halvings;
        let is_one = std::mem::replace(&mut self.halvings, halvings) == halvings;
        let mut checked = Ok(());
        if is_one {
            let mut stages = std::mem::take(&mut self.stages);
            core.stages_by_stage(y, &mut stages);
            let mut at = stages.chunks_exact(y.hi.len()).zip(core.method().nodes());
            checked = at.try_for_each(|(y, &c)| self.check(time + c * h, y));
            self.stages = stages;
        }
        let checked = checked.and_then(|()| self.check(time + h, &next.hi));
        if self.may_end_before {
            self.outside = checked.err();
            return Ok(());
        }
        if checked.is_err() {
            core.refuse();
        }
        checked
    }
}
