//! [`Tape`]: the graph laid out for replay.
//!
//! Every result has a slot: constants, results that depend on constants only, inputs, then all else. Operations
//! are sorted by blocks of results and dependency level and, within a level, into runs of one operation, whose results stand
//! side by side. Within a run they are sorted by their operands; where these stand side by side too, or are the
//! same slot throughout, the run is a plain loop over slices. Measured: runs 2×, slices another 1.6×.

use crate::graph::{Graph, Term};
use crate::op::Op;
use equip_scalar::Constant;
use std::ops::Range;

/// Shortest run over slices that is worth leaving a run over listed operands.
const SHORTEST_SLICE: usize = 8;

/// Slots that are computed between one visit to the results and the next: 8 lanes of each fill half of a first-level cache.
const SLOTS_OF_A_BLOCK: usize = 384;

/// How the operands of a run lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Access {
    /// Anywhere.
    Listed,
    /// Side by side, both.
    Slices,
    /// The left one is the same throughout, the right ones lie side by side.
    FixedLeft,
    /// The right one is the same throughout, the left ones lie side by side.
    FixedRight,
}

/// Equal operations without dependence on each other.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) op: Op,
    /// Slots of the results.
    pub(crate) slots: Range<usize>,
    pub(crate) access: Access,
}

/// Terms of a sum with one sign and, if `first` is given, side by side.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub(crate) minus: bool,
    pub(crate) terms: Range<usize>,
    pub(crate) first: Option<usize>,
}

/// A recorded energy, in no particular float type.
#[derive(Debug)]
pub(crate) struct Tape {
    pub(crate) constants: Vec<Constant>,
    /// Constants used as exponents, by the index [`Op::Powf`] and [`Op::PowfSlope`] have after layout.
    pub(crate) exponents: Vec<Constant>,
    /// Slots of the inputs; results of constants stand before, all others after.
    pub(crate) inputs: Range<usize>,
    pub(crate) slots: usize,
    pub(crate) constant_runs: Vec<Run>,
    pub(crate) runs: Vec<Run>,
    /// Slot of the left and right operand, by slot.
    pub(crate) left: Vec<u32>,
    pub(crate) right: Vec<u32>,
    /// Slots of the terms of sums.
    pub(crate) terms: Vec<u32>,
    pub(crate) segments: Vec<Segment>,
    /// Entry of each sum in `segments`.
    pub(crate) sums: Vec<Range<usize>>,
    /// Slots of the results.
    pub(crate) results: Vec<u32>,
}

impl Tape {
    pub(crate) fn new(graph: &Graph) -> Self {
        Layout::new(graph).finish()
    }

    /// Arithmetic operations and function calls of one replay.
    pub(crate) fn operations(&self) -> usize {
        let own = |run: &Run| match run.op {
            Op::Sum(k) => self.segments[self.sums[k as usize].clone()]
                .iter()
                .map(|segment| segment.terms.len())
                .sum::<usize>()
                .saturating_sub(1),
            _ => run.slots.len(),
        };
        self.runs.iter().map(own).sum()
    }
}

/// A tape under construction.
struct Layout<'a> {
    graph: &'a Graph,
    tape: Tape,
    /// Slot of each node placed so far.
    slot: Vec<u32>,
}

/// An operation to be placed, in the order in which it will be: by operation, then by operands.
type Placement = (Op, u32, u32, usize);

impl<'a> Layout<'a> {
    fn new(graph: &'a Graph) -> Self {
        let slots = graph.nodes.len();
        let mut layout = Layout {
            graph,
            tape: Tape {
                constants: Vec::new(),
                exponents: Vec::new(),
                inputs: 0..graph.inputs,
                slots,
                constant_runs: Vec::new(),
                runs: Vec::new(),
                left: vec![0; slots],
                right: vec![0; slots],
                terms: Vec::new(),
                segments: Vec::new(),
                sums: vec![0..0; graph.sums.len()],
                results: Vec::new(),
            },
            slot: vec![0; slots],
        };
        for (i, node) in graph.nodes.iter().enumerate() {
            if let Op::Constant(k) = node.op {
                layout.slot[i] = layout.tape.constants.len() as u32;
                layout.tape.constants.push(graph.constants[k as usize]);
            }
        }
        layout
    }

