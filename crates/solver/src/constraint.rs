//! The second half of system (7): g = I(y1) − I_ref = 0, and the round-off level of g.
//!
//! I is the energy, or a further invariant to be conserved. I_ref is its value at the initial state of the
//! *run*: a later step removes the error of an earlier one, and the error of I is no random walk.
//!
//! *Round-off level* (docs/adr/0013). Let v_k be the nodes of the trace of I. The round-off level is
//!
//! $$ \varepsilon \Big( \sum_k |v_k\,\partial I/\partial v_k| + \sum_i |y_i\,\partial_i I|
//! \Big) + \nu \sum_i |\partial_i I|\, \sigma_i , $$
//!
//! where ν is the rounding of converged stages, relative to the sizes σ of the components. The level varies
//! by a factor of 30 within one oscillation of a stiff mode, and a close encounter leaves an error of the
//! order of its own level. Therefore g is compared with the largest recent level. The largest recent level
//! fades by 1/[`FADING`] a step once |g| is below the level of the current step.

use crate::options::invariant::Invariant;
use crate::policy::FADING;
use equip_autodiff::Evaluator;
use equip_iterate::State;
use equip_scalar::Float;

/// One equation g = 0, with its round-off level and gradients.
#[derive(Debug)]
pub struct Constraint<T: Float> {
    /// `None` for the energy, which uses the evaluator of the run.
    evaluator: Option<Evaluator<T>>,
    pub(crate) reference: T,
    /// g at the end and at the start of the step.
    pub(crate) residual: T,
    pub(crate) start_error: T,
    /// The change of g by the last accepted step.
    change: T,
    /// The round-off level at the end of the step, and the largest recent level.
    pub(crate) round_off: T,
    pub(crate) late: T,
    /// The largest recent level before the step.
    late_before: T,
    /// ∇I at the end and at the start of the step.
    pub(crate) gradient: Vec<T>,
    pub(crate) start_gradient: Vec<T>,
}

impl<T: Float> Constraint<T> {
    /// The energy, for states with `n` components. Its reference is set when the run begins.
    pub fn energy(n: usize) -> Self {
        let zero = T::int(0);
        Constraint {
            evaluator: None,
            reference: zero,
            residual: zero,
            start_error: zero,
            change: zero,
            round_off: zero,
            late: zero,
            late_before: zero,
            gradient: vec![zero; n],
            start_gradient: vec![zero; n],
        }
    }

    /// A further invariant, for states with `n` components.
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

    /// Begins a run at `y` with the energy `h_ref`, and forgets earlier steps.
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

    /// Evaluates I, ∇I and the round-off level at `y1`. ν is the rounding of the stages relative to `sizes`.
    /// Returns whether the results are finite.
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

    /// Begins a step.
    pub(crate) fn begin_step(&mut self) {
        self.late_before = self.late;
    }

    /// Called if the step has failed, perhaps after a part of it was accepted, or is rejected.
    pub(crate) fn restore(&mut self) {
        self.late = self.late_before;
    }

    /// Called if the step was accepted: its end is the start of the next step.
    pub(crate) fn accept(&mut self) {
        // An error accepted as round-off stays accepted until it is below the current round-off level.
        let fades = self.residual.abs() <= self.round_off;
        let late = if fades {
            self.late * T::ratio(FADING - 1, FADING)
        } else {
            self.late
        };
        self.late = late.max(self.round_off);
        self.change = (self.residual - self.start_error).abs();
        self.start_error = self.residual;
        self.start_gradient.copy_from_slice(&self.gradient);
    }

    /// Whether g is round-off.
    pub(crate) fn is_at_round_off(&self) -> bool {
        self.residual.abs() <= self.round_off.max(self.late)
    }

    /// Whether the last accepted step has changed g by more than its round-off level.
    pub(crate) fn has_changed(&self) -> bool {
        self.change > self.round_off
    }

    /// The noise of y1, relative to `sizes`, that would change I by |g|.
    pub(crate) fn noise_equivalent(&self, sizes: &[T]) -> T {
        self.residual.abs() / worth(&self.gradient, sizes)
    }

    /// A change `of` I, divided by the mean of Σ_i |∂_iI| σ_i over both ends. Every displacement that causes
    /// or removes this change is at least as large, in units of σ.
    pub(crate) fn least_displacement(&self, of: T, sizes: &[T]) -> T {
        let both = worth(&self.gradient, sizes) + worth(&self.start_gradient, sizes);
        let least = T::int(2) * of.abs() / both;
        if least.is_finite() { least } else { T::int(0) }
    }
}

/// Σ_i |∂_iI| σ_i, as eight partial sums.
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
