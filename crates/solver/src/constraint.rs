//! The second half of system (7): g = H(y1) − H_ref = 0, and how small g can be made at all.
//!
//! Further invariants that the user wants kept are equations of the same form with the same α's.
//!
//! *Inherited floors.* A close encounter has a high floor, and leaves an offset of that size to the quiet part after it. No α
//! of the quiet part can be asked to remove in one step what it took a close encounter to make: such an offset still is
//! round-off, until a step has been solved to its own floor.

use crate::invariant::Invariant;
use crate::state::State;
use equip_autodiff::{Evaluate, Hamiltonian, System};
use equip_scalar::Float;

/// Components whose errors are taken to have nothing to do with each other.
pub(crate) const MANY: usize = 64;

/// One equation g = I(y1) − I_ref = 0, with what is needed to judge and to reduce g.
///
/// I_ref is taken at the start of the *run*: an error left by one step is repaired by the next.
#[derive(Debug)]
pub struct Constraint<T: Float> {
    /// `None` for the energy, which has the run's evaluator.
    evaluator: Option<<Hamiltonian as System>::Evaluator<T>>,
    pub(crate) reference: T,
    /// g.
    pub(crate) defect: T,
    /// Below this, g is round-off: ε (|I_ref| + |I(y1)| + Σ_i |∂_iI(y1)| σ_i) with the sizes
    /// σ_i = max(|y0_i|, |y1_i|, |Z_i|) of the components, and once the stages have converged what
    /// their last, round-off sized correction would do to I.
    pub(crate) floor: T,
    /// The floor of the last step that was solved to its own: g is not known to be smaller.
    pub(crate) inherited: T,
    /// What a relative change of the state by 1 is worth, with I itself, which is rounded too.
    pub(crate) scale: T,
    /// The same of changes of many components that have nothing to do with each other: √(largest·sum), no less than the root of the sum of
    /// squares. Of few it is `scale`.
    pub(crate) spread: T,
    /// What a relative change of the state by 1 is worth alone.
    pub(crate) worth: T,
    /// ∇I(y1), of the last look that was no [`Constraint::glance`]: a step is accepted after another one only.
    pub(crate) gradient: Vec<T>,
    /// ∇I(y0), when the directions of the α's were taken.
    pub(crate) start_gradient: Vec<T>,
    /// g as predicted for converged stages.
    pub(crate) predicted: T,
    /// The same when the α's began to move: g of the step with α = 0.
    pub(crate) without_alpha: T,
}

impl<T: Float> Constraint<T> {
    /// The energy, of states with `n` components; its reference is given when the run begins.
    pub fn energy(n: usize) -> Self {
        let zero = T::int(0);
        Constraint {
            evaluator: None,
            reference: zero,
            defect: zero,
            floor: zero,
            inherited: zero,
            scale: zero,
            worth: zero,
            spread: zero,
            gradient: vec![zero; n],
            start_gradient: vec![zero; n],
            predicted: zero,
            without_alpha: zero,
        }
    }

    /// A further invariant, of states with `n` components.
    pub fn invariant(invariant: &Invariant, n: usize) -> Self {
        Constraint {
            evaluator: Some(invariant.function().evaluator::<T>()),
            ..Self::energy(n)
        }
    }

    /// A run begins at `y`, where the energy is `h_ref`: nothing of earlier steps is left.
    pub(crate) fn begin(&mut self, h_ref: T, y: &[T]) {
        let zero = T::int(0);
        self.reference = match &mut self.evaluator {
            None => {
                self.gradient.fill(zero);
                h_ref
            }
            Some(evaluator) => evaluator.gradient_with_compensated_value(y, &mut self.gradient),
        };
        self.start_gradient.fill(zero);
        (self.defect, self.floor, self.inherited) = (zero, zero, zero);
        (self.scale, self.worth, self.spread) = (zero, zero, zero);
        (self.predicted, self.without_alpha) = (zero, zero);
    }

