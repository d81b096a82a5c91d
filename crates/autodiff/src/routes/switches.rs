//! [`Switches`]: where H or a derivative of it jumps, as functions of the state.
//!
//! Every piecewise operation of a recording has a function g(q, p) whose sign says which piece is taken. They
//! are recorded behind H, all in one recording, so that what they share is computed once. So are the
//! arguments of functions that have a domain ([`Domains`]).

use super::one::One;
use super::results::Results;
use crate::hamiltonian::{Energy, Hamiltonian};
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
/// [`Hamiltonian::switches`](crate::Hamiltonian::switches).
///
/// One for each argument of |x|, min, max, clamp, signum, select and tables in H, if it depends on the state,
/// equal ones once, in the order of H. Within one sign of all of them H is smooth. Of closures nothing is
/// known.
///
/// ```
/// use equip_autodiff::{Hamiltonian, SwitchKind};
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
    bends: Vec<bool>,
    domains: Domains,
    /// None without switches.
    results: Option<Arc<Results>>,
}

impl Hamiltonian {
    /// Where H or a derivative of it jumps, as far as that is known. Computed anew at each call, in time and
    /// memory in proportion to the operations of H.
    pub fn switches(&self) -> Switches {
        match &self.energy {
            Energy::Traced(traced) => Switches::of(traced.recording()),
            Energy::External(_) => Switches::none(),
        }
    }
}

impl Switches {
    /// Of an H of which nothing is recorded, or that is smooth.
    pub fn none() -> Self {
        Switches {
            kinds: Vec::new(),
            bends: Vec::new(),
            domains: Domains::none(),
            results: None,
        }
    }

    fn of(recording: &Recording) -> Self {
        let mut recorder = recording.resume();
        let found = Found::in_recording(&mut recorder, recording.root);
        let results = || Results::new(Arc::new(Graph::new(&recorder, &found.nodes)));
        Switches {
            results: (!found.nodes.is_empty()).then(|| Arc::new(results())),
            kinds: found.kinds,
            bends: found.bends,
            domains: Domains::of(recording),
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

    /// Whether the function of each of them bends or jumps itself, at roots of others, as that of the maximum
    /// in max(1 − |x|, 0) does at x = 0.
    pub fn bends(&self) -> &[bool] {
        &self.bends
    }

    /// The arguments of functions of H that have a domain, as tables that do not extrapolate.
    pub fn domains(&self) -> &Domains {
        &self.domains
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
    bends: Vec<bool>,
    nodes: Vec<u32>,
    seen: HashSet<u32>,
}

impl Found {
    fn in_recording(recorder: &mut Recorder, root: u32) -> Self {
        let mut found = Found::default();
        let bent = bent(recorder, root);
        for node in live(recorder, root) {
            let Node { op, a, b } = recorder.nodes[node as usize];
            let mut operands = [a, b].into_iter().take(op.arity());
            let bends = operands.any(|x| bent[x as usize]);
            match op {
                Op::Abs => found.push(SwitchKind::Absolute, a, bends),
                Op::Sign => found.push(SwitchKind::Sign, a, bends),
                Op::Min | Op::Max => {
                    let g = recorder.apply(Op::Sub, a, b);
                    found.push(SwitchKind::Extremum, g, bends);
                }
                Op::AtMost => {
                    let g = recorder.apply(Op::Sub, b, a);
                    found.push(SwitchKind::Selection, g, bends);
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
                        found.push(kind, g, bends);
                    }
                }
                _ => {}
            }
        }
        found
    }

    fn push(&mut self, kind: SwitchKind, node: u32, bends: bool) {
        if self.seen.insert(node) {
            self.kinds.push(kind);
            self.bends.push(bends);
            self.nodes.push(node);
        }
    }
}

/// Of each operation up to `root` whether it, or one that it depends on, is piecewise. Tables are smooth
/// enough not to be.
fn bent(recorder: &Recorder, root: u32) -> Vec<bool> {
    let nodes = &recorder.nodes[..(root as usize + 1).max(recorder.inputs)];
    let mut bent = vec![false; nodes.len()];
    for (i, &Node { op, a, b }) in nodes.iter().enumerate() {
        let is_piecewise = matches!(op, Op::Abs | Op::Sign | Op::Min | Op::Max | Op::AtMost);
        let mut operands = [a, b].into_iter().take(op.arity());
        bent[i] = is_piecewise || operands.any(|x| bent[x as usize]);
    }
    bent
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

// Where H has data: a table that does not extrapolate has values between its first and its last knot only.
// Beyond, its formula has numbers, but they mean nothing.

/// An argument of a function of H that is not within its domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsideDomain<T> {
    /// The argument.
    pub argument: T,
    /// The domain.
    pub first: T,
    /// The domain.
    pub last: T,
}

/// The arguments of functions of H that have a domain, as tables that do not extrapolate; made by
/// [`Switches::domains`].
#[derive(Debug, Clone)]
pub struct Domains {
    /// First and last argument.
    ranges: Vec<[f64; 2]>,
    /// None without such functions.
    results: Option<Arc<Results>>,
}

impl Domains {
    fn none() -> Self {
        Domains {
            ranges: Vec::new(),
            results: None,
        }
    }

    fn of(recording: &Recording) -> Self {
        let recorder = recording.resume();
        let (mut nodes, mut ranges): (Vec<u32>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
        for node in live(&recorder, recording.root) {
            let Node { op, a, b } = recorder.nodes[node as usize];
            let Op::Outside { function, .. } = op else {
                continue;
            };
            let function = &recorder.functions[function as usize];
            for (axis, argument) in [a, b].into_iter().enumerate().take(function.variables()) {
                let Some(range) = function.domain(axis) else {
                    continue;
                };
                let known = nodes.iter().zip(&ranges);
                if !known.into_iter().any(|known| known == (&argument, &range)) {
                    nodes.push(argument);
                    ranges.push(range);
                }
            }
        }
        let results = || Results::new(Arc::new(Graph::new(&recorder, &nodes)));
        Domains {
            results: (!nodes.is_empty()).then(|| Arc::new(results())),
            ranges,
        }
    }

    /// Whether H has values everywhere as far as is known.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// An evaluator in float type `T`.
    pub fn evaluator<T: Float>(&self) -> DomainEvaluator<T> {
        DomainEvaluator {
            domains: self.clone(),
            values: One::new(),
            arguments: vec![T::int(0); self.ranges.len()],
        }
    }
}

/// Tells in the float type `T` whether states are within the domains of an energy.
#[derive(Debug, Clone)]
pub struct DomainEvaluator<T> {
    domains: Domains,
    values: One<T>,
    arguments: Vec<T>,
}

impl<T: Float> DomainEvaluator<T> {
    /// Whether all arguments are within their domains at the state y = (q, p). Allocates at its first call
    /// only.
    ///
    /// # Errors
    /// The first argument that is not.
    pub fn check(&mut self, y: &[T]) -> Result<(), OutsideDomain<T>> {
        let Some(results) = &self.domains.results else {
            return Ok(());
        };
        let set = InstructionSet::best();
        self.values.run(set, results, y, &mut self.arguments);
        for (&argument, range) in self.arguments.iter().zip(&self.domains.ranges) {
            let [first, last] = range.map(T::exact);
            if argument < first || argument > last {
                return Err(OutsideDomain {
                    argument,
                    first,
                    last,
                });
            }
        }
        Ok(())
    }
}
