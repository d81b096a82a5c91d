//! [`TracedEvaluator`]: the evaluations of a trace in one float type.

use super::many::{Many, One};
use super::traced::{Hessian, Traced};
use crate::derivative::rounded::Rounded;
use crate::replay::batch::Batch;
use crate::replay::point::{Points, check_components, require_separable};
use crate::replay::values::Replay;
use crate::{Kinetic, Structure};
use equip_scalar::{FirstOrder, Float, InstructionSet};
use std::sync::Arc;

/// Evaluates a traced energy in the float type `T`. The first call of each kind allocates workspace.
#[derive(Debug, Clone)]
pub(crate) struct TracedEvaluator<T: Float> {
    pub(super) shared: Arc<Traced>,
    pub(super) set: InstructionSet,
    energy: One<T>,
    with_bound: One<T>,
    /// ∇H, the running error bound and H.
    bounded: Vec<T>,
    duals: Option<Replay<T::Forward<1>>>,
    rounded: Option<Replay<Rounded<T>>>,
    hessians: Many<T>,
    points: Points<T>,
    pub(super) gradients: Many<T>,
    /// ∇U of a separable H.
    pub(super) forces: Many<T>,
}

impl<T: Float> TracedEvaluator<T> {
    pub(crate) fn new(of: &Arc<Traced>) -> Self {
        TracedEvaluator {
            shared: Arc::clone(of),
            set: InstructionSet::best(),
            energy: One::new(),
            with_bound: One::new(),
            bounded: Vec::new(),
            duals: None,
            rounded: None,
            hessians: Many::new(),
            points: Points::default(),
            gradients: Many::new(),
            forces: Many::new(),
        }
    }

    fn check(&self, lengths: &[usize]) {
        check_components(2 * self.shared.structure.degrees_of_freedom, lengths);
    }

    pub(crate) fn value_at(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let mut value = [T::int(0)];
        (self.energy).run(self.set, &self.shared.energy, y, &mut value);
        value[0]
    }

    pub(crate) fn compensated_value_at(&mut self, y: &[T]) -> T {
        if !self.shared.has_long_sums {
            return self.value_at(y);
        }
        self.check(&[y.len()]);
        let mut value = [T::int(0)];
        (self.energy).run_compensated(self.set, &self.shared.energy, y, &mut value);
        value[0]
    }

    pub(crate) fn gradient_with_bound_at(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        self.check(&[gradient.len()]);
        let bound = self.bound_at(y);
        let n = y.len();
        gradient.copy_from_slice(&self.bounded[..n]);
        match self.shared.has_long_sums {
            true => (self.compensated_value_at(y), bound),
            false => (self.bounded[n + 1], bound),
        }
    }

    pub(crate) fn bound_at(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        self.bounded.resize(y.len() + 2, T::int(0));
        let of = self.shared.with_bound();
        self.with_bound.run(self.set, of, y, &mut self.bounded);
        self.bounded[y.len()]
    }

