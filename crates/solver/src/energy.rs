//! The second half of system (7): g = H(y1) − H_ref = 0, and how small g can be made at all.

use crate::state::State;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// H at the start of the *run*: an energy error left by one step is repaired by the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target<T> {
    pub(crate) h_ref: T,
}

/// g and what is needed to judge and to reduce it, at the end point of a step.
#[derive(Debug)]
pub(crate) struct Residual<T> {
    /// g = H(y1) − H_ref.
    pub(crate) defect: T,
    /// Below this, g is round-off: ε (|H_ref| + |H(y1)| + Σ_i |∂_iH(y1) y1_i|), and once the stages have converged
    /// what their last, round-off sized correction would do to H.
    pub(crate) floor: T,
    /// ∇H(y1).
    pub(crate) gradient: Vec<T>,
    /// ∇H(y0), when a direction of the α's was taken.
    pub(crate) start_gradient: Vec<T>,
    /// g with α = 0, as predicted when the α's began to move.
    pub(crate) defect_without_alpha: T,
    energy_scale: T,
}

impl<T: Float> Residual<T> {
    pub(crate) fn new(n: usize) -> Self {
        let zero = T::int(0);
        Residual {
            defect: zero,
            floor: zero,
            gradient: vec![zero; n],
            start_gradient: vec![zero; n],
            defect_without_alpha: zero,
            energy_scale: zero,
        }
    }

    /// Evaluates H and ∇H at `y1`. Returns whether they are finite.
    pub(crate) fn evaluate<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        y1: &State<T>,
        target: Target<T>,
    ) -> bool {
        let value = energy.gradient(&y1.hi, &mut self.gradient);
        self.defect = value - target.h_ref;
        let moved = self
            .gradient
            .iter()
            .zip(&y1.hi)
            .fold(T::int(0), |sum, (g, y)| sum + (*g * *y).abs());
        self.energy_scale = target.h_ref.abs() + value.abs() + moved;
        self.floor = T::EPSILON * self.energy_scale;
        value.is_finite() && self.floor.is_finite()
    }

    /// Evaluates ∇H at the start of the step.
    pub(crate) fn evaluate_start<E: Evaluate<T>>(&mut self, energy: &mut E, y: &State<T>) {
        energy.gradient(&y.hi, &mut self.start_gradient);
    }

    /// Raises the floor by Σ_i |∂_iH(y1) δ_i|, δ being what the last correction of the stages, itself round-off, does
    /// to the end point. In stiff systems rounding the arguments Y_i is worth more than rounding y1.
    pub(crate) fn add_stage_noise(&mut self, delta: &[T]) {
        let noise = self
            .gradient
            .iter()
            .zip(delta)
            .fold(T::int(0), |sum, (g, d)| sum + (*g * *d).abs());
        self.floor += noise;
    }

    /// The energy that a relative change of the state by 1 is worth.
    pub(crate) fn energy_scale(&self) -> T {
        self.energy_scale
    }
}
