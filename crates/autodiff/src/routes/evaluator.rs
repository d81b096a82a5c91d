//! [`Evaluator`]: the evaluations of an energy that an integrator needs.

use super::traced_evaluator::{TracedEvaluator, ready};
use crate::external::energy::ExternalEvaluator;
use crate::external::given::Given;
use crate::hamiltonian::{Energy, Hamiltonian};
use crate::native::fused::{Fused, Joined, fuse};
use crate::replay::batch::Batch;
use crate::replay::point::require_separable;
use crate::structure::bracket::Bracket;
use crate::{Kinetic, Pattern, WrongGradient};
use equip_scalar::{Float, InstructionSet};

/// H, ∇H and ∇²H at states y = (q, p) of length n = 2m, in the floating-point type `T`. The first call of
/// each kind allocates workspace; later calls do not allocate.
///
/// Slices of another length are a programming error and panic.
///
/// A step needs the vector w of y' = Jw. It is ∇H, or w = JᵀB∇H for a system with a bracket
/// ([`Hamiltonian::with_bracket`]):
///
/// | of H, for any bracket | of w |
/// |---|---|
/// | [`value`](Self::value), [`compensated_value`](Self::compensated_value), [`gradient`](Self::gradient), [`gradients`](Self::gradients), [`gradient_with_bound`](Self::gradient_with_bound), [`check_gradient`](Self::check_gradient) | [`flow_gradient`](Self::flow_gradient), [`vector_field`](Self::vector_field), [`jacobian_vector`](Self::jacobian_vector), [`gradients_by_component`](Self::gradients_by_component), [`gradient_rounding`](Self::gradient_rounding), [`hessian`](Self::hessian), [`hessian_vector`](Self::hessian_vector), [`hessians_by_component`](Self::hessians_by_component) |
#[derive(Debug, Clone)]
pub struct Evaluator<T: Float> {
    pub(super) source: Source<T>,
    pub(super) bracket: Option<Box<Turned<T>>>,
}

/// A bracket with its workspace, which is allocated at the first call of each kind.
#[derive(Debug, Clone)]
pub(super) struct Turned<T: Float> {
    pub(super) of: Bracket,
    pub(super) form: TracedEvaluator<T>,
    /// The pattern of ∇²H.
    pub(super) pattern: Pattern,
    /// ∇H and the entries of ∇²H.
    pub(super) gradients: Vec<T>,
    pub(super) hessians: Vec<T>,
    /// (y, g, λ) with λ = 0, the gradient of the form there, and its Hessian.
    pub(super) points: Vec<T>,
    pub(super) of_form: Vec<T>,
    pub(super) entries: Vec<T>,
    /// (v, ∇²H·v, 0).
    pub(super) along: Vec<T>,
}

/// The source of H, with the workspace of one floating-point type.
#[derive(Debug, Clone)]
pub(super) enum Source<T: Float> {
    Traced(Box<TracedEvaluator<T>>),
    /// With a user-supplied gradient.
    WithGradient(Box<TracedEvaluator<T>>, Box<Given<T>>),
    External(Box<ExternalEvaluator<T>>),
}

use Source::{External, Traced, WithGradient};

impl Hamiltonian {
    /// An evaluator in floating-point type `T`. Constants are converted and workspace is allocated once.
    pub fn evaluator<T: Float>(&self) -> Evaluator<T> {
        Evaluator::new(self)
    }
}

