//! [`Graph`]: the computational graph of the trace, without operations that H does not depend on, and with
//! long sums combined.
//!
//! A loop that adds n terms to H traces a chain of n additions, each of which depends on the previous one. If
//! the partial sums are not used elsewhere, the chain becomes one operation with n operands. The order of the
//! additions does not change, so the result agrees bit for bit. There are no n dependent steps, and the
//! analyses of structure remain linear in n.

use crate::recording::op::{Curvature, Node, Op, Operations};
use equip_scalar::{Constant, Outside};
use std::ops::Range;
use std::sync::Arc;

/// The shortest chain of additions that becomes a sum. Shorter chains fit better into runs as pairs of
/// additions.
const SHORTEST_SUM: u32 = 8;

/// One operand of a sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Term {
    pub(crate) node: u32,
    pub(crate) minus: bool,
}

/// Operations, in an order in which operands precede their users.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    pub(crate) inputs: usize,
    pub(crate) nodes: Vec<Node>,
    pub(crate) constants: Vec<Constant>,
    pub(crate) functions: Vec<Arc<dyn Outside>>,
    pub(crate) terms: Vec<Term>,
    /// The range of each sum in `terms`. The first term of a sum is never subtracted.
    pub(crate) sums: Vec<Range<usize>>,
    /// The nodes of the results: H alone, or derivatives.
    pub(crate) roots: Vec<u32>,
    /// Whether a node depends on constants only.
    pub(crate) is_constant: Vec<bool>,
}

impl Graph {
    pub(crate) fn new(recorder: &Operations, roots: &[u32]) -> Self {
        let uses = count_uses(recorder, roots);
        let chains = Chains::new(&recorder.nodes, &uses);
        let mut graph = Graph {
            inputs: recorder.inputs,
            constants: recorder.constants.clone(),
            functions: recorder.functions.clone(),
            ..Graph::default()
        };
        let mut renumbered = vec![0; recorder.nodes.len()];
        for (i, node) in recorder.nodes.iter().enumerate() {
            let is_input = matches!(node.op, Op::Input(_));
            if (uses[i] == 0 && !is_input) || chains.absorbed[i] {
                continue;
            }
            renumbered[i] = graph.nodes.len() as u32;
            if chains.is_sum(i) {
                graph.push_sum(chains.terms(&recorder.nodes, i), &renumbered);
            } else {
                let (a, b) = (renumbered[node.a as usize], renumbered[node.b as usize]);
                graph.push(Node { op: node.op, a, b });
            }
        }
        graph.roots = roots
            .iter()
            .map(|&root| renumbered[root as usize])
            .collect();
        graph
    }

    /// The node of H, if H is the result.
    pub(crate) fn root(&self) -> u32 {
        self.roots[0]
    }

    /// Whether a sum of at least `terms` terms depends on the state.
    pub(crate) fn has_sum_of(&self, terms: usize) -> bool {
        let mut nodes = self.nodes.iter().zip(&self.is_constant);
        nodes.any(|(node, is_constant)| match node.op {
            Op::Sum(k) => !is_constant && self.sums[k as usize].len() >= terms,
            _ => false,
        })
    }

    /// A graph of all nodes that depend on constants only, all of them results, and the indices of these
    /// nodes here.
    pub(crate) fn constants_only(&self) -> (Graph, Vec<u32>) {
        let constant = (0..self.nodes.len()).filter(|&i| self.is_constant[i]);
        let found: Vec<u32> = constant.map(|i| i as u32).collect();
        let mut renumbered = vec![0; self.nodes.len()];
        for (new, &old) in (0..).zip(&found) {
            renumbered[old as usize] = new;
        }
        let node = |&i: &u32| {
            let Node { op, a, b } = self.nodes[i as usize];
            let (a, b) = (renumbered[a as usize], renumbered[b as usize]);
            Node { op, a, b }
        };
        let term = |&Term { node, minus }: &Term| {
            let node = renumbered[node as usize];
            Term { node, minus }
        };
        let constants = Graph {
            inputs: self.inputs,
            nodes: found.iter().map(node).collect(),
            constants: self.constants.clone(),
            functions: self.functions.clone(),
            terms: self.terms.iter().map(term).collect(),
            sums: self.sums.clone(),
            roots: (0..found.len() as u32).collect(),
            is_constant: vec![true; found.len()],
        };
        (constants, found)
    }

    /// The constant exponent of an operation.
    pub(crate) fn exponent(&self, op: Op) -> Option<Constant> {
        match op {
            Op::Powf(k) | Op::PowfDerivative(k) => Some(self.constants[k as usize]),
            _ => None,
        }
    }

