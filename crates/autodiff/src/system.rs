//! What an integrator asks of an energy.

use crate::replay::point::Points;
use crate::routes::check::by_differences;
use crate::{Fused, Hamiltonian, Kinetic, RecordedEvaluator, Structure, Switches, WrongGradient};
use equip_scalar::{Float, InstructionSet};

/// A scalar energy with everything derived from it, in any float type.
pub trait System {
    /// Values and derivatives in one float type, with their workspace.
    type Evaluator<T: Float>: Evaluate<T>;

    /// Degrees of freedom m; the state y = (q, p) has 2m components. Where H depends on time it counts as
    /// one, the last.
    fn degrees_of_freedom(&self) -> usize {
        self.structure().degrees_of_freedom
    }

    /// Whether H depends on time, which is the last position then, and K = H + p_t is what is integrated
    /// ([`Hamiltonian::with_time`]).
    fn has_time(&self) -> bool {
        false
    }

    /// Separability, degree and sparsity of H.
    fn structure(&self) -> &Structure;

    /// Where H or a derivative of it jumps, as far as that is known. Computed anew at each call, in time and
    /// memory in proportion to the operations of H.
    fn switches(&self) -> Switches {
        Switches::none()
    }

    /// An evaluator in float type `T`: constants are read in it once, workspace is allocated once.
    fn evaluator<T: Float>(&self) -> Self::Evaluator<T>;
}

impl<H: System> System for &H {
    type Evaluator<T: Float> = H::Evaluator<T>;

    fn has_time(&self) -> bool {
        (**self).has_time()
    }

    fn structure(&self) -> &Structure {
        (**self).structure()
    }

    fn switches(&self) -> Switches {
        (**self).switches()
    }

    fn evaluator<T: Float>(&self) -> Self::Evaluator<T> {
        (**self).evaluator()
    }
}

impl<R: System> System for Hamiltonian<R> {
    type Evaluator<T: Float> = R::Evaluator<T>;

    fn has_time(&self) -> bool {
        self.alone.is_some()
    }

    fn structure(&self) -> &Structure {
        self.route.structure()
    }

    fn switches(&self) -> Switches {
        self.route.switches()
    }

    fn evaluator<T: Float>(&self) -> Self::Evaluator<T> {
        self.route.evaluator()
    }
}

/// H, ∇H and ∇²H at given states y = (q, p) of length n = 2m. Nothing is allocated by these calls, but by the
/// first of a kind.
///
/// Slices of another length are a programming error and panic.
pub trait Evaluate<T: Float> {
    /// Whether this is a [`RecordedEvaluator`], as [`recorded`](Self::recorded) takes for granted: a
    /// constant, so that code for the one or the other need not be compiled.
    #[doc(hidden)]
    const IS_RECORDED: bool = false;

    /// What holds an evaluator of this type, known to hold one of a recording: how generic code reaches what
    /// is compiled for recordings once.
    #[doc(hidden)]
    fn recorded<'a, H: Holds<'a>>(held: H::With<Self>) -> H::With<RecordedEvaluator<T>>
    where
        Self: Sized + 'a,
    {
        drop(held);
        unreachable!("only evaluators of recordings are asked")
    }

    /// The checksum of the formula of H with its constants and tables, as it was recorded; `None` where H is
    /// no recording. Closures from outside count as one. Linear in the operations of H.
    fn formula_checksum(&self) -> Option<u64> {
        None
    }

    /// H(y).
    fn value(&mut self, y: &[T]) -> T;

    /// ∇H(y) into `gradient` (length n); returns H(y).
    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T;

    /// H(y), the terms of long sums in it added by compensated summation: what is left of H1 − H0 is not
    /// hidden by rounding the partial sums of n terms, which is worth some √n ε of H. Without long sums it
    /// has every bit of [`value`](Self::value).
    fn compensated_value(&mut self, y: &[T]) -> T {
        self.value(y)
    }