impl<T: Float> Evaluator<T> {
    fn new(of: &Hamiltonian) -> Self {
        let source = match &of.energy {
            Energy::Traced(traced) => {
                let n = 2 * traced.structure.degrees_of_freedom;
                let evaluator = Box::new((ready::<T>().evaluator)(traced));
                match of.gradient.as_ref().filter(|_| T::IS_DOUBLE) {
                    Some(gradient) => WithGradient(evaluator, Box::new(Given::new(gradient, n))),
                    None => Traced(evaluator),
                }
            }
            Energy::External(external) => External(Box::new(ExternalEvaluator::new(external))),
        };
        let bracket = of.bracket.as_deref().map(|(form, bracket)| {
            Box::new(Turned {
                of: bracket.clone(),
                form: (ready::<T>().evaluator)(form),
                pattern: of.energy_structure().hessian.to_pattern(),
                gradients: Vec::new(),
                hessians: Vec::new(),
                points: Vec::new(),
                of_form: Vec::new(),
                entries: Vec::new(),
                along: Vec::new(),
            })
        });
        Evaluator { source, bracket }
    }

    /// Whether y' = J∇H.
    pub fn is_canonical(&self) -> bool {
        self.bracket.is_none()
    }

    /// The checksum of the formulas of H and of the bracket, with their constants and tables; `None` if H is
    /// external. All closures within H have the same checksum. Linear in the operations of H.
    pub fn formula_checksum(&self) -> Option<u64> {
        let form = self.bracket.as_ref().map(|of| &of.form.shared);
        let of_bracket = form.map(|form| form.formula_checksum());
        match &self.source {
            Traced(traced) | WithGradient(traced, _) => {
                let own = traced.shared.formula_checksum();
                Some(of_bracket.map_or(own, |form| form.rotate_left(1) ^ own))
            }
            External(_) => None,
        }
    }

    /// Performs the initialisation of the first evaluation now, at a state of `n` zeros. User code is not
    /// called.
    #[doc(hidden)]
    pub fn make_ready(&mut self, n: usize) {
        let (zeros, mut gradient) = (vec![T::int(0); n], vec![T::int(0); n]);
        match &mut self.source {
            Traced(_) => drop(self.gradient_with_compensated_value(&zeros, &mut gradient)),
            WithGradient(..) => drop(self.compensated_value(&zeros)),
            External(_) => {}
        }
    }