    /// The operands of a node.
    pub(crate) fn operands(&self, node: usize) -> impl Iterator<Item = u32> + '_ {
        let Node { op, a, b } = self.nodes[node];
        let terms = match op {
            Op::Sum(k) => self.sums[k as usize].clone(),
            _ => 0..0,
        };
        let pair = [a, b].into_iter().take(op.arity());
        pair.chain(self.terms[terms].iter().map(|term| term.node))
    }

    /// The second derivatives of a node by its operands that can be non-zero, without those by constants.
    pub(crate) fn curvature(&self, node: usize) -> Curvature {
        let Node { op, a, b } = self.nodes[node];
        let constant = |x: u32| self.is_constant[x as usize];
        match op.curvature() {
            _ if self.is_constant[node] => Curvature::None,
            Curvature::Product if constant(a) || constant(b) => Curvature::None,
            Curvature::Quotient if constant(b) => Curvature::None,
            curvature => curvature,
        }
    }

    fn push_sum(&mut self, terms: impl Iterator<Item = Term>, renumbered: &[u32]) {
        let start = self.terms.len();
        self.terms.extend(terms.map(|t| Term {
            node: renumbered[t.node as usize],
            ..t
        }));
        self.terms[start..].reverse();
        self.sums.push(start..self.terms.len());
        self.push(Node::leaf(Op::Sum(self.sums.len() as u32 - 1)));
    }

    fn push(&mut self, node: Node) {
        self.nodes.push(node);
        let constant = match node.op {
            Op::Input(_) => false,
            Op::Constant(_) => true,
            _ => self
                .operands(self.nodes.len() - 1)
                .all(|i| self.is_constant[i as usize]),
        };
        self.is_constant.push(constant);
    }
}

/// Marks the partial sums of chains of at least `terms` terms. They are computed within a sum of the graph.
pub(crate) fn partial_sums(recorder: &Operations, root: u32, terms: usize) -> Vec<bool> {
    let chains = Chains::new(&recorder.nodes, &count_uses(recorder, &[root]));
    let mut is_partial = vec![false; recorder.nodes.len()];
    for i in (0..recorder.nodes.len()).rev() {
        let is_long_sum = chains.is_sum(i) && chains.length[i] as usize >= terms;
        if let (true, Some(c)) = (is_long_sum || is_partial[i], chains.next[i]) {
            is_partial[c as usize] = true;
        }
    }
    is_partial
}

/// How often each node is used by nodes on which a root depends. Being a root counts as a use.
fn count_uses(recorder: &Operations, roots: &[u32]) -> Vec<u32> {
    let mut uses = vec![0_u32; recorder.nodes.len()];
    roots.iter().for_each(|&root| uses[root as usize] += 1);
    for i in (0..recorder.nodes.len()).rev() {
        if uses[i] > 0 {
            let Node { op, a, b } = recorder.nodes[i];
            for operand in [a, b].into_iter().take(op.arity()) {
                uses[operand as usize] += 1;
            }
        }
    }
    uses
}

/// Chains of additions and subtractions whose partial sums are used once.
struct Chains {
    /// The operand that continues the chain, if there is one.
    next: Vec<Option<u32>>,
    /// The number of operands of the chain from this node on.
    length: Vec<u32>,
    /// Whether the node is inside a longer sum.
    absorbed: Vec<bool>,
}

impl Chains {
    fn new(nodes: &[Node], uses: &[u32]) -> Self {
        let mut next = vec![None; nodes.len()];
        let mut length = vec![1; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            let candidates: &[u32] = match node.op {
                Op::Add => &[node.a, node.b],
                Op::Sub => &[node.a],
                _ => continue,
            };
            let continues =
                |&c: &u32| length[c as usize] > 1 && uses[c as usize] == 1 && node.a != node.b;
            next[i] = candidates
                .iter()
                .copied()
                .filter(continues)
                .max_by_key(|&c| length[c as usize]);
            length[i] = next[i].map_or(2, |c| length[c as usize] + 1);
        }
        let mut chains = Chains {
            next,
            length,
            absorbed: vec![false; nodes.len()],
        };
        for i in (0..nodes.len()).rev() {
            let inside = chains.absorbed[i] || (uses[i] > 0 && chains.length[i] >= SHORTEST_SUM);
            if let (true, Some(c)) = (inside, chains.next[i]) {
                chains.absorbed[c as usize] = true;
            }
        }
        chains
    }

    fn is_sum(&self, node: usize) -> bool {
        self.length[node] >= SHORTEST_SUM && !self.absorbed[node]
    }

    /// The operands of a sum, in reverse order.
    fn terms<'a>(&'a self, nodes: &'a [Node], top: usize) -> impl Iterator<Item = Term> + 'a {
        let mut pending = None;
        let mut at = Some(top);
        std::iter::from_fn(move || {
            if let Some(term) = pending.take() {
                return Some(term);
            }
            let i = at?;
            let Node { op, a, b } = nodes[i];
            let minus = op == Op::Sub;
            at = self.next[i].map(|c| c as usize);
            match self.next[i] {
                Some(c) => Some(Term {
                    node: if c == a { b } else { a },
                    minus,
                }),
                None => {
                    pending = Some(Term {
                        node: a,
                        minus: false,
                    });
                    Some(Term { node: b, minus })
                }
            }
        })
    }
}