    fn finish(mut self) -> Tape {
        let order = Order::new(self.graph);
        let mut next = self.tape.constants.len();
        for level in self.in_order(&order, true) {
            self.place(level, &mut next, true);
        }
        for (i, node) in self.graph.nodes.iter().enumerate() {
            if let Op::Input(k) = node.op {
                self.slot[i] = next as u32 + k;
            }
        }
        self.tape.inputs = next..next + self.graph.inputs;
        next += self.graph.inputs;
        for level in self.in_order(&order, false) {
            self.place(level, &mut next, false);
        }
        let slot = |&root: &u32| self.slot[root as usize];
        self.tape.results = self.graph.roots.iter().map(slot).collect();
        self.tape
    }

    /// Operations by block and level, those that depend on constants only or the others.
    fn in_order(&self, order: &Order, constant: bool) -> Vec<Vec<usize>> {
        let nodes = self.graph.nodes.iter().enumerate();
        let wanted = nodes.filter(|(i, node)| {
            let is_leaf = matches!(node.op, Op::Constant(_) | Op::Input(_));
            !is_leaf && self.graph.is_constant[*i] == constant
        });
        let mut wanted: Vec<usize> = wanted.map(|(i, _)| i).collect();
        let key = |&i: &usize| (order.blocks[i], order.levels[i]);
        wanted.sort_by_key(key);
        let groups = wanted.chunk_by(|x, y| key(x) == key(y));
        groups.map(<[usize]>::to_vec).collect()
    }

    fn place(&mut self, level: Vec<usize>, next: &mut usize, constant: bool) {
        let mut placements: Vec<Placement> = level.into_iter().map(|i| self.placement(i)).collect();
        placements.sort_unstable();
        for group in placements.chunk_by(|x, y| x.0 == y.0) {
            for (range, access) in split(group) {
                let run = Run {
                    op: group[0].0,
                    slots: *next..*next + range.len(),
                    access,
                };
                for &(_, left, right, node) in &group[range] {
                    self.slot[node] = *next as u32;
                    self.tape.left[*next] = left;
                    self.tape.right[*next] = right;
                    *next += 1;
                }
                let runs = if constant {
                    &mut self.tape.constant_runs
                } else {
                    &mut self.tape.runs
                };
                runs.push(run);
            }
        }
    }

    fn placement(&mut self, i: usize) -> Placement {
        let node = self.graph.nodes[i];
        let live = |x: u32| !self.graph.is_constant[x as usize];
        match node.op {
            Op::Sum(k) => {
                self.place_terms(k as usize);
                (node.op, 0, 0, i)
            }
            op => {
                let (mut a, mut b) = (node.a, node.b);
                // Constants to the left, so that 2·x and x·2 share a run.
                if op.is_commutative() && live(a) && !live(b) {
                    (a, b) = (b, a);
                }
                let op = match op {
                    Op::Powf(k) => Op::Powf(self.exponent(k)),
                    Op::PowfSlope(k) => Op::PowfSlope(self.exponent(k)),
                    op => op,
                };
                (op, self.slot[a as usize], self.slot[b as usize], i)
            }
        }
    }

    fn exponent(&mut self, k: u32) -> u32 {
        let c = self.graph.constants[k as usize];
        let known = self.tape.exponents.iter().position(|&e| e == c);
        known.unwrap_or_else(|| {
            self.tape.exponents.push(c);
            self.tape.exponents.len() - 1
        }) as u32
    }

