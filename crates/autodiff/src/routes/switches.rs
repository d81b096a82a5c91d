//! [`Switches`]: where H or a derivative of it jumps, as functions of the state.
//!
//! Every piecewise operation of a recording has a function g(q, p) whose sign says which piece is taken. They
//! are recorded behind H, all in one recording, so that what they share is computed once.

use super::one::One;
use super::results::Results;
use crate::recording::graph::Graph;
use crate::recording::op::{Node, Op};
use crate::recording::recorder::{Recorder, Recording};
use equip_scalar::{Float, InstructionSet, Outside};
use std::collections::HashSet;
use std::sync::Arc;

/// What a switch belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SwitchKind {
    /// |x|: g = x. The first derivative jumps.
    Absolute,
    /// The sign of x: g = x. The value jumps.
    Sign,
    /// The smaller or larger of x and y: g = x − y. The first derivative jumps.
    Extremum,
    /// A selection: g is what it is selected by. The value or any derivative may jump.
    Selection,
    /// A rounding to integers: g changes its sign where the result changes. The value jumps.
    Step,
    /// Knots of a table: g changes its sign at each inner knot. The third derivative jumps.
    Knots,
}

/// The functions g(q, p) at whose roots H or a derivative of it jumps; made by
/// [`System::switches`](crate::System::switches).
///
/// One for each argument of |x|, min, max, clamp, signum, select and tables in H, if it depends on the state,
/// equal ones once, in the order of H. Within one sign of all of them H is smooth. Of closures nothing is
/// known.
///
/// ```
/// use equip_autodiff::{Hamiltonian, SwitchKind, System};
/// let wall = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + (q[0] - 1).max(0).powi(2))?;
/// let switches = wall.switches();
/// assert_eq!(switches.kinds(), [SwitchKind::Extremum]);
/// let mut g = [0.0];
/// switches.evaluator().values(&[1.25, 0.0], &mut g);
/// assert_eq!(g, [0.25]);
/// # Ok::<(), equip_autodiff::BuildError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Switches {
    kinds: Vec<SwitchKind>,
    /// None without switches.
    results: Option<Arc<Results>>,
}

impl Switches {
    /// Of an H of which nothing is recorded, or that is smooth.
    pub fn none() -> Self {
        Switches {
            kinds: Vec::new(),
            results: None,
        }
    }

    pub(super) fn of(recording: &Recording) -> Self {
        let mut recorder = recording.resume();
        let found = Found::in_recording(&mut recorder, recording.root);
        let results = || Results::new(Arc::new(Graph::new(&recorder, &found.nodes)));
        Switches {
            results: (!found.nodes.is_empty()).then(|| Arc::new(results())),
            kinds: found.kinds,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// Whether H is smooth as far as is known.
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    /// What each of them belongs to.
    pub fn kinds(&self) -> &[SwitchKind] {
        &self.kinds
    }

    /// An evaluator in float type `T`.
    pub fn evaluator<T: Float>(&self) -> SwitchEvaluator<T> {
        SwitchEvaluator {
            switches: self.clone(),
            values: One::new(),
        }
    }
}

/// Evaluates the switches of an energy in the float type `T`.
#[derive(Debug, Clone)]
pub struct SwitchEvaluator<T> {
    switches: Switches,
    values: One<T>,
}

impl<T: Float> SwitchEvaluator<T> {
    /// g of each switch at the state y = (q, p), into as many places. Allocates at its first call only.
    ///
    /// # Panics
    /// If there are fewer or more places than switches.
    pub fn values(&mut self, y: &[T], g: &mut [T]) {
        let count = self.switches.len();
        assert_eq!(g.len(), count, "one place for each switch");
        if let Some(results) = &self.switches.results {
            let n = results.graph.inputs;
            assert_eq!(y.len(), n, "a state of this system has {n} components");
            self.values.run(InstructionSet::best(), results, y, g);
        }
    }
}

/// Nodes of the functions g.
#[derive(Default)]
struct Found {
    kinds: Vec<SwitchKind>,
    nodes: Vec<u32>,
    seen: HashSet<u32>,
}

impl Found {
    fn in_recording(recorder: &mut Recorder, root: u32) -> Self {
        let mut found = Found::default();
        for node in live(recorder, root) {
            let Node { op, a, b } = recorder.nodes[node as usize];
            match op {
                Op::Abs => found.push(SwitchKind::Absolute, a),
                Op::Sign => found.push(SwitchKind::Sign, a),
                Op::Min | Op::Max => {
                    let g = recorder.apply(Op::Sub, a, b);
                    found.push(SwitchKind::Extremum, g);
                }
                Op::AtMost => {
                    let g = recorder.apply(Op::Sub, b, a);
                    found.push(SwitchKind::Selection, g);
                }
                Op::Outside { function, .. } => {
                    let function = Arc::clone(&recorder.functions[function as usize]);
                    let kind = match function.is_step() {
                        true => SwitchKind::Step,
                        false => SwitchKind::Knots,
                    };
                    for kink in function.kinks() {
                        let kink: Arc<dyn Outside> = kink;
                        let g = recorder.outside(&kink, [0, 0], [a, b]);
                        found.push(kind, g);
                    }
                }
                _ => {}
            }
        }
        found
    }

    fn push(&mut self, kind: SwitchKind, node: u32) {
        if self.seen.insert(node) {
            self.kinds.push(kind);
            self.nodes.push(node);
        }
    }
}

/// Operations that depend on the state and that H depends on, in their order.
fn live(recorder: &Recorder, root: u32) -> Vec<u32> {
    let nodes = &recorder.nodes[..(root as usize + 1).max(recorder.inputs)];
    let operands = |&Node { op, a, b }: &Node| [a, b].into_iter().take(op.arity());
    let mut depends = vec![false; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        let is_input = matches!(node.op, Op::Input(_));
        depends[i] = is_input || operands(node).any(|x| depends[x as usize]);
    }
    let mut reaches = vec![false; nodes.len()];
    reaches[root as usize] = true;
    for (i, node) in nodes.iter().enumerate().rev() {
        if reaches[i] {
            operands(node).for_each(|x| reaches[x as usize] = true);
        }
    }
    let all = 0..nodes.len() as u32;
    all.filter(|&i| depends[i as usize] && reaches[i as usize])
        .collect()
}
