//! The second half of system (7): g = I(y1) − I_ref = 0, and the round-off level of g.
//!
//! I is the energy, or a further invariant that is to be conserved. I_ref is its value at the start of the
//! *run*: an error that one step leaves is removed by a later one, and does not walk at random.
//!
//! *Round-off level* (docs/adr/0013). With v_k the nodes of the trace of I
//!
//! $$ \varepsilon \Big( \sum_k |v_k\,\partial I/\partial v_k| + \sum_i |y_i\,\partial_i I|
//! \Big) + \nu \sum_i |\partial_i I|\, \sigma_i , $$
//!
//! ν being the rounding of stages that have converged, relative to the sizes σ of the components. The level
//! varies by a factor of 30 within one oscillation of a stiff mode, and a close encounter leaves an error as
//! large as its own level. So g is compared with the largest recent level. That level fades by [`FADING`] a
//! step once g is below the level of the step itself.

use crate::options::invariant::Invariant;
use crate::policy::FADING;
use equip_autodiff::Evaluator;
use equip_iterate::State;
use equip_scalar::Float;

/// One equation g = 0 with what is needed to judge and to reduce g.
#[derive(Debug)]
pub struct Constraint<T: Float> {
    /// `None` for the energy, which has the run's evaluator.
    evaluator: Option<Evaluator<T>>,
    pub(crate) reference: T,
    /// g at the end of the step, and at its start.
    pub(crate) residual: T,
    pub(crate) start_error: T,
    /// The round-off level at the end of the step, and the largest recent one.
    pub(crate) round_off: T,
    pub(crate) late: T,
    /// The largest recent one before the step.
    late_before: T,
    /// ∇I at the end of the step, and at its start.
    pub(crate) gradient: Vec<T>,
    pub(crate) start_gradient: Vec<T>,
}

impl<T: Float> Constraint<T> {
    /// The energy, of states with `n` components; its reference is given when the run begins.
    pub fn energy(n: usize) -> Self {
        let zero = T::int(0);
        Constraint {
            evaluator: None,
            reference: zero,
            residual: zero,
            start_error: zero,
            round_off: zero,
            late: zero,
            late_before: zero,
            gradient: vec![zero; n],
            start_gradient: vec![zero; n],
        }
    }

    /// A further invariant, of states with `n` components.
    pub fn invariant(invariant: &Invariant, n: usize) -> Self {
        Constraint {
            evaluator: Some(invariant.function().evaluator::<T>()),
            ..Self::energy(n)
        }
    }

    /// Whether I is the energy.
    pub(crate) fn is_energy(&self) -> bool {
        self.evaluator.is_none()
    }

    /// A run begins at `y`, where the energy is `h_ref`: nothing of earlier steps is left.
    pub(crate) fn begin(&mut self, h_ref: T, y: &[T]) {
        let zero = T::int(0);
        self.reference = match &mut self.evaluator {
            None => h_ref,
            Some(evaluator) => evaluator.gradient_with_compensated_value(y, &mut self.gradient),
        };
        self.gradient.fill(zero);
        self.start_gradient.fill(zero);
        (self.residual, self.start_error, self.round_off, self.late) = (zero, zero, zero, zero);
    }

    /// Evaluates I, ∇I and the round-off level at `y1`; ν is the rounding of the stages relative to `sizes`.
    /// Returns whether they are finite.
    pub(crate) fn evaluate(
        &mut self,
        energy: &mut Evaluator<T>,
        y1: &State<T>,
        (nu, sizes): (T, &[T]),
    ) -> bool {
        let (value, bound) = match &mut self.evaluator {
            None => energy.gradient_with_bound(&y1.hi, &mut self.gradient),
            Some(evaluator) => evaluator.gradient_with_bound(&y1.hi, &mut self.gradient),
        };
        self.residual = value - self.reference;
        // Below the smallest normal number rounding is absolute.
        self.round_off = T::EPSILON * (bound + T::MIN_POSITIVE) + nu * worth(&self.gradient, sizes);
        value.is_finite() && self.round_off.is_finite()
    }

    /// Evaluates ∇I and g at the start of a step.
    pub(crate) fn evaluate_start(&mut self, energy: &mut Evaluator<T>, y0: &State<T>) {
        let value = match &mut self.evaluator {
            None => energy.gradient_with_compensated_value(&y0.hi, &mut self.start_gradient),
            Some(evaluator) => {
                evaluator.gradient_with_compensated_value(&y0.hi, &mut self.start_gradient)
            }
        };
        self.start_error = value - self.reference;
    }

    /// A step begins.
    pub(crate) fn begin_step(&mut self) {
        self.late_before = self.late;
    }

    /// The step has failed, perhaps after a part of it was accepted.
    pub(crate) fn fail(&mut self) {
        self.late = self.late_before;
    }

    /// The step was accepted: its end is the start of the next.
    pub(crate) fn accept(&mut self) {
        // What was round-off where it arose is round-off until it is gone.
        let fades = self.residual.abs() <= self.round_off;
        let late = if fades {
            self.late * T::ratio(FADING - 1, FADING)
        } else {
            self.late
        };
        self.late = late.max(self.round_off);
        self.start_error = self.residual;
        self.start_gradient.copy_from_slice(&self.gradient);
    }

    /// Whether g is round-off.
    pub(crate) fn is_at_round_off(&self) -> bool {
        self.residual.abs() <= self.round_off.max(self.late)
    }

    /// The noise of y1, relative to these sizes of the components, that would change I by as much as g.
    pub(crate) fn noise_equivalent(&self, sizes: &[T]) -> T {
        self.residual.abs() / worth(&self.gradient, sizes)
    }

    /// A change `of` I over Σ_i |∂_iI| σ_i, the mean of both ends: no displacement that is smaller, in units
    /// of σ, makes or removes it.
    pub(crate) fn least_displacement(&self, of: T, sizes: &[T]) -> T {
        let both = worth(&self.gradient, sizes) + worth(&self.start_gradient, sizes);
        let least = T::int(2) * of.abs() / both;
        if least.is_finite() { least } else { T::int(0) }
    }
}

/// Σ_i |∂_iI| σ_i, in eight sums side by side.
fn worth<T: Float>(gradient: &[T], sizes: &[T]) -> T {
    let (gradients, rest) = gradient.as_chunks::<8>();
    let mut sums = [T::int(0); 8];
    for (gradients, sizes) in gradients.iter().zip(sizes.as_chunks::<8>().0) {
        for (sum, (&g, &size)) in sums.iter_mut().zip(gradients.iter().zip(sizes)) {
            *sum += (g * size).abs();
        }
    }
    let sizes = &sizes[gradient.len() - rest.len()..];
    let terms = rest.iter().zip(sizes).map(|(&g, &size)| (g * size).abs());
    sums.into_iter()
        .chain(terms)
        .fold(T::int(0), |sum, x| sum + x)
}
