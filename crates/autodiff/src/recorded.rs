//! [`Recorded`]: the closure route. H is recorded once, on a tape, and replayed in any float type.

use crate::graph::Graph;
use crate::hessian::{DIRECTIONS, HessianPlan};
use crate::point::{Points, check_batch, require_separable};
use crate::replay::forward;
use crate::reverse::{Exponent, reverse};
use crate::tangent::Tangent;
use crate::tape::Tape;
use crate::trace::record;
use crate::{BuildError, Evaluate, Kinetic, Structure, System, Var, degree, separable, sparsity};
use equip_scalar::{Constant, Float, InstructionSet, Piecewise};
use std::sync::Arc;

/// An energy recorded from a closure; made by [`Hamiltonian::new`](crate::Hamiltonian::new).
#[derive(Debug, Clone)]
pub struct Recorded {
    shared: Arc<Shared>,
}

/// What evaluators in all float types share.
#[derive(Debug)]
struct Shared {
    tape: Tape,
    plan: HessianPlan,
    structure: Structure,
}

impl Recorded {
    pub(crate) fn new(
        m: usize,
        energy: impl FnOnce(&[Var], &[Var]) -> Var,
    ) -> Result<Self, BuildError> {
        let (recorder, root) = record(m, energy)?;
        let graph = Graph::new(&recorder, root);
        let structure = Structure {
            degrees_of_freedom: m,
            separable: separable::is_separable(&graph),
            degree: degree::degree(&graph, 0..2 * m),
            degree_in_q: degree::degree(&graph, 0..m),
            degree_in_p: degree::degree(&graph, m..2 * m),
            hessian: sparsity::hessian_pattern(&graph),
        };
        let plan = HessianPlan::new(&structure.hessian);
        let recorded = Recorded {
            shared: Arc::new(Shared {
                tape: Tape::new(&graph),
                plan,
                structure,
            }),
        };
        let start: Start<f64> = Start::new(&recorded.shared.tape);
        let exponents = recorded.shared.tape.exponents.iter().map(|c| c.to());
        if start
            .values
            .iter()
            .copied()
            .chain(exponents)
            .any(|x: f64| x.is_nan())
        {
            return Err(BuildError::ConstantNotANumber);
        }
        Ok(recorded)
    }

    pub(crate) fn colours(&self) -> usize {
        self.shared.plan.colours
    }

    pub(crate) fn operations(&self) -> usize {
        self.shared.tape.operations()
    }
}

impl System for Recorded {
    type Evaluator<T: Float> = RecordedEvaluator<T>;

    fn structure(&self) -> &Structure {
        &self.shared.structure
    }

    fn evaluator<T: Float>(&self) -> RecordedEvaluator<T> {
        let shared = Arc::clone(&self.shared);
        let Start { values, exponents } = Start::new(&shared.tape);
        let slots = shared.tape.slots;
        RecordedEvaluator {
            points: Points::new(shared.tape.inputs.len()),
            plain: Sweep::new(slots, values.iter().copied(), T::int(0)),
            single: Sweep::new(
                slots,
                values.iter().map(|&x| Tangent::fixed(x)),
                Tangent::fixed(T::int(0)),
            ),
            several: Sweep::new(
                slots,
                values.iter().map(|&x| Tangent::fixed(x)),
                Tangent::fixed(T::int(0)),
            ),
            exponents: exponents.iter().map(|e| e.c).collect(),
            steps: exponents,
            shared,
        }
    }
}

/// Constants of a tape in one float type: everything that does not depend on the state.
struct Start<T> {
    values: Vec<T>,
    exponents: Vec<Exponent>,
}

impl<T: Float> Start<T> {
    fn new(tape: &Tape) -> Self {
        let exponents: Vec<Exponent> = tape
            .exponents
            .iter()
            .map(|c| {
                let c: T = c.to();
                Exponent {
                    c: resolved(c),
                    less_one: resolved(c - T::int(1)),
                    is_zero: c == T::int(0),
                }
            })
            .collect();
        let plain: Vec<Constant> = exponents.iter().map(|e| e.c).collect();
        let mut values: Vec<T> = tape.constants.iter().map(|c| c.to()).collect();
        values.resize(tape.inputs.start, T::int(0));
        forward(tape, &tape.constant_runs, &plain, &mut values);
        Start { values, exponents }
    }
}

/// The number as the constant that is cheapest to read.
fn resolved<T: Float>(x: T) -> Constant {
    match x.expansion() {
        [head, 0.0, 0.0, 0.0] => Constant::Double(head),
        parts => Constant::Extended(parts),
    }
}

