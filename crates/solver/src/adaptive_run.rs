//! A whole run with variable steps over an interval.

use crate::adaptive::Adaptive;
use crate::dense_watch::DenseWatch;
use crate::error::IntegrateError;
use crate::observer::{NoObserver, Observer};
use crate::run::{Run, RunFailure};
use equip_autodiff::System;
use equip_scalar::Float;
use std::ops::{ControlFlow, RangeInclusive};

impl<T: Float> Adaptive<T> {
    /// Integrates from (`q0`, `p0`), each of length m, over `interval`.
    ///
    /// The last step meets the end of the interval; where a step of the proposed size would leave a sliver, the two last ones are equal.
    ///
    /// # Errors
    /// [`RunFailure`], which carries the part that was made.
    pub fn integrate<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        self.integrate_observed(system, q0, p0, interval, &mut NoObserver)
    }

    /// The same, with an observer that sees every step and may end the run.
    ///
    /// # Errors
    /// [`RunFailure`], which carries the part that was made.
    pub fn integrate_observed<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let (t0, t1) = interval.into_inner();
        if !(t1 >= t0) || !t0.is_finite() || !t1.is_finite() {
            return Err(IntegrateError::Interval { start: t0, end: t1 }.into());
        }
        self.base.check_output_times(t0, t1)?;
        let mut stepper = self.start(system, q0, p0, t0)?;
        let times = &self.base.output_times;
        let mut dense = DenseWatch::new(system, &self.base, times, &mut stepper.inner)?;
        let mut run = Run::new(q0.len(), &stepper.inner);
        while stepper.time() < t1 {
            let time_low = stepper.time_low;
            if let Err(error) = stepper.advance_within(Some(t1)) {
                return Err(run.fail(error, &stepper.inner));
            }
            if let Some(dense) = &mut dense
                && let Err(error) = dense.see(&stepper.inner, time_low, &mut run)
            {
                return Err(run.fail(error, &stepper.inner));
            }
            let view = stepper.view();
            let stop = observer.step(&view) == ControlFlow::Break(());
            if stop || view.time == t1 || self.base.record.keeps(view.index) {
                run.keep(&view);
            }
            if stop {
                run.stop();
                break;
            }
        }
        if let Some(dense) = dense {
            dense.finish(&stepper.inner, &mut run);
        }
        run.finish(&stepper.inner);
        Ok(run)
    }
}
