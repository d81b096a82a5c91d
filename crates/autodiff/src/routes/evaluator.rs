//! [`Evaluator`]: what an integrator needs of an energy.

use super::external::ExternalEvaluator;
use super::given::Given;
use super::traced_evaluator::{TracedEvaluator, ready};
use crate::hamiltonian::{Energy, Hamiltonian};
use crate::native::fused::{Fused, Joined, fuse};
use crate::replay::point::{check_batch, require_separable};
use crate::{Kinetic, WrongGradient};
use equip_scalar::{Float, InstructionSet};

/// H, ∇H and ∇²H at states y = (q, p) of length n = 2m, in the float type `T`. Workspace is allocated at the
/// first call of a kind, and at no other.
///
/// Slices of another length are a programming error and panic.
#[derive(Debug, Clone)]
pub struct Evaluator<T: Float>(Source<T>);

/// Where H comes from, with the workspace of one float type.
#[derive(Debug, Clone)]
enum Source<T: Float> {
    Traced(Box<TracedEvaluator<T>>),
    /// With a gradient of the user's own.
    WithGradient(Box<TracedEvaluator<T>>, Box<Given<T>>),
    External(Box<ExternalEvaluator<T>>),
}

use Source::{External, Traced, WithGradient};

impl Hamiltonian {
    /// An evaluator in float type `T`: constants are read in it once, workspace is allocated once.
    pub fn evaluator<T: Float>(&self) -> Evaluator<T> {
        Evaluator::new(self)
    }
}

impl<T: Float> Evaluator<T> {
    fn new(of: &Hamiltonian) -> Self {
        let traced = match &of.energy {
            Energy::Traced(traced) => Box::new((ready::<T>().evaluator)(&traced.shared)),
            Energy::External(external) => {
                return Evaluator(External(Box::new(ExternalEvaluator::new(external))));
            }
        };
        let n = 2 * traced.shared.structure.degrees_of_freedom;
        Evaluator(match of.gradient.as_ref().filter(|_| T::IS_DOUBLE) {
            Some(gradient) => WithGradient(traced, Box::new(Given::new(gradient, n))),
            None => Traced(traced),
        })
    }

    /// The checksum of the formula of H with its constants and tables; `None` where H is external. Closures
    /// within H count as one. Linear in the operations of H.
    pub fn formula_checksum(&self) -> Option<u64> {
        match &self.0 {
            Traced(traced) | WithGradient(traced, _) => Some(traced.shared.formula_checksum()),
            External(_) => None,
        }
    }

    /// Makes now what the first evaluation would make, by one of `n` zeros. Code of the user's own is not
    /// called.
    #[doc(hidden)]
    pub fn make_ready(&mut self, n: usize) {
        let (zeros, mut gradient) = (vec![T::int(0); n], vec![T::int(0); n]);
        match &mut self.0 {
            Traced(_) => drop(self.gradient_with_compensated_value(&zeros, &mut gradient)),
            WithGradient(..) => drop(self.compensated_value(&zeros)),
            External(_) => {}
        }
    }