    /// ∇H(y) into `gradient` (length n); returns H(y) as [`compensated_value`](Self::compensated_value) does.
    fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradient(y, gradient)
    }

    /// ∇H(y) into `gradient` (length n); returns H(y) as [`compensated_value`](Self::compensated_value) does,
    /// and the running error bound of it, without its factor ε:
    ///
    /// Σ_k |v_k ∂H/∂v_k| + Σ_i |y_i ∂H/∂y_i|
    ///
    /// in the units of H, over all operations v_k of H (as recorded, whatever the route; H is the last of
    /// them) and all components of the state. ε times it is above what rounding makes of H, also where large
    /// parts of H cancel. An integer power counts once for every two of its multiplications. Partial sums of
    /// sums that are compensated are not rounded and do not count, but their terms and results do. Constants
    /// do not count: they are rounded alike at every state.
    ///
    /// Costs at most about two gradients more. The first call allocates.
    fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T);

    /// How far each component of ∇H(y) may be off by rounding of `y` to its last place and of all operations,
    /// to first order, into `off` (length n): the running error bound of the recording of ∇H, whatever the
    /// route. Zero where nothing is known, as here.
    fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        let _ = y;
        off.fill(T::int(0));
    }

    /// ∇H at several states, which stand one after the other in `states` (length s·n), as do the results.
    fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            self.gradient(y, gradient);
        }
    }

    /// ∇H at `count` points at once, component by component: component c of point i stands at `c·stride + i`
    /// in `states` (length n·stride), as in `gradients`. Places between `count` and `stride` must hold finite
    /// numbers; what is in the result there is unspecified. Each gradient has every bit of the one
    /// [`gradient`](Self::gradient) gives.
    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    );

    /// ∇U at `count` positions of a separable H = T(p) + U(q), in the same layout with m components instead
    /// of n. Has every bit of ∂H/∂q.
    ///
    /// # Panics
    /// If H is not separable.
    fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    );

    /// Runs `task` with ∇H in it as one kernel. `None` if that is not done: an energy that is not compiled,
    /// or too long, or brings its own gradient, has none that could be inlined; and each kernel is compiled
    /// anew for every energy, so it is done where it pays.
    #[doc(hidden)]
    #[inline(always)]
    fn fuse_gradients<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let _ = task;
        None
    }

    /// The same with ∇U, of a separable H only.
    #[doc(hidden)]
    #[inline(always)]
    fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let _ = task;
        None
    }

    /// Compares a gradient written by hand with H at `y` (length n): by automatic differentiation where H is
    /// recorded, else, as here, by differences of H. Of a gradient derived from H there is nothing to
    /// compare.
    ///
    /// # Errors
    /// The first component that differs.
    fn check_gradient(&mut self, y: &[T]) -> Result<(), WrongGradient<T>> {
        let mut given = vec![T::int(0); y.len()];
        let (_, bound) = self.gradient_with_bound(y, &mut given);
        by_differences(y, (&given, bound), |y| self.value(y))
    }

    /// T(p) of H = T(p) + U(q), if H is separable and T quadratic. Evaluates ∇²T once; allocates.
    fn kinetic(&mut self) -> Option<Kinetic<T>>;

    /// Chooses the instructions of the two methods above, [`InstructionSet::best`] to begin with. The results
    /// are the same.
    #[doc(hidden)]
    fn set_instruction_set(&mut self, set: InstructionSet);

    /// ∇²H(y)·v into `product` (length n).
    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]);

    /// The entries of ∇²H(y) in the order of the pattern `structure().hessian`.
    fn hessian(&mut self, y: &[T], entries: &mut [T]);

    /// ∇²H at `count` points at once, component by component as in
    /// [`gradients_by_component`](Self::gradients_by_component): entry e of the pattern at point i into place
    /// `e·stride + i` of `entries`. Allocates, unless it is overridden.
    fn hessians_by_component(
        &mut self,
        states: &[T],
        entries: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let (n, len) = (states.len() / stride, entries.len() / stride);
        let mut points = Points::default();
        points.make_room(n, len);
        points.each(states, entries, stride, count, |y, entries| {
            self.hessian(y, entries);
        });
    }
}

/// Something with an evaluator in it, whatever its type.
#[doc(hidden)]
pub trait Holds<'a> {
    /// It, with an evaluator of type `E`.
    type With<E: 'a>;
}
