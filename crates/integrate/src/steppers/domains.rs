//! Whether a step stays in the domain of H, within the tables that do not extrapolate.
//!
//! Cost: the arguments of these tables at the stages and the end of each accepted step.

use crate::error::IntegrateError;
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
}

impl<T: Float> WithinDomains<T> {
    /// For steps with this number of stages and states with n components. `None` if H is defined everywhere.
    pub(crate) fn new(switches: &Switches, stages: usize, n: usize) -> Option<Self> {
        let domains = switches.domains();
        (!domains.is_empty()).then(|| WithinDomains {
            evaluator: domains.evaluator(),
            stages: vec![T::int(0); stages * n],
            halvings: 0,
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

    /// Checks that the step of size `h` from `y` to `next` stays within all domains: at its end, and at its
    /// stages unless it was halved.
    ///
    /// # Errors
    /// The error of the first state outside. The next step then has no initial guess from this step.
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
