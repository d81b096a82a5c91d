//! Whether a step stays where H has data: within the tables that do not extrapolate.
//!
//! Cost: the arguments of these tables at the stages and the end of each step that is accepted.

use crate::error::IntegrateError;
use equip_autodiff::{DomainEvaluator, OutsideDomain, Switches};
use equip_scalar::Float;
use equip_solver::{Core, State};

/// The domains of H along the steps of a run.
#[derive(Debug)]
pub(crate) struct WithinDomains<T: Float> {
    evaluator: DomainEvaluator<T>,
    stages: Vec<T>,
    /// Halvings before the step: of a step that was halved the stages are those of its last part.
    halvings: u64,
}

impl<T: Float> WithinDomains<T> {
    /// Of steps with so many stages of states with n components. None of an H that has values everywhere.
    pub(crate) fn new(switches: &Switches, stages: usize, n: usize) -> Option<Self> {
        let domains = switches.domains();
        (!domains.is_empty()).then(|| WithinDomains {
            evaluator: domains.evaluator(),
            stages: vec![T::int(0); stages * n],
            halvings: 0,
        })
    }

    /// Whether the state `y` at `time` is within all of them.
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

    /// Whether the step of size `h` just made from `y` to `next` stays within all of them, by its stages, if
    /// it was made in one, and its end.
    ///
    /// # Errors
    /// That of the first state that does not; the next step is not guessed from this one then.
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
        if checked.is_err() {
            core.refuse();
        }
        checked
    }
}