    fn place_terms(&mut self, sum: usize) {
        let terms = &self.graph.terms[self.graph.sums[sum].clone()];
        let first_segment = self.tape.segments.len();
        let slot = |term: &Term| self.slot[term.node as usize];
        for group in terms.chunk_by(|x, y| x.minus == y.minus) {
            let slots: Vec<u32> = group.iter().map(slot).collect();
            let mut start = 0;
            while start < slots.len() {
                let side_by_side = stretch(&slots[start..], |x, y| *y == x + 1);
                let first = (side_by_side >= SHORTEST_SLICE).then(|| slots[start] as usize);
                let end = match first {
                    Some(_) => start + side_by_side,
                    None => next_slice(&slots, start),
                };
                let base = self.tape.terms.len();
                self.tape.terms.extend_from_slice(&slots[start..end]);
                let terms = base..self.tape.terms.len();
                self.tape.segments.push(Segment {
                    minus: group[0].minus,
                    terms,
                    first,
                });
                start = end;
            }
        }
        self.tape.sums[sum] = first_segment..self.tape.segments.len();
    }
}

/// When an operation is done.
struct Order {
    /// The first block of results that needs it. Results are computed block after block, so that what a block needs
    /// is still in the cache when it is used.
    blocks: Vec<u32>,
    /// Steps from the leaves, within a block.
    levels: Vec<u32>,
}

impl Order {
    fn new(graph: &Graph) -> Self {
        let nodes = graph.nodes.len();
        let results_of_a_block = (SLOTS_OF_A_BLOCK * graph.roots.len()).div_ceil(nodes.max(1));
        let mut blocks = vec![u32::MAX; nodes];
        for (k, &root) in graph.roots.iter().enumerate() {
            let block = (k / results_of_a_block.max(1)) as u32;
            blocks[root as usize] = blocks[root as usize].min(block);
        }
        let mut levels: Vec<u32> = Vec::with_capacity(nodes);
        for i in (0..nodes).rev() {
            for x in graph.operands(i) {
                blocks[x as usize] = blocks[x as usize].min(blocks[i]);
            }
        }
        for i in 0..nodes {
            let deepest = graph.operands(i).map(|x| levels[x as usize] + 1).max();
            levels.push(deepest.unwrap_or(0));
        }
        Order { blocks, levels }
    }
}

/// Number of leading elements each of which stands in the given relation to the one before.
fn stretch<E>(elements: &[E], follows: impl Fn(&E, &E) -> bool) -> usize {
    elements
        .windows(2)
        .take_while(|w| follows(&w[0], &w[1]))
        .count()
        + 1
}

/// Where the next stretch of slots side by side begins that is long enough, or the end.
fn next_slice(slots: &[u32], start: usize) -> usize {
    let mut at = start;
    while at < slots.len() {
        let length = stretch(&slots[at..], |x, y| *y == x + 1);
        if length >= SHORTEST_SLICE {
            break;
        }
        at += length;
    }
    at
}

/// Parts of a group of equal operations, by how their operands lie.
fn split(group: &[Placement]) -> Vec<(Range<usize>, Access)> {
    let mut parts: Vec<(Range<usize>, Access)> = Vec::new();
    let mut start = 0;
    while start < group.len() {
        let rest = &group[start..];
        let both = stretch(rest, |x, y| y.1 == x.1 + 1 && y.2 == x.2 + 1);
        let fixed_left = stretch(rest, |x, y| y.1 == x.1 && y.2 == x.2 + 1);
        let fixed_right = stretch(rest, |x, y| y.1 == x.1 + 1 && y.2 == x.2);
        let longest = both.max(fixed_left).max(fixed_right);
        let access = match longest {
            l if l < SHORTEST_SLICE => Access::Listed,
            l if l == both => Access::Slices,
            l if l == fixed_left => Access::FixedLeft,
            _ => Access::FixedRight,
        };
        let end = start + longest;
        match parts.last_mut() {
            Some((range, Access::Listed)) if access == Access::Listed => range.end = end,
            _ => parts.push((start..end, access)),
        }
        start = end;
    }
    parts
}