/// Values and adjoints of all slots.
#[derive(Debug, Clone)]
struct Sweep<S> {
    values: Vec<S>,
    adjoints: Vec<S>,
}

impl<S: Piecewise> Sweep<S> {
    fn new(slots: usize, constants: impl Iterator<Item = S>, zero: S) -> Self {
        let mut values = vec![zero; slots];
        values
            .iter_mut()
            .zip(constants)
            .for_each(|(value, constant)| *value = constant);
        Sweep {
            values,
            adjoints: vec![zero; slots],
        }
    }

    fn forward(
        &mut self,
        tape: &Tape,
        exponents: &[Constant],
        inputs: impl Iterator<Item = S>,
    ) -> S {
        let slots = &mut self.values[tape.inputs.clone()];
        slots
            .iter_mut()
            .zip(inputs)
            .for_each(|(slot, input)| *slot = input);
        forward(tape, &tape.runs, exponents, &mut self.values);
        self.values[tape.root]
    }

    fn reverse(&mut self, tape: &Tape, exponents: &[Exponent]) -> &[S] {
        reverse(tape, exponents, &self.values, &mut self.adjoints);
        &self.adjoints[tape.inputs.clone()]
    }
}

/// Replays a recorded energy in the float type `T`. All workspace is allocated when it is made.
#[derive(Debug, Clone)]
pub struct RecordedEvaluator<T: Float> {
    shared: Arc<Shared>,
    exponents: Vec<Constant>,
    steps: Vec<Exponent>,
    points: Points<T>,
    plain: Sweep<T>,
    single: Sweep<Tangent<T, 1>>,
    several: Sweep<Tangent<T, DIRECTIONS>>,
}

impl<T: Float> RecordedEvaluator<T> {
    fn check(&self, lengths: &[usize]) {
        let n = self.shared.tape.inputs.len();
        assert!(
            lengths.iter().all(|&l| l == n),
            "a state of this system has {n} components"
        );
    }
}

impl<T: Float> Evaluate<T> for RecordedEvaluator<T> {
    fn value(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        self.plain
            .forward(&self.shared.tape, &self.exponents, y.iter().copied())
    }

    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.check(&[y.len(), gradient.len()]);
        let h = self
            .plain
            .forward(&self.shared.tape, &self.exponents, y.iter().copied());
        gradient.copy_from_slice(self.plain.reverse(&self.shared.tape, &self.steps));
        h
    }

    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let n = 2 * self.shared.structure.degrees_of_freedom;
        check_batch(n, [states.len(), gradients.len()], stride, count);
        let mut points = std::mem::take(&mut self.points);
        points.each(states, gradients, stride, count, |y, gradient| {
            self.gradient(y, gradient);
        });
        self.points = points;
    }

    fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let structure = &self.shared.structure;
        require_separable(structure);
        check_batch(
            structure.degrees_of_freedom,
            [positions.len(), gradients.len()],
            stride,
            count,
        );
        let mut points = std::mem::take(&mut self.points);
        points.each(positions, gradients, stride, count, |y, gradient| {
            self.gradient(y, gradient);
        });
        self.points = points;
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        let shared = Arc::clone(&self.shared);
        Kinetic::new(&shared.structure, self)
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        assert!(
            set.is_available(),
            "this processor has no {set:?} instructions"
        );
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.check(&[y.len(), v.len(), product.len()]);
        let inputs = y.iter().zip(v).map(|(&value, &rate)| Tangent {
            value,
            rates: [rate],
        });
        self.single
            .forward(&self.shared.tape, &self.exponents, inputs);
        let adjoints = self.single.reverse(&self.shared.tape, &self.steps);
        product
            .iter_mut()
            .zip(adjoints)
            .for_each(|(entry, adjoint)| *entry = adjoint.rates[0]);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        self.check(&[y.len()]);
        let Shared {
            tape,
            plan,
            structure,
        } = &*self.shared;
        assert_eq!(
            entries.len(),
            structure.hessian.len(),
            "one place per entry of the pattern"
        );
        for (sweep, pickups) in plan.sweeps().enumerate() {
            let inputs = y.iter().zip(&plan.of_column).map(|(&value, colour)| {
                let mut input = Tangent::fixed(value);
                if let Some(colour) = colour
                    && colour / DIRECTIONS == sweep
                {
                    input.rates[colour % DIRECTIONS] = T::int(1);
                }
                input
            });
            self.several.forward(tape, &self.exponents, inputs);
            let adjoints = self.several.reverse(tape, &self.steps);
            for pickup in pickups {
                entries[pickup.entry as usize] =
                    adjoints[pickup.row as usize].rates[pickup.direction as usize];
            }
        }
    }
}
