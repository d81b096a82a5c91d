//! [`Recorded`]: the closure route. H is recorded once, on a tape, and replayed in any float type.

use crate::batch::Batch;
use crate::bound::{Bound, BoundRuns};
use crate::compiled::{Compiled, Runs};
use crate::derivative::differentiate;
use crate::fused::{Fused, Joined, fuse};
use crate::graph::Graph;
use crate::hessian::{DIRECTIONS, HessianPlan};
use crate::many::Many;
use crate::order::Blocks;
use crate::peephole::peephole;
use crate::point::{check_batch, require_separable};
use crate::ready::ready;
use crate::recorder::Recorder;
use crate::system::Holds;
use crate::tangent::Tangent;
use crate::tape::Tape;
use crate::trace::record;
use crate::values::Replay;
use crate::{BuildError, Evaluate, Kinetic, Structure, System, Var, degree, separable, sparsity};
use equip_scalar::{Float, InstructionSet};
use std::sync::Arc;

/// An energy recorded from a closure; made by [`Hamiltonian::new`](crate::Hamiltonian::new).
#[derive(Debug, Clone)]
pub struct Recorded {
    shared: Arc<Shared>,
}

/// What evaluators in all float types share.
#[derive(Debug)]
struct Shared {
    energy: Tape,
    /// All n components of ∇H.
    gradient: Tape,
    /// The same for many points.
    gradients: Tape,
    /// ∇U, if H = T(p) + U(q).
    forces: Option<Tape>,
    bound: Bound,
    compiled: AsCode,
    plan: HessianPlan,
    structure: Structure,
}

/// The recordings that can be machine code.
#[derive(Debug)]
struct AsCode {
    energy: Option<Arc<Compiled>>,
    gradient: Option<Arc<Compiled>>,
    forces: Option<Arc<Compiled>>,
}

