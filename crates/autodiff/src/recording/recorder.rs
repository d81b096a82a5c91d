//! The recorder of a trace, in which every operation occurs once.
//!
//! Value numbering: an operation on the same operands as an earlier one is that earlier one (for + and × in
//! either order of the operands). Only simplifications that preserve every result bit for bit are applied,
//! including infinities, NaN and the sign of zero: x·1, x/1, x − 0, x + (−0), −(−x), x·(−1) = −x, x¹, x⁰ and
//! x·x = x².

use crate::recording::keyed::Keys;
use crate::recording::op::{Node, Op, Operations};
use equip_scalar::{Attempt, Constant, Outside, Written};
use std::collections::{HashMap, TryReserveError};
use std::ops::Deref;
use std::panic::Location;
use std::sync::Arc;

/// The number of refused comparisons after which a loop that waits for a comparison is considered endless.
const PATIENCE: usize = 1 << 16;

/// A constant as a key: constants are equal if their bits are equal.
#[derive(Debug, PartialEq, Eq, Hash)]
enum ConstantKey {
    Double(u64),
    Ratio(i64, i64),
    Decimal(&'static str),
    Extended([u64; 6]),
}

impl From<Constant> for ConstantKey {
    fn from(c: Constant) -> Self {
        match c.written() {
            Written::Double(x) => ConstantKey::Double(x.to_bits()),
            Written::Ratio(n, d) => ConstantKey::Ratio(n, d),
            Written::Decimal(text) => ConstantKey::Decimal(text),
            Written::Extended(parts) => ConstantKey::Extended(parts.map(f64::to_bits)),
        }
    }
}

/// The maximum number of operations of a trace: indices have 32 bits, and derivatives need some of them.
const MOST_OPERATIONS: usize = 1 << 31;

/// The maximum number of degrees of freedom: the components of the state take a quarter of the indices.
pub(crate) const MOST: usize = 1 << 29;

/// The operations of one energy, with an index of equal operations.
#[derive(Debug)]
pub(crate) struct Recorder {
    pub(crate) id: u32,
    pub(super) operations: Operations,
    /// Whether there were more operations than indices.
    pub(crate) overflow: bool,
    /// Whether a variable of another trace was used.
    pub(crate) foreign: bool,
    /// The first attempt to read a value.
    pub(crate) refusal: Option<(Attempt, &'static Location<'static>)>,
    refusals: usize,
    known: HashMap<Node, u32, Keys>,
    known_constants: HashMap<ConstantKey, u32>,
}

impl Deref for Recorder {
    type Target = Operations;

    fn deref(&self) -> &Operations {
        &self.operations
    }
}

/// The operations of one energy H without derivatives, which are computed from them on first use.
#[derive(Debug)]
pub(crate) struct Recording {
    pub(crate) root: u32,
    pub(crate) operations: Operations,
}

impl Recording {
    /// A recorder in the state after tracing H.
    pub(crate) fn resume(&self) -> Recorder {
        let Operations {
            inputs,
            nodes,
            constants,
            functions,
        } = &self.operations;
        let mut recorder = Recorder::new(0, *inputs);
        for &c in constants {
            recorder.constant_entry(c);
        }
        recorder.operations.functions = functions.clone();
        recorder.known.reserve(nodes.len());
        for &node in &nodes[*inputs..] {
            recorder.node(node);
        }
        recorder
    }
}

impl Recorder {
    pub(crate) fn new(id: u32, inputs: usize) -> Self {
        Recorder::of(id, inputs, Operations::default())
    }

    /// A recorder with capacity for these numbers of constants, functions and operations.
    pub(super) fn with_room(
        inputs: usize,
        [constants, functions, nodes]: [usize; 3],
    ) -> Result<Self, TryReserveError> {
        let mut room = Operations::default();
        room.nodes.try_reserve_exact(inputs.saturating_add(nodes))?;
        room.constants.try_reserve_exact(constants)?;
        room.functions.try_reserve_exact(functions)?;
        let mut recorder = Recorder::of(0, inputs, room);
        recorder.known.try_reserve(nodes)?;
        recorder.known_constants.try_reserve(constants)?;
        Ok(recorder)
    }

    /// A recorder that uses the capacity of `operations`, which must be empty.
    fn of(id: u32, inputs: usize, mut operations: Operations) -> Self {
        let input = |i| Node::leaf(Op::Input(i));
        operations.inputs = inputs;
        operations.nodes.extend((0..inputs as u32).map(input));
        Recorder {
            id,
            operations,
            overflow: false,
            foreign: false,
            refusal: None,
            refusals: 0,
            known: HashMap::default(),
            known_constants: HashMap::new(),
        }
    }

    /// The trace up to the node of H.
    pub(crate) fn finish(self, root: u32) -> Recording {
        let mut operations = self.operations;
        let length = (root as usize + 1).max(operations.inputs);
        operations.nodes.truncate(length);
        operations.nodes.shrink_to_fit();
        Recording { root, operations }
    }

