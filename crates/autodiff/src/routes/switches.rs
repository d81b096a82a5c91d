//! [`Switches`]: the discontinuities of H or of its derivatives, as functions of the state.
//!
//! Every piecewise operation of a trace has a switching function g(q, p) whose sign selects the piece. All
//! switching functions are appended to one trace of H, so that common subexpressions are computed once. The
//! arguments of functions with a domain are traced in the same way ([`Domains`]).

use super::many::One;
use super::results::Results;
use crate::hamiltonian::{Energy, Hamiltonian};
use crate::recording::graph::Graph;
use crate::recording::op::{Node, Op};
use crate::recording::recorder::{Recorder, Recording};
use equip_scalar::{Float, InstructionSet, Outside};
use std::collections::HashSet;
use std::sync::Arc;

/// The kind of operation to which a switch belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SwitchKind {
    /// |x|: g = x. The first derivative jumps.
    Absolute,
    /// The sign of x: g = x. The value jumps.
    Sign,
    /// The smaller or larger of x and y: g = x − y. The first derivative jumps.
    Extremum,
    /// A selection: g is its test. The value or any derivative may jump.
    Selection,
    /// Rounding to integers: g changes sign where the result changes. The value jumps.
    Step,
    /// Knots of a table: g changes sign at each inner knot. The third derivative jumps.
    Knots,
}

/// The switching functions g(q, p) at whose roots H or a derivative of H jumps, from
/// [`Hamiltonian::switches`](crate::Hamiltonian::switches).
///
/// There is one for each argument of |x|, min, max, clamp, signum, select and tables in H that depends on the
/// state. Equal ones occur once, in the order of H. As long as none changes sign, H is smooth.
/// Discontinuities of closures are not detected.
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
#[derive(Debug, Clone, Default)]
pub struct Switches {
    kinds: Vec<SwitchKind>,
    domains: Domains,
    /// `None` if there are no switches.
    results: Option<Arc<Results>>,
}

impl Hamiltonian {
    /// The switches of H, as far as they are known. They are computed at each call, in time and memory
    /// proportional to the operations of H.
    pub fn switches(&self) -> Switches {
        match &self.energy {
            Energy::Traced(traced) => Switches::of(traced.recording()),
            Energy::External(_) => Switches::none(),
        }
    }
}

impl Switches {
    /// For an H without a trace, or a smooth H.
    pub fn none() -> Self {
        Switches::default()
    }

    fn of(recording: &Recording) -> Self {
        let mut recorder = recording.resume();
        let found = Found::in_recording(&mut recorder, recording.root);
        let results = || Results::new(Arc::new(Graph::new(&recorder, &found.nodes)));
        Switches {
            results: (!found.nodes.is_empty()).then(|| Arc::new(results())),
            kinds: found.kinds,
            domains: Domains::of(recording),
        }
    }

    /// The number of switches.
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// Whether H is smooth, as far as is known.
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    /// The kind of each switch.
    pub fn kinds(&self) -> &[SwitchKind] {
        &self.kinds
    }

    /// The arguments of functions of H that have a domain, such as tables that do not extrapolate.
    pub fn domains(&self) -> &Domains {
        &self.domains
    }

    /// An evaluator in floating-point type `T`.
    pub fn evaluator<T: Float>(&self) -> SwitchEvaluator<T> {
        SwitchEvaluator {
            switches: self.clone(),
            values: One::new(),
        }
    }
}

/// Evaluates the switches of an energy in the floating-point type `T`.
#[derive(Debug, Clone)]
pub struct SwitchEvaluator<T> {
    switches: Switches,
    values: One<T>,
}

impl<T: Float> SwitchEvaluator<T> {
    /// Writes g of each switch at the state y = (q, p) to `g`. Allocates at its first call only.
    ///
    /// # Panics
    /// If the length of `g` is not the number of switches.
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

/// The nodes of the functions g.
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

/// The operations that depend on the state and on which H depends, in order.
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

// The domain of H: a table that does not extrapolate is defined between its first and its last knot only.
// Beyond them its formula has values, but they are meaningless.

/// An argument of a function of H outside its domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsideDomain<T> {
    /// The argument.
    pub argument: T,
    /// The lower end of the domain.
    pub first: T,
    /// The upper end of the domain.
    pub last: T,
}

/// An argument outside its domain by at most this many roundings of the largest end counts as at the end:
/// roots of events at the end of a table are located to rounding. // ε; 720 falls to the end of a table are
/// off by up to 6.4
const ROUNDINGS: i64 = 64;

/// The arguments of functions of H that have a domain, such as tables that do not extrapolate, from
/// [`Switches::domains`].
#[derive(Debug, Clone, Default)]
pub struct Domains {
    /// The first and the last argument.
    ranges: Vec<[f64; 2]>,
    /// `None` if there are no such functions.
    results: Option<Arc<Results>>,
}

impl Domains {
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

    /// Whether H is defined everywhere, as far as is known.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// An evaluator in floating-point type `T`.
    pub fn evaluator<T: Float>(&self) -> DomainEvaluator<T> {
        DomainEvaluator {
            domains: self.clone(),
            values: One::new(),
            arguments: vec![T::int(0); self.ranges.len()],
        }
    }
}

/// Checks in the floating-point type `T` whether states are within the domains of an energy.
#[derive(Debug, Clone)]
pub struct DomainEvaluator<T> {
    domains: Domains,
    values: One<T>,
    arguments: Vec<T>,
}

impl<T: Float> DomainEvaluator<T> {
    /// Checks that all arguments are within their domains, up to rounding, at the state y = (q, p). Allocates
    /// at its first call only.
    ///
    /// # Errors
    /// The first argument outside its domain.
    pub fn check(&mut self, y: &[T]) -> Result<(), OutsideDomain<T>> {
        let Some(results) = &self.domains.results else {
            return Ok(());
        };
        let set = InstructionSet::best();
        self.values.run(set, results, y, &mut self.arguments);
        for (&argument, range) in self.arguments.iter().zip(&self.domains.ranges) {
            let [first, last] = range.map(T::exact);
            let rounding = T::int(ROUNDINGS) * T::EPSILON * first.abs().max(last.abs());
            if argument < first - rounding || argument > last + rounding {
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
