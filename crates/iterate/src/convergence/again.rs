//! Which iterations are incremental: those that by the contraction seen leave others to come. Series of them
//! run inside one kernel, which asks here whether to go on.

use crate::convergence::contraction::{Contraction, Progress};
use crate::policy::MOST_ITERATIONS;

/// Whether iterations of a series go on.
pub(crate) trait Again {
    /// After an iteration that has changed Z by `change`. Implementations are inlined into the kernels.
    fn again(&mut self, change: f64) -> bool;
}

/// One iteration.
pub(crate) struct Once;

impl Again for Once {
    #[inline(always)]
    fn again(&mut self, _change: f64) -> bool {
        false
    }
}

impl<A: Again> Again for &mut A {
    #[inline(always)]
    fn again(&mut self, change: f64) -> bool {
        (**self).again(change)
    }
}

/// A series of incremental iterations.
pub(crate) struct Series<'a> {
    contraction: &'a mut Contraction,
    /// What the last iteration of the series says; nothing if it was not observed yet.
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

    /// Whether the next iteration leaves others to come.
    #[inline(always)]
    pub(crate) fn is_next(&self) -> bool {
        self.contraction.next_change() > self.contraction.last_change()
    }
}

impl Again for Series<'_> {
    #[inline(always)]
    fn again(&mut self, change: f64) -> bool {
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

    /// A cycle shrinks as often as it grows, so that no change of it diverges.
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
