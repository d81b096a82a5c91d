//! [`Recorded`]: the closure route. H is recorded once, and replayed in any float type. What is derived from the
//! recording is made when it is first asked for.

use crate::batch::Batch;
use crate::bound::with_bound;
use crate::derivative::differentiate;
use crate::fused::{Fused, Joined, fuse};
use crate::graph::Graph;
use crate::hessian::{DIRECTIONS, HessianPlan};
use crate::many::Many;
use crate::one::One;
use crate::order::Blocks;
use crate::point::{check_batch, require_separable};
use crate::ready::ready;
use crate::recorder::Recording;
use crate::results::Results;
use crate::structure::HessianPattern;
use crate::system::Holds;
use crate::tangent::Tangent;
use crate::tape::{LONG, Tape};
use crate::trace::record;
use crate::values::Replay;
use crate::{BuildError, Evaluate, Kinetic, Structure, System, Var, degree, separable};
use equip_scalar::{Float, InstructionSet};
use std::sync::{Arc, OnceLock};

/// An energy recorded from a closure; made by [`Hamiltonian::new`](crate::Hamiltonian::new).
#[derive(Debug, Clone)]
pub struct Recorded {
    shared: Arc<Shared>,
}

/// What evaluators in all float types share.
#[derive(Debug)]
struct Shared {
    recording: Recording,
    energy: Results,
    /// H has a sum that is worth compensating.
    has_long_sums: bool,
    slopes: OnceLock<Slopes>,
    with_bound: OnceLock<Results>,
    plan: OnceLock<HessianPlan>,
    structure: Structure,
}

/// The derivatives of H.
#[derive(Debug)]
struct Slopes {
    /// All n components of ∇H.
    gradient: Results,
    /// ∇U, if H = T(p) + U(q).
    forces: Option<Results>,
}

impl Shared {
    fn slopes(&self) -> &Slopes {
        self.slopes.get_or_init(|| {
            let Structure {
                separable,
                degrees_of_freedom: m,
                ..
            } = self.structure;
            let mut recorder = self.recording.resume();
            let slopes = differentiate(&mut recorder, self.recording.root);
            let results = |roots: &[u32]| Results::new(Arc::new(Graph::new(&recorder, roots)));
            Slopes {
                gradient: results(&slopes),
                forces: separable.then(|| results(&slopes[..m])),
            }
        })
    }

    fn gradient(&self) -> &Results {
        &self.slopes().gradient
    }

    /// ∇H, the bound of rounding and H.
    fn with_bound(&self) -> &Results {
        self.with_bound.get_or_init(|| with_bound(&self.recording))
    }

    fn plan(&self) -> &HessianPlan {
        (self.plan).get_or_init(|| HessianPlan::new(&self.structure.hessian))
    }
}

