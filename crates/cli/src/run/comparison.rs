//! The Gauss method on the steps of a run, to be drawn beside it.

use crate::draw::samples::Envelope;
use crate::run::progress::Progress;
use crate::run::signals;
use equip_integrate::{Gauss, Record, StepView};
use equip_scalar::Float;
use equip_scenes::Instance;
use std::ops::ControlFlow;

/// The energy defect of the Gauss method.
#[derive(Debug)]
pub(crate) struct Comparison {
    pub(crate) energy: Envelope,
    /// Whether it reached the end.
    pub(crate) complete: bool,
}

impl Comparison {
    /// Integrates `instance` with steps `h` until `end`, or as far as it gets.
    pub(crate) fn new<T: Float>(
        stages: usize,
        h: T,
        instance: &Instance,
        end: T,
        mut progress: Progress,
    ) -> Self {
        let mut energy = Envelope::default();
        let (q0, p0) = instance.initial::<T>();
        let mut see = |view: &StepView<'_, T>| {
            progress.see(view.index);
            if let Some(defect) = view.energy_defect {
                energy.see(view.time.to_f64(), defect.to_f64());
            }
            match signals::caught() {
                None => ControlFlow::Continue(()),
                Some(_) => ControlFlow::Break(()),
            }
        };
        let made = Gauss::stages(stages)
            .step(h)
            .record(Record::Ends)
            .integrate_observed(instance.hamiltonian(), &q0, &p0, T::int(0)..=end, &mut see);
        Comparison {
            energy,
            complete: made.is_ok_and(|run| !run.stopped()),
        }
    }
}