    /// H(y).
    pub fn value(&mut self, y: &[T]) -> T {
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().value)(traced, y),
            External(external) => external.value(y),
        }
    }

    /// H(y), with compensated summation of the terms of long sums. The rounding of the partial sums of n
    /// terms, about √n ε of H, then does not hide the difference H1 − H0. Without long sums the result agrees
    /// bit for bit with [`value`](Self::value).
    pub fn compensated_value(&mut self, y: &[T]) -> T {
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().compensated_value)(traced, y),
            External(external) => external.value(y),
        }
    }

    /// Writes ∇H(y) to `gradient` (length n), and returns H(y).
    pub fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.value(y)
    }

    /// The same, but returns H(y) like [`compensated_value`](Self::compensated_value).
    pub fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.compensated_value(y)
    }

    /// Writes ∇H(y) to `gradient` (length n). Returns H(y) like
    /// [`compensated_value`](Self::compensated_value), and its running error bound without the factor ε:
    ///
    /// Σ_k |v_k ∂H/∂v_k| + Σ_i |y_i ∂H/∂y_i|
    ///
    /// in the units of H, over all operations v_k of H (H is the last of them) and all components of the
    /// state. ε times this bound exceeds the rounding error of H even if large parts of H cancel. An integer
    /// power counts once for every two of its multiplications. Partial sums of compensated sums are not
    /// rounded and do not count, but their terms and results do. Constants have the same rounding at every
    /// state and do not count. For an external energy the only operation is its value.
    ///
    /// Costs at most about two additional gradients.
    pub fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        match &mut self.source {
            Traced(traced) => (ready::<T>().gradient_with_bound)(traced, y, gradient),
            WithGradient(traced, given) => {
                given.at(y, gradient);
                let h = (ready::<T>().compensated_value)(traced, y);
                (h, (ready::<T>().bound)(traced, y))
            }
            External(external) => external.gradient_with_bound(y, gradient),
        }
    }

    /// ∇H at several states, concatenated in `states` (length s·n). The results are concatenated as well.
    pub fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        match &mut self.source {
            Traced(traced) => (ready::<T>().gradients)(traced, states, gradients, n),
            WithGradient(_, given) => given.one_by_one(states, gradients, n),
            External(external) => external.given.one_by_one(states, gradients, n),
        }
    }

    /// ∇U at `count` positions of a separable H = T(p) + U(q), in the layout of `gradients_by_component` with
    /// m components instead of n. The results agree bit for bit with ∂H/∂q.
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
        let batch = Batch::new(positions, gradients, stride, count);
        match &mut self.source {
            Traced(traced) => (ready::<T>().forces_by_component)(traced, batch),
            WithGradient(traced, given) => {
                let structure = &traced.shared.structure;
                require_separable(structure.separable);
                batch.check([structure.degrees_of_freedom; 2]);
                given.each(batch);
            }
            External(external) => {
                let structure = &external.of.structure;
                require_separable(structure.separable);
                batch.check([structure.degrees_of_freedom; 2]);
                external.given.each(batch);
            }
        }
    }

    /// Runs `task`, which contains ∇H, as one kernel. `None` if the energy has no machine code, is too large,
    /// or has a user-supplied gradient or a bracket.
    #[doc(hidden)]
    #[inline]
    pub fn fuse_gradients<const N: usize, F: Fused<N>>(
        &mut self,
        task: &mut F,
    ) -> Option<F::Output> {
        let (Traced(traced), None) = (&mut self.source, &self.bracket) else {
            return None;
        };
        let n = 2 * traced.shared.structure.degrees_of_freedom;
        let derivatives = (traced.gradients).called(traced.set, traced.shared.gradient(), N)?;
        fuse!(traced.set, n, derivatives, task, [2 4])
    }

    /// The same with ∇U, for a separable H only.
    #[doc(hidden)]
    #[inline]
    pub fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let (Traced(traced), None) = (&mut self.source, &self.bracket) else {
            return None;
        };
        let m = traced.shared.structure.degrees_of_freedom;
        let of = traced.shared.derivatives().forces.as_ref()?;
        let derivatives = traced.forces.called(traced.set, of, N)?;
        fuse!(traced.set, m, derivatives, task, [1 2 3 4])
    }

    /// Compares a user-supplied gradient with H at `y` (length n): with automatic differentiation if H is
    /// traced, otherwise with differences of H. A gradient derived from H is not compared.
    ///
    /// # Errors
    /// The first component that differs.
    pub fn check_gradient(&mut self, y: &[T]) -> Result<(), WrongGradient<T>> {
        match &mut self.source {
            Traced(_) => Ok(()),
            WithGradient(traced, given) => given.check(y, |y, expected| {
                (ready::<T>().gradients)(traced, y, expected, y.len());
            }),
            External(external) => external.check_gradient(y),
        }
    }

    /// The number of gradients for ∇²H at one point: 2n for an external energy, whose ∇²H is computed by
    /// differences, n for an external potential, 0 otherwise.
    pub fn gradients_of_hessian(&self) -> u64 {
        match &self.source {
            External(external) => external.gradients_of_hessian(),
            Traced(_) | WithGradient(..) => 0,
        }
    }

    /// T(p) of H = T(p) + U(q), if H is separable, T is quadratic and the bracket is canonical. Evaluates ∇²T
    /// once. Allocates.
    pub fn kinetic(&mut self) -> Option<Kinetic<T>> {
        if self.bracket.is_some() {
            return None;
        }
        match &mut self.source {
            Traced(traced) | WithGradient(traced, _) => (ready::<T>().kinetic)(traced),
            External(external) => external.kinetic(),
        }
    }

    /// Sets the instruction set, initially [`InstructionSet::best`]. The results do not depend on it.
    #[doc(hidden)]
    pub fn set_instruction_set(&mut self, set: InstructionSet) {
        if let Traced(traced) | WithGradient(traced, _) = &mut self.source {
            traced.set = set;
        }
    }
}