impl Recorded {
    pub(crate) fn new(
        m: usize,
        energy: impl FnOnce(&[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        let (recorder, root) = record(m, energy)?;
        Recorded::of(m, recorder, root)
    }

    /// Compiled once, and not for every closure.
    fn of(m: usize, mut recorder: Recorder, root: u32) -> Result<Self, BuildError> {
        let graph = Graph::new(&recorder, &[root]);
        let structure = Structure {
            degrees_of_freedom: m,
            separable: separable::is_separable(&graph),
            degree: degree::degree(&graph, 0..2 * m),
            degree_in_q: degree::degree(&graph, 0..m),
            degree_in_p: degree::degree(&graph, m..2 * m),
            hessian: sparsity::hessian_pattern(&graph),
        };
        let compiled_energy = Compiled::new(&graph);
        let energy = Tape::new(&peephole(graph), Blocks::One);
        if Replay::<f64>::new(&energy).has_nan() {
            return Err(BuildError::ConstantNotANumber);
        }
        let bound = Bound::new(recorder.recording(root));
        let slopes = differentiate(&mut recorder, root);
        let laid_out = |roots: &[u32]| {
            let graph = Graph::new(&recorder, roots);
            (Compiled::new(&graph), peephole(graph))
        };
        let (compiled_gradient, gradient) = laid_out(&slopes);
        let forces = structure.separable.then(|| laid_out(&slopes[..m]));
        let (compiled_forces, forces) = forces.unzip();
        Ok(Recorded {
            shared: Arc::new(Shared {
                energy,
                gradient: Tape::new(&gradient, Blocks::One),
                gradients: Tape::new(&gradient, Blocks::InCache),
                forces: forces.map(|graph| Tape::new(&graph, Blocks::InCache)),
                bound,
                compiled: AsCode {
                    energy: compiled_energy,
                    gradient: compiled_gradient,
                    forces: compiled_forces.flatten(),
                },
                plan: HessianPlan::new(&structure.hessian),
                structure,
            }),
        })
    }

    pub(crate) fn colours(&self) -> usize {
        self.shared.plan.colours
    }

    pub(crate) fn operations(&self) -> usize {
        self.shared.energy.operations()
    }

    /// Whether H has a sum that is worth compensating.
    #[inline]
    pub(crate) fn has_long_sums(&self) -> bool {
        self.shared.energy.has_long_sums
    }

    pub(crate) fn gradient_operations(&self) -> usize {
        self.shared.gradient.operations()
    }
}

impl System for Recorded {
    type Evaluator<T: Float> = RecordedEvaluator<T>;

    fn structure(&self) -> &Structure {
        &self.shared.structure
    }

    fn evaluator<T: Float>(&self) -> RecordedEvaluator<T> {
        (ready::<T>().evaluator)(self)
    }
}

/// Evaluates a recorded energy in the float type `T`. All workspace is allocated when it is made, or at the
/// first call of a kind.
#[derive(Debug, Clone)]
pub struct RecordedEvaluator<T: Float> {
    shared: Arc<Shared>,
    set: InstructionSet,
    energy: Replay<T>,
    energy_as_code: Runs,
    gradient: Replay<T>,
    single: Replay<Tangent<T, 1>>,
    several: Replay<Tangent<T, DIRECTIONS>>,
    gradients: Many<T>,
    /// Of a separable H.
    forces: Option<Many<T>>,
    /// Made at the first call.
    bound: Option<BoundRuns<T>>,
}

impl<T: Float> RecordedEvaluator<T> {
    pub(crate) fn new(of: &Recorded) -> Self {
        let shared = Arc::clone(&of.shared);
        let (compiled, set) = (&shared.compiled, InstructionSet::best());
        let forces = shared.forces.as_ref();
        RecordedEvaluator {
            set,
            energy: Replay::new(&shared.energy),
            energy_as_code: Runs::new::<T>(&compiled.energy),
            gradient: Replay::new(&shared.gradient),
            single: Replay::tangents(&shared.gradient),
            several: Replay::tangents(&shared.gradient),
            gradients: Many::new(&compiled.gradient, set, &shared.gradients),
            forces: forces.map(|tape| Many::new(&compiled.forces, set, tape)),
            bound: None,
            shared,
        }
    }

    fn check(&self, lengths: &[usize]) {
        let n = 2 * self.shared.structure.degrees_of_freedom;
        assert!(
            lengths.iter().all(|&l| l == n),
            "a state of this system has {n} components"
        );
    }

    pub(crate) fn value_at(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let mut value = [T::int(0)];
        let batch = Batch::one(y, &mut value);
        if self.energy_as_code.run(self.set, batch).is_some() {
            return value[0];
        }
        let tape = &self.shared.energy;
        self.energy.run(tape, |k| y[k])[0]
    }

    pub(crate) fn compensated_value_at(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let tape = &self.shared.energy;
        if tape.has_long_sums {
            self.energy.run_compensated(self.set, tape, |k| y[k])[0]
        } else {
            self.value_at(y)
        }
    }

    pub(crate) fn gradient_with_bound_at(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        self.check(&[y.len(), gradient.len()]);
        let bound = &self.shared.bound;
        let runs = (self.bound).get_or_insert_with(|| BoundRuns::new(bound, y.len()));
        let (slopes, size, h) = runs.run(self.set, bound, y);
        gradient.copy_from_slice(slopes);
        match self.shared.energy.has_long_sums {
            true => (self.compensated_value_at(y), size),
            false => (h, size),
        }
    }

    pub(crate) fn bound_at(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let bound = &self.shared.bound;
        let runs = (self.bound).get_or_insert_with(|| BoundRuns::new(bound, y.len()));
        runs.run(self.set, bound, y).1
    }

    pub(crate) fn gradients_at(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        self.check(&[n]);
        let tape = &self.shared.gradient;
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            let batch = Batch::one(y, gradient);
            if self.gradients.run_code(self.set, batch).is_none() {
                gradient.copy_from_slice(self.gradient.run(tape, |k| y[k]));
            }
        }
    }

    pub(crate) fn gradients_of(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let n = 2 * self.shared.structure.degrees_of_freedom;
        check_batch(n, [states.len(), gradients.len()], stride, count);
        let batch = Batch {
            states,
            gradients,
            stride,
            count,
        };
        self.gradients.run(self.set, &self.shared.gradients, batch);
    }

    pub(crate) fn forces_of(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let Shared {
            structure, forces, ..
        } = &*self.shared;
        require_separable(structure);
        let m = structure.degrees_of_freedom;
        check_batch(m, [positions.len(), gradients.len()], stride, count);
        let batch = Batch {
            states: positions,
            gradients,
            stride,
            count,
        };
        if let (Some(tape), Some(many)) = (forces, &mut self.forces) {
            many.run(self.set, tape, batch);
        }
    }

    pub(crate) fn kinetic_energy(&mut self) -> Option<Kinetic<T>> {
        let shared = Arc::clone(&self.shared);
        Kinetic::new(&shared.structure, self)
    }

    pub(crate) fn hessian_times(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.check(&[y.len(), v.len(), product.len()]);
        let tape = &self.shared.gradient;
        let rows = self.single.run(tape, |k| Tangent {
            value: y[k],
            rates: [v[k]],
        });
        for (entry, row) in product.iter_mut().zip(rows) {
            [*entry] = row.rates;
        }
    }

    pub(crate) fn hessian_at(&mut self, y: &[T], entries: &mut [T]) {
        self.check(&[y.len()]);
        let Shared {
            gradient: tape,
            plan,
            structure,
            ..
        } = &*self.shared;
        assert_eq!(
            entries.len(),
            structure.hessian.len(),
            "one place per entry of the pattern"
        );
        for (sweep, pickups) in plan.sweeps().enumerate() {
            let rows = self.several.run(tape, |k| {
                let mut input = Tangent::fixed(y[k]);
                if let Some(colour) = plan.of_column[k]
                    && colour / DIRECTIONS == sweep
                {
                    input.rates[colour % DIRECTIONS] = T::int(1);
                }
                input
            });
            for pickup in pickups {
                let row = rows[pickup.row as usize];
                entries[pickup.entry as usize] = row.rates[pickup.direction as usize];
            }
        }
    }
}

impl<T: Float> RecordedEvaluator<T> {
    /// The second number of [`gradient_with_bound`](Evaluate::gradient_with_bound).
    pub(crate) fn bound(&mut self, y: &[T]) -> T {
        (ready::<T>().bound)(self, y)
    }
}

// All but what is woven into sweeps is compiled with this crate: `crate::ready`.
impl<T: Float> Evaluate<T> for RecordedEvaluator<T> {
    const IS_RECORDED: bool = true;

