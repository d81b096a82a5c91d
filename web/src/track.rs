//! [`Track`]: what one method has made in a few steps.

use equip::integrate::StepView;

/// Steps of one method, in order; states are one after the other, m numbers each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// Positions.
    pub q: Vec<f64>,
    /// Momenta.
    pub p: Vec<f64>,
    /// |H − H0|, divided by |H0| unless that is 0.
    pub energy_errors: Vec<f64>,
}

impl Track {
    pub(crate) fn push(&mut self, step: &StepView<'_, f64>, scale: f64) {
        self.q.extend(step.q);
        self.p.extend(step.p);
        let error = step.energy_error.unwrap_or(f64::NAN).abs() / scale;
        self.energy_errors.push(error);
    }
}
