//! [`Recorded`]: the closure route. H is recorded once, on a tape, and replayed in any float type.

use crate::batch::Batch;
use crate::derivative::differentiate;
use crate::graph::Graph;
use crate::hessian::{DIRECTIONS, HessianPlan};
use crate::in_lanes::InLanes;
use crate::order::Blocks;
use crate::peephole::peephole;
use crate::point::{check_batch, require_separable};
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
    /// The same for lanes.
    gradient_in_lanes: Tape,
    /// ∇U, if H = T(p) + U(q).
    forces: Option<Tape>,
    plan: HessianPlan,
    structure: Structure,
}

impl Recorded {
    pub(crate) fn new(
        m: usize,
        energy: impl FnOnce(&[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        let (mut recorder, root) = record(m, energy)?;
        let graph = Graph::new(&recorder, &[root]);
        let structure = Structure {
            degrees_of_freedom: m,
            separable: separable::is_separable(&graph),
            degree: degree::degree(&graph, 0..2 * m),
            degree_in_q: degree::degree(&graph, 0..m),
            degree_in_p: degree::degree(&graph, m..2 * m),
            hessian: sparsity::hessian_pattern(&graph),
        };
        let energy = Tape::new(&peephole(graph), Blocks::One);
        if Replay::<f64>::new(&energy).has_nan() {
            return Err(BuildError::ConstantNotANumber);
        }
        let slopes = differentiate(&mut recorder, root);
        let tape =
            |roots: &[u32], blocks| Tape::new(&peephole(Graph::new(&recorder, roots)), blocks);
        Ok(Recorded {
            shared: Arc::new(Shared {
                energy,
                gradient: tape(&slopes, Blocks::One),
                gradient_in_lanes: tape(&slopes, Blocks::InCache),
                forces: structure
                    .separable
                    .then(|| tape(&slopes[..m], Blocks::InCache)),
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
        let shared = Arc::clone(&self.shared);
        let forces = shared.forces.as_ref();
        RecordedEvaluator {
            energy: Replay::new(&shared.energy),
            gradient: Replay::new(&shared.gradient),
            forces: forces.map(Replay::new),
            single: Replay::tangents(&shared.gradient),
            several: Replay::tangents(&shared.gradient),
            in_lanes: InLanes::new(&shared.gradient_in_lanes, forces),
            shared,
        }
    }
}

/// Replays a recorded energy in the float type `T`. All workspace is allocated when it is made.
#[derive(Debug, Clone)]
pub struct RecordedEvaluator<T: Float> {
    shared: Arc<Shared>,
    energy: Replay<T>,
    gradient: Replay<T>,
    forces: Option<Replay<T>>,
    single: Replay<Tangent<T, 1>>,
    several: Replay<Tangent<T, DIRECTIONS>>,
    /// If `T` has vectors.
    in_lanes: Option<InLanes<T>>,
}

impl<T: Float> RecordedEvaluator<T> {
    fn check(&self, lengths: &[usize]) {
        let n = 2 * self.shared.structure.degrees_of_freedom;
        assert!(
            lengths.iter().all(|&l| l == n),
            "a state of this system has {n} components"
        );
    }
}

impl<T: Float> Evaluate<T> for RecordedEvaluator<T> {
    fn value(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let tape = &self.shared.energy;
        self.energy.run(tape, |k| y[k])[0]
    }

    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.value(y)
    }

    fn compensated_value(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let tape = &self.shared.energy;
        if tape.has_long_sums {
            self.energy.run_compensated(tape, |k| y[k])[0]
        } else {
            self.energy.run(tape, |k| y[k])[0]
        }
    }

    fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.compensated_value(y)
    }

    fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        self.check(&[n]);
        let tape = &self.shared.gradient;
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            gradient.copy_from_slice(self.gradient.run(tape, |k| y[k]));
        }
    }

    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let Shared {
            structure,
            gradient,
            gradient_in_lanes,
            ..
        } = &*self.shared;
        let n = 2 * structure.degrees_of_freedom;
        check_batch(n, [states.len(), gradients.len()], stride, count);
        let batch = Batch {
            states,
            gradients,
            stride,
            count,
        };
        match &mut self.in_lanes {
            Some(lanes) => lanes.gradients(gradient_in_lanes, batch),
            None => self.gradient.each(gradient, batch),
        }
    }

    fn forces_by_component(
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
        if let (Some(tape), Some(replay)) = (forces, &mut self.forces) {
            match &mut self.in_lanes {
                Some(lanes) => lanes.forces(tape, batch),
                None => replay.each(tape, batch),
            }
        }
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        let shared = Arc::clone(&self.shared);
        Kinetic::new(&shared.structure, self)
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        if let Some(lanes) = &mut self.in_lanes {
            lanes.set_instruction_set(set);
        }
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
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

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
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