    pub(crate) fn constant(&mut self, c: Constant) -> u32 {
        let k = self.constant_entry(c);
        self.node(Node::leaf(Op::Constant(k)))
    }

    /// xᶜ. Half-integer powers are computed with roots.
    pub(crate) fn powf(&mut self, x: u32, c: Constant) -> u32 {
        if let Some(n) = c.exact_halves() {
            return self.half_power(x, n);
        }
        let k = self.constant_entry(c);
        self.node(Node::new(Op::Powf(k), x, x))
    }

    /// x^(n/2) for an odd n.
    pub(crate) fn half_power(&mut self, x: u32, n: i32) -> u32 {
        match n {
            1 => self.apply(Op::Sqrt, x, x),
            -1 => {
                let root = self.apply(Op::Sqrt, x, x);
                let one = self.constant(Constant::double(1.0));
                self.apply(Op::Div, one, root)
            }
            n => self.apply(Op::HalfPower(n), x, x),
        }
    }

    /// An operation with at most two operands. A unary one has its operand twice.
    pub(crate) fn apply(&mut self, op: Op, a: u32, b: u32) -> u32 {
        match op {
            Op::Add if self.is_double(a, -0.0) => b,
            Op::Add if self.is_double(b, -0.0) => a,
            Op::Sub if self.is_double(b, 0.0) => a,
            Op::Mul if self.is_double(a, 1.0) => b,
            Op::Mul if self.is_double(b, 1.0) => a,
            Op::Mul if self.is_double(a, -1.0) => self.apply(Op::Neg, b, b),
            Op::Mul if self.is_double(b, -1.0) => self.apply(Op::Neg, a, a),
            Op::Mul if a == b => self.node(Node::new(Op::Square, a, b)),
            Op::Div if self.is_double(b, 1.0) => a,
            Op::Neg if self.nodes[a as usize].op == Op::Neg => self.nodes[a as usize].a,
            Op::Powi(0) => self.constant(Constant::double(1.0)),
            Op::Powi(1) => a,
            Op::Powi(2) => self.node(Node::new(Op::Square, a, b)),
            op if op.is_commutative() => self.node(Node::new(op, a.min(b), a.max(b))),
            op => self.node(Node { op, a, b }),
        }
    }

    /// The derivative of these orders of a function. Equal functions are recognised by their address.
    pub(crate) fn outside(
        &mut self,
        f: &Arc<dyn Outside>,
        orders: [u8; 2],
        [x, y]: [u32; 2],
    ) -> u32 {
        if orders != [0, 0] && f.is_step() {
            return self.constant(Constant::double(0.0));
        }
        let place = |f: &Arc<dyn Outside>| Arc::as_ptr(f).cast::<()>();
        let functions = &mut self.operations.functions;
        let known = functions.iter().position(|known| place(known) == place(f));
        let function = known.unwrap_or_else(|| {
            functions.push(Arc::clone(f));
            functions.len() - 1
        }) as u32;
        self.apply(Op::Outside { function, orders }, x, y)
    }

    /// The derivative of `power` = xᶜ.
    pub(crate) fn powf_derivative(&mut self, x: u32, power: u32, c: Constant) -> u32 {
        let k = self.constant_entry(c);
        self.apply(Op::PowfDerivative(k), x, power)
    }

    /// Records an attempt to read a value.
    ///
    /// # Panics
    /// If attempts are so frequent that the energy must be in an endless loop.
    pub(crate) fn refuse(&mut self, attempt: Attempt, location: &'static Location<'static>) {
        self.refusal.get_or_insert((attempt, location));
        self.refusals += 1;
        assert!(
            self.refusals < PATIENCE,
            "the energy waits at {location} for a comparison of the state to come true, which it never does \
             while being recorded; replace the loop by a fixed number of iterations"
        );
    }

    fn is_double(&self, node: u32, x: f64) -> bool {
        match self.nodes[node as usize].op {
            Op::Constant(k) => match self.constants[k as usize].written() {
                Written::Double(c) => c.to_bits() == x.to_bits(),
                _ => false,
            },
            _ => false,
        }
    }

    pub(super) fn constant_entry(&mut self, c: Constant) -> u32 {
        *self.known_constants.entry(c.into()).or_insert_with(|| {
            self.operations.constants.push(c);
            self.operations.constants.len() as u32 - 1
        })
    }

    pub(super) fn node(&mut self, node: Node) -> u32 {
        let nodes = &mut self.operations.nodes;
        if nodes.len() >= MOST_OPERATIONS {
            self.overflow = true;
            return 0;
        }
        *self.known.entry(node).or_insert_with(|| {
            nodes.push(node);
            nodes.len() as u32 - 1
        })
    }
}
