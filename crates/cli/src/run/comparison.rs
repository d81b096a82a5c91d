//! The Gauss method with the steps or the tolerance of a run, drawn for comparison.

use crate::draw::samples::Envelope;
use crate::run::integrator::integrate;
use crate::run::progress::Progress;
use crate::run::signals;
use equip_integrate::{Integrator, StepView};
use equip_scalar::Float;
use equip_scenes::Instance;
use std::ops::ControlFlow;

/// The energy error of the Gauss method.
#[derive(Debug)]
pub(crate) struct Comparison {
    pub(crate) energy: Envelope,
    /// Whether it reached the end.
    pub(crate) complete: bool,
    /// What it has in common with the run, in words.
    pub(crate) label: &'static str,
}

impl Comparison {
    /// Integrates `instance` by Gauss until `end`, or as far as it gets.
    pub(crate) fn new<T: Float>(
        (gauss, has_tolerance): (&Integrator<T>, bool),
        instance: &Instance,
        end: T,
        mut progress: Progress,
    ) -> Self {
        let mut energy = Envelope::default();
        let mut see = |view: &StepView<'_, T>| {
            progress.see(view.index);
            if let Some(energy_error) = view.energy_error {
                energy.see(view.time.to_f64(), energy_error.to_f64());
            }
            match signals::caught() {
                None => ControlFlow::Continue(()),
                Some(_) => ControlFlow::Break(()),
            }
        };
        let made = integrate(gauss, instance, None, end, &mut see);
        Comparison {
            energy,
            complete: made.is_ok_and(|run| !run.stopped()),
            label: match has_tolerance {
                false => "Gauss, same steps",
                true => "Gauss, same tolerance",
            },
        }
    }
}
