//! Incremental iterations run in a series inside one kernel. After each iteration the kernel asks here
//! whether to continue. An iteration may be incremental if, by the contraction observed, it is not the last.

use crate::convergence::contraction::{Contraction, Progress};
use crate::policy::MOST_ITERATIONS;

/// A series of incremental iterations, or one iteration of another form.
pub(crate) struct Series<'a> {
    contraction: &'a mut Contraction,
    /// The state of the iteration after the last observed change; `None` before the first.
    pub(crate) progress: Option<Progress>,
    pub(crate) made: u32,
}

impl<'a> Series<'a> {
    pub(crate) fn new(contraction: &'a mut Contraction) -> Self {
        Series {
            contraction,
            progress: None,
            made: 1,
        }
    }

    /// Whether further iterations are expected after the next one.
    #[inline(always)]
    pub(crate) fn is_next(&self) -> bool {
        self.contraction.next_change() > self.contraction.last_change()
    }

    /// Called after an incremental iteration that has changed Z by `change`. Returns whether there is another
    /// one.
    #[inline(always)]
    pub(crate) fn again(&mut self, change: f64) -> bool {
        let progress = self.contraction.observe(change, false);
        self.progress = Some(progress);
        let is_early = self.made < MOST_ITERATIONS;
        let again = progress == Progress::Contracts && is_early && self.is_next();
        self.made += u32::from(again);
        again
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a cycle the changes shrink as often as they grow, so no change counts as divergence.
    #[test]
    fn changes_that_go_round_in_a_cycle_end() {
        let mut contraction = Contraction::new(true, f64::EPSILON);
        contraction.begin(false);
        let mut series = Series::new(&mut contraction);
        let cycle = [1e-3, 1e-4].into_iter().cycle().take(1000);
        let made = cycle.take_while(|&change| series.again(change)).count();
        assert_eq!(
            (made as u32 + 1, series.made),
            (MOST_ITERATIONS, MOST_ITERATIONS)
        );
        assert_eq!(series.progress, Some(Progress::Contracts));
    }
}