    /// Evaluates I and ∇I at `y1`; `sizes` are those of the components over the step. Returns whether they are finite.
    pub(crate) fn evaluate<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        y1: &State<T>,
        sizes: &[T],
    ) -> bool {
        let value = match &mut self.evaluator {
            None => energy.gradient_with_compensated_value(&y1.hi, &mut self.gradient),
            Some(evaluator) => {
                evaluator.gradient_with_compensated_value(&y1.hi, &mut self.gradient)
            }
        };
        self.defect = value - self.reference;
        let values = self.reference.abs() + value.abs();
        (self.worth, self.spread) = if y1.hi.len() < MANY {
            let [moved, _] = worths::<T, 1>(&self.gradient, &y1.hi, sizes);
            (moved, values + moved)
        } else {
            let [moved, most] = worths::<T, 8>(&self.gradient, &y1.hi, sizes);
            (moved, most.sqrt() * moved.sqrt())
        };
        self.scale = values + self.worth;
        self.floor = self.round_off();
        value.is_finite() && self.floor.is_finite()
    }

    /// Evaluates I at `y1` alone, in a step that has been looked at with ∇I: `gradient`, `scale` and `spread` stay as they were then.
    /// Returns whether it is finite.
    pub(crate) fn glance<E: Evaluate<T>>(&mut self, energy: &mut E, y1: &State<T>) -> bool {
        let value = match &mut self.evaluator {
            None => energy.compensated_value(&y1.hi),
            Some(evaluator) => evaluator.compensated_value(&y1.hi),
        };
        self.defect = value - self.reference;
        self.floor = self.round_off();
        value.is_finite()
    }

    /// The floor of rounding the state alone. Below the smallest normal number rounding is absolute.
    fn round_off(&self) -> T {
        T::EPSILON * (self.scale + T::MIN_POSITIVE)
    }

    /// Evaluates ∇I at the start of the step.
    pub(crate) fn evaluate_start<E: Evaluate<T>>(&mut self, energy: &mut E, y0: &State<T>) {
        match &mut self.evaluator {
            None => energy.gradient(&y0.hi, &mut self.start_gradient),
            Some(evaluator) => evaluator.gradient(&y0.hi, &mut self.start_gradient),
        };
    }

    /// |I_ref| + Σ_i |∂_iI y_i| at the start of the step, where ∇I was evaluated.
    pub(crate) fn start_scale(&self, y0: &State<T>) -> T {
        self.reference.abs() + products(&self.start_gradient, &y0.hi)
    }

    /// Raises the floor by Σ_i |∂_iI(y1) δ_i|, δ being what the last correction of the stages, itself round-off, does
    /// to the end point. In stiff systems rounding the arguments Y_i is worth more than rounding y1.
    pub(crate) fn add_stage_noise(&mut self, delta: &[T]) {
        self.floor += products(&self.gradient, delta);
    }

    /// The same for stages whose last change, or what it has left, is this much of their size.
    pub(crate) fn add_noise(&mut self, error: T) {
        self.floor += error * self.scale;
    }

    /// |g| in units of its own floor.
    pub fn in_floors(&self) -> T {
        in_floors(self.defect, self.floor)
    }

    /// |g| in units of the mean of the floors at both ends of the step, of components with these `sizes`: the same for the step made
    /// backwards. ∇I was evaluated at both.
    pub(crate) fn in_floors_of_both_ends(&self, sizes: &[T]) -> T {
        let moved = products(&self.gradient, sizes) + products(&self.start_gradient, sizes);
        let scale = T::int(2) * self.reference.abs() + moved / T::int(2);
        in_floors(self.defect, T::EPSILON * (scale + T::MIN_POSITIVE))
    }

    /// The floor by which g is judged at the end of a step: its own if g is there, else the inherited one if that is larger.
    pub fn judging_floor(&self) -> T {
        if self.defect.abs() <= self.floor {
            self.floor
        } else {
            self.floor.max(self.inherited)
        }
    }

    /// |g| in units of the floor by which it is judged.
    pub fn in_judging_floors(&self) -> T {
        in_floors(self.defect, self.judging_floor())
    }

    /// |g| of the step with α = 0 in units of the floor, its own or the inherited one.
    pub(crate) fn without_alpha_in_floors(&self) -> T {
        in_floors(self.without_alpha, self.floor.max(self.inherited))
    }

    /// The step was accepted.
    pub(crate) fn accept(&mut self) {
        self.inherited = self.judging_floor();
    }
}

fn in_floors<T: Float>(defect: T, floor: T) -> T {
    if defect == T::int(0) {
        defect
    } else {
        defect.abs() / floor
    }
}

/// Sum and largest of what relative changes by 1 of the components are worth, N sums side by side.
fn worths<T: Float, const N: usize>(gradient: &[T], y: &[T], sizes: &[T]) -> [T; 2] {
    let (mut sums, mut most) = ([T::int(0); N], [T::int(0); N]);
    let rows = gradient.chunks(N).zip(y.chunks(N)).zip(sizes.chunks(N));
    for ((gradient, y), sizes) in rows {
        let places = sums.iter_mut().zip(&mut most);
        for (((&g, &y), &size), (sum, most)) in gradient.iter().zip(y).zip(sizes).zip(places) {
            let worth = (g * size.max(y.abs())).abs();
            *sum += worth;
            *most = most.max(worth);
        }
    }
    let total = sums.iter().fold(T::int(0), |total, &sum| total + sum);
    [total, most.iter().fold(T::int(0), |a, &x| a.max(x))]
}

fn products<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter()
        .zip(b)
        .fold(T::int(0), |sum, (&a, &b)| sum + (a * b).abs())
}

/// The worst of several constraints, in floors; zero for none.
pub(crate) fn worst<T: Float>(
    constraints: &[Constraint<T>],
    in_floors: impl Fn(&Constraint<T>) -> T,
) -> T {
    constraints.iter().fold(T::int(0), |worst, c| {
        let x = in_floors(c);
        if x > worst || Float::is_nan(x) {
            x
        } else {
            worst
        }
    })
}