impl Recorded {
    pub(crate) fn new(
        m: usize,
        energy: impl FnOnce(&[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        Recorded::of(m, record(m, energy)?)
    }

    /// Compiled once, and not for every closure.
    fn of(m: usize, recording: Recording) -> Result<Self, BuildError> {
        let graph = Arc::new(Graph::new(&recording.operations, &[recording.root]));
        check_constants(&graph)?;
        Ok(Recorded {
            shared: Arc::new(Shared {
                recording,
                has_long_sums: graph.has_sum_of(LONG),
                structure: Structure {
                    degrees_of_freedom: m,
                    separable: separable::is_separable(&graph),
                    degree: degree::degree(&graph, 0..2 * m),
                    degree_in_q: degree::degree(&graph, 0..m),
                    degree_in_p: degree::degree(&graph, m..2 * m),
                    hessian: HessianPattern::new(Arc::clone(&graph)),
                },
                energy: Results::new(graph),
                slopes: OnceLock::new(),
                with_bound: OnceLock::new(),
                plan: OnceLock::new(),
            }),
        })
    }

    pub(crate) fn colours(&self) -> usize {
        self.shared.plan().colours
    }

    pub(crate) fn operations(&self) -> usize {
        self.shared.energy.one().operations()
    }

    /// Whether H has a sum that is worth compensating.
    #[inline]
    pub(crate) fn has_long_sums(&self) -> bool {
        self.shared.has_long_sums
    }

    pub(crate) fn gradient_operations(&self) -> usize {
        self.shared.gradient().one().operations()
    }
}

/// Refuses constants, and what is computed of them alone, that are NaN or infinite.
fn check_constants(graph: &Graph) -> Result<(), BuildError> {
    let (constants, _) = graph.constants_only();
    let tape = Tape::new(&constants, Blocks::One);
    let numbers = Replay::<f64>::new(&tape);
    let exponents = graph
        .nodes
        .iter()
        .filter_map(|node| graph.exponent(node.op));
    let exponents = exponents.map(|c| c.to::<f64>());
    let mut all = numbers.values.iter().copied().chain(exponents);
    let mut found = Ok(());
    if let Some(x) = all.find(|x| !x.is_finite()) {
        found = Err(if x.is_nan() || all.any(f64::is_nan) {
            BuildError::ConstantNotANumber
        } else {
            BuildError::ConstantInfinite
        });
    }
    found
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

/// Evaluates a recorded energy in the float type `T`. Workspace is allocated at the first call of a kind.
#[derive(Debug, Clone)]
pub struct RecordedEvaluator<T: Float> {
    shared: Arc<Shared>,
    set: InstructionSet,
    energy: One<T>,
    gradient: One<T>,
    with_bound: One<T>,
    /// ∇H, the bound and H.
    bounded: Vec<T>,
    single: Option<Replay<Tangent<T, 1>>>,
    several: Option<Replay<Tangent<T, DIRECTIONS>>>,
    gradients: Many<T>,
    /// Of a separable H.
    forces: Many<T>,
}

impl<T: Float> RecordedEvaluator<T> {
    pub(crate) fn new(of: &Recorded) -> Self {
        RecordedEvaluator {
            shared: Arc::clone(&of.shared),
            set: InstructionSet::best(),
            energy: One::new(),
            gradient: One::new(),
            with_bound: One::new(),
            bounded: Vec::new(),
            single: None,
            several: None,
            gradients: Many::new(),
            forces: Many::new(),
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
            self.gradient.run(self.set, of, y, gradient);
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
        (self.gradients).run(self.set, self.shared.gradient(), batch);
    }

    pub(crate) fn forces_of(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let structure = &self.shared.structure;
        require_separable(structure);
        let m = structure.degrees_of_freedom;
        check_batch(m, [positions.len(), gradients.len()], stride, count);
        let batch = Batch {
            states: positions,
            gradients,
            stride,
            count,
        };
        if let Some(of) = &self.shared.slopes().forces {
            self.forces.run(self.set, of, batch);
        }
    }

    pub(crate) fn kinetic_energy(&mut self) -> Option<Kinetic<T>> {
        let shared = Arc::clone(&self.shared);
        Kinetic::new(&shared.structure, self)
    }

    pub(crate) fn hessian_times(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.check(&[y.len(), v.len(), product.len()]);
        let tape = self.shared.gradient().one();
        let single = (self.single).get_or_insert_with(|| Replay::tangents(tape));
        let rows = single.run(tape, |k| Tangent {
            value: y[k],
            rates: [v[k]],
        });
        for (entry, row) in product.iter_mut().zip(rows) {
            [*entry] = row.rates;
        }
    }

    pub(crate) fn hessian_at(&mut self, y: &[T], entries: &mut [T]) {
        self.check(&[y.len()]);
        let (plan, structure) = (self.shared.plan(), &self.shared.structure);
        let tape = self.shared.gradient().one();
        let several = (self.several).get_or_insert_with(|| Replay::tangents(tape));
        assert_eq!(
            entries.len(),
            structure.hessian.len(),
            "one place per entry of the pattern"
        );
        for (sweep, pickups) in plan.sweeps().enumerate() {
            let rows = several.run(tape, |k| {
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
        let slopes = (self.gradients).called(self.set, self.shared.gradient(), stride)?;
        fuse!(self.set, n, slopes, task, [2 4])
    }

    #[inline]
    fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let m = self.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let of = self.shared.slopes().forces.as_ref()?;
        let slopes = self.forces.called(self.set, of, stride)?;
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