    pub(crate) fn gradients_at(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        self.check(&[n]);
        let of = self.shared.gradient();
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            self.gradients.one.run(self.set, of, y, gradient);
        }
    }

    pub(crate) fn gradients_of(&mut self, batch: Batch<T>) {
        batch.check([2 * self.shared.structure.degrees_of_freedom; 2]);
        (self.gradients).run(self.set, self.shared.gradient(), batch);
    }

    pub(crate) fn forces_of(&mut self, batch: Batch<T>) {
        require_separable(self.shared.structure.separable);
        batch.check([self.shared.structure.degrees_of_freedom; 2]);
        if let Some(of) = &self.shared.derivatives().forces {
            self.forces.run(self.set, of, batch);
        }
    }

    pub(crate) fn kinetic_energy(&mut self) -> Option<Kinetic<T>> {
        let shared = Arc::clone(&self.shared);
        let structure = &shared.structure;
        if !structure.separable || structure.degree_in_p.is_none_or(|degree| degree > 2) {
            return None;
        }
        let n = 2 * structure.degrees_of_freedom;
        let origin = vec![T::int(0); n];
        let mut gradient = origin.clone();
        self.gradients_at(&origin, &mut gradient, n);
        let curvature = |v: &[T], product: &mut [T]| self.hessian_times(&origin, v, product);
        Kinetic::new(structure, gradient, curvature)
    }

    pub(crate) fn hessian_times(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.check(&[y.len(), v.len(), product.len()]);
        let tape = self.shared.gradient().one();
        let dual = |x| T::Forward::with_gradient(x, [T::int(0)]);
        let duals = (self.duals).get_or_insert_with(|| Replay::<T>::new(tape).widened(dual));
        let rows = duals.run(tape, |k| T::Forward::with_gradient(y[k], [v[k]]));
        for (entry, row) in product.iter_mut().zip(rows) {
            [*entry] = row.gradient();
        }
    }

    /// Replaces errors of the components of `y` by the errors that they and rounding cause in ∇H.
    pub(crate) fn gradient_rounding_at(&mut self, y: &[T], off: &mut [T]) {
        self.check(&[y.len(), off.len()]);
        let tape = self.shared.gradient().one();
        let rounded = || Replay::<T>::new(tape).widened(Rounded::fixed);
        let rounded = self.rounded.get_or_insert_with(rounded);
        let rows = rounded.run(tape, |k| Rounded {
            value: y[k],
            error: off[k],
        });
        for (off, row) in off.iter_mut().zip(rows) {
            *off = row.error;
        }
    }

    pub(crate) fn hessian_at(&mut self, y: &[T], entries: &mut [T]) {
        let shared = Arc::clone(&self.shared);
        let structure = &shared.structure;
        Batch::one(y, entries).check(rows_of(structure));
        match shared.hessian() {
            Hessian::Recorded(of) => self.hessians.one.run(self.set, of, y, entries),
            Hessian::ByColours(colouring) => {
                let product_into = |v: &[T], product: &mut [T]| self.hessian_times(y, v, product);
                colouring.entries(&structure.hessian, product_into, entries);
            }
        }
    }

    pub(crate) fn hessians_of(&mut self, batch: Batch<T>) {
        let shared = Arc::clone(&self.shared);
        let lengths = rows_of(&shared.structure);
        batch.check(lengths);
        match shared.hessian() {
            Hessian::Recorded(of) => self.hessians.run(self.set, of, batch),
            Hessian::ByColours(_) => {
                let mut points = std::mem::take(&mut self.points);
                points.each(batch, lengths, |y, entries| self.hessian_at(y, entries));
                self.points = points;
            }
        }
    }
}

/// The number of components of a state, and of entries of ∇²H.
fn rows_of(structure: &Structure) -> [usize; 2] {
    [2 * structure.degrees_of_freedom, structure.hessian.len()]
}

/// The functions compiled once with this crate by [`equip_scalar::ready!`]: those of
/// [`Evaluator`](crate::Evaluator), by their names there, and the running error bound alone.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
pub(crate) struct Ready<T: Float> {
    pub(crate) evaluator: fn(&Arc<Traced>) -> TracedEvaluator<T>,
    pub(crate) value: fn(&mut TracedEvaluator<T>, &[T]) -> T,
    pub(crate) compensated_value: fn(&mut TracedEvaluator<T>, &[T]) -> T,
    pub(crate) gradient_with_bound: fn(&mut TracedEvaluator<T>, &[T], &mut [T]) -> (T, T),
    pub(crate) bound: fn(&mut TracedEvaluator<T>, &[T]) -> T,
    pub(crate) gradients: fn(&mut TracedEvaluator<T>, &[T], &mut [T], usize),
    pub(crate) gradients_by_component: fn(&mut TracedEvaluator<T>, Batch<T>),
    pub(crate) forces_by_component: fn(&mut TracedEvaluator<T>, Batch<T>),
    pub(crate) kinetic: fn(&mut TracedEvaluator<T>) -> Option<Kinetic<T>>,
    pub(crate) gradient_rounding: fn(&mut TracedEvaluator<T>, &[T], &mut [T]),
    pub(crate) hessian_vector: fn(&mut TracedEvaluator<T>, &[T], &[T], &mut [T]),
    pub(crate) hessian: fn(&mut TracedEvaluator<T>, &[T], &mut [T]),
    pub(crate) hessians_by_component: fn(&mut TracedEvaluator<T>, Batch<T>),
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        evaluator: TracedEvaluator::new,
        value: TracedEvaluator::value_at,
        compensated_value: TracedEvaluator::compensated_value_at,
        gradient_with_bound: TracedEvaluator::gradient_with_bound_at,
        bound: TracedEvaluator::bound_at,
        gradients: TracedEvaluator::gradients_at,
        gradients_by_component: TracedEvaluator::gradients_of,
        forces_by_component: TracedEvaluator::forces_of,
        kinetic: TracedEvaluator::kinetic_energy,
        gradient_rounding: TracedEvaluator::gradient_rounding_at,
        hessian_vector: TracedEvaluator::hessian_times,
        hessian: TracedEvaluator::hessian_at,
        hessians_by_component: TracedEvaluator::hessians_of,
    };
}

equip_scalar::ready!(Ready);