    fn recorded<'a, H: Holds<'a>>(held: H::With<Self>) -> H::With<Self> {
        held
    }

    fn value(&mut self, y: &[T]) -> T {
        (ready::<T>().value)(self, y)
    }

    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.value(y)
    }

    fn compensated_value(&mut self, y: &[T]) -> T {
        (ready::<T>().compensated_value)(self, y)
    }

    fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.compensated_value(y)
    }

    fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        (ready::<T>().gradient_with_bound)(self, y, gradient)
    }

    fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        (ready::<T>().gradients)(self, states, gradients, n);
    }

    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        (ready::<T>().gradients_by_component)(self, states, gradients, stride, count);
    }

    fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        (ready::<T>().forces_by_component)(self, positions, gradients, stride, count);
    }

    #[inline]
    fn fuse_gradients<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let n = 2 * self.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let slopes = self.gradients.called(self.set, stride)?;
        fuse!(self.set, n, slopes, task, [2 4])
    }

    #[inline]
    fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let m = self.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let slopes = self.forces.as_mut()?.called(self.set, stride)?;
        fuse!(self.set, m, slopes, task, [1 2 3 4])
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        (ready::<T>().kinetic)(self)
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        self.set = set;
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        (ready::<T>().hessian_vector)(self, y, v, product);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        (ready::<T>().hessian)(self, y, entries);
    }
}