    /// H(y).
    pub fn value(&mut self, y: &[T]) -> T {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().value)(traced, y),
            External(external) => external.value(y),
        }
    }

    /// H(y), the terms of long sums in it added by compensated summation: what is left of H1 − H0 is not
    /// hidden by rounding the partial sums of n terms, which is worth some √n ε of H. Without long sums it
    /// has every bit of [`value`](Self::value).
    pub fn compensated_value(&mut self, y: &[T]) -> T {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().compensated_value)(traced, y),
            External(external) => external.value(y),
        }
    }

    /// ∇H(y) into `gradient` (length n); returns H(y).
    pub fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.value(y)
    }

    /// The same; returns H(y) as [`compensated_value`](Self::compensated_value) does.
    pub fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.compensated_value(y)
    }

    /// ∇H(y) into `gradient` (length n); returns H(y) as [`compensated_value`](Self::compensated_value) does,
    /// and the running error bound of it, without its factor ε:
    ///
    /// Σ_k |v_k ∂H/∂v_k| + Σ_i |y_i ∂H/∂y_i|
    ///
    /// in the units of H, over all operations v_k of H (H is the last of them) and all components of the
    /// state. ε times it is above what rounding makes of H, also where large parts of H cancel. An integer
    /// power counts once for every two of its multiplications. Partial sums of sums that are compensated are
    /// not rounded and do not count, but their terms and results do. Constants do not count: they are
    /// rounded alike at every state. Of an external energy the one operation is its value.
    ///
    /// Costs at most about two gradients more.
    pub fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        match &mut self.0 {
            Traced(traced) => (ready::<T>().gradient_with_bound)(traced, y, gradient),
            WithGradient(traced, given) => {
                given.at(y, gradient);
                let h = (ready::<T>().compensated_value)(traced, y);
                (h, (ready::<T>().bound)(traced, y))
            }
            External(external) => external.gradient_with_bound(y, gradient),
        }
    }

    /// How far each component of ∇H(y) may be off by rounding of `y` to its last place and of all operations,
    /// to first order, into `off` (length n): the running error bound of the trace of ∇H. Zero of an
    /// external energy, of which it is not known.
    pub fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => {
                (ready::<T>().gradient_rounding)(traced, y, off)
            }
            External(external) => external.gradient_rounding(y, off),
        }
    }

    /// ∇H at several states, which stand one after the other in `states` (length s·n), as do the results.
    pub fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        match &mut self.0 {
            Traced(traced) => (ready::<T>().gradients)(traced, states, gradients, n),
            WithGradient(_, given) => given.one_by_one(states, gradients, n),
            External(external) => external.given.one_by_one(states, gradients, n),
        }
    }

    /// ∇H at `count` points at once, component by component: component c of point i stands at `c·stride + i`
    /// in `states` (length n·stride), as in `gradients`. Places between `count` and `stride` must hold finite
    /// numbers; what is in the result there is unspecified. Each gradient has every bit of the one
    /// [`gradient`](Self::gradient) gives.
    pub fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        match &mut self.0 {
            Traced(traced) => {
                (ready::<T>().gradients_by_component)(traced, states, gradients, stride, count);
            }
            WithGradient(_, given) => given.by_component(states, gradients, stride, count),
            External(external) => {
                (external.given).by_component(states, gradients, stride, count);
            }
        }
    }

    /// ∇U at `count` positions of a separable H = T(p) + U(q), in the same layout with m components instead
    /// of n. Has every bit of ∂H/∂q.
    ///
    /// # Panics
    /// If H is not separable.
    pub fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        match &mut self.0 {
            Traced(traced) => {
                (ready::<T>().forces_by_component)(traced, positions, gradients, stride, count);
            }
            WithGradient(traced, given) => {
                let structure = &traced.shared.structure;
                require_separable(structure.separable);
                let lengths = [positions.len(), gradients.len()];
                check_batch(structure.degrees_of_freedom, lengths, stride, count);
                given.each(positions, gradients, stride, count);
            }
            External(external) => require_separable(external.of.structure.separable),
        }
    }

    /// Runs `task` with ∇H in it as one kernel. `None` if that is not done: of an energy without machine
    /// code, or too long, or with a gradient of the user's own.
    #[doc(hidden)]
    #[inline]
    pub fn fuse_gradients<const N: usize, F: Fused<N>>(
        &mut self,
        task: &mut F,
    ) -> Option<F::Output> {
        let Traced(traced) = &mut self.0 else {
            return None;
        };
        let n = 2 * traced.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let derivatives =
            (traced.gradients).called(traced.set, traced.shared.gradient(), stride)?;
        fuse!(traced.set, n, derivatives, task, [2 4])
    }

    /// The same with ∇U, of a separable H only.
    #[doc(hidden)]
    #[inline]
    pub fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let Traced(traced) = &mut self.0 else {
            return None;
        };
        let m = traced.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let of = traced.shared.derivatives().forces.as_ref()?;
        let derivatives = traced.forces.called(traced.set, of, stride)?;
        fuse!(traced.set, m, derivatives, task, [1 2 3 4])
    }

    /// Compares a gradient of the user's own with H at `y` (length n): by automatic differentiation where H
    /// is a trace, else by differences of H. Of a gradient derived from H there is nothing to compare.
    ///
    /// # Errors
    /// The first component that differs.
    pub fn check_gradient(&mut self, y: &[T]) -> Result<(), WrongGradient<T>> {
        match &mut self.0 {
            Traced(_) => Ok(()),
            WithGradient(traced, given) => given.check(y, |y, expected| {
                (ready::<T>().gradients)(traced, y, expected, y.len());
            }),
            External(external) => external.check_gradient(y),
        }
    }

    /// T(p) of H = T(p) + U(q), if H is separable and T quadratic. Evaluates ∇²T once; allocates.
    pub fn kinetic(&mut self) -> Option<Kinetic<T>> {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().kinetic)(traced),
            External(_) => None,
        }
    }

    /// Chooses the instructions, [`InstructionSet::best`] to begin with. The results are the same.
    #[doc(hidden)]
    pub fn set_instruction_set(&mut self, set: InstructionSet) {
        if let Traced(traced) | WithGradient(traced, _) = &mut self.0 {
            traced.set = set;
        }
    }

    /// ∇²H(y)·v into `product` (length n); of an external energy by differences of its gradient.
    pub fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => {
                (ready::<T>().hessian_vector)(traced, y, v, product)
            }
            External(external) => external.hessian_times(y, v, product),
        }
    }

    /// The entries of ∇²H(y) in the order of the pattern `structure().hessian`; of an external energy by
    /// differences of its gradient.
    pub fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().hessian)(traced, y, entries),
            External(external) => external.hessian(y, entries),
        }
    }

    /// ∇²H at `count` points at once, component by component as in
    /// [`gradients_by_component`](Self::gradients_by_component): entry e of the pattern at point i into place
    /// `e·stride + i` of `entries`.
    pub fn hessians_by_component(
        &mut self,
        states: &[T],
        entries: &mut [T],
        stride: usize,
        count: usize,
    ) {
        match &mut self.0 {
            Traced(traced) | WithGradient(traced, _) => {
                (ready::<T>().hessians_by_component)(traced, states, entries, stride, count);
            }
            External(external) => external.hessians(states, entries, stride, count),
        }
    }
}
