//! The recorder: every operation once.
//!
//! Value numbering: an operation on the same operands as an earlier one is that earlier one (operands of +
//! and × in either order). Simplifications are those that keep every bit of every result, infinities, NaN and
//! the sign of zero included: x·1, x/1, x − 0, x + (−0), −(−x), x·(−1) = −x, x¹, x⁰ and x·x = x².

use crate::op::{Node, Op};
use equip_scalar::{Attempt, Constant, Written};
use std::collections::HashMap;
use std::panic::Location;

/// Refusals after which a loop waiting for a comparison to come true is taken to be endless.
const PATIENCE: usize = 1 << 16;

/// A constant as a key: equal bits, equal constant.
#[derive(Debug, PartialEq, Eq, Hash)]
enum ConstantKey {
    Double(u64),
    Ratio(i64, i64),
    Decimal(&'static str),
    Extended([u64; 4]),
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

/// The operations of one energy in the order they were met, inputs first.
#[derive(Debug)]
pub(crate) struct Recorder {
    pub(crate) id: u32,
    pub(crate) inputs: usize,
    pub(crate) nodes: Vec<Node>,
    pub(crate) constants: Vec<Constant>,
    /// A variable of another recording was met.
    pub(crate) foreign: bool,
    /// The first attempt to look at a value.
    pub(crate) refusal: Option<(Attempt, &'static Location<'static>)>,
    refusals: usize,
    known: HashMap<Node, u32>,
    known_constants: HashMap<ConstantKey, u32>,
}

/// The operations of one energy H, and no more: what derivatives are made of when they are first asked for.
#[derive(Debug, Clone)]
pub(crate) struct Recording {
    pub(crate) root: u32,
    inputs: usize,
    nodes: Box<[Node]>,
    constants: Box<[Constant]>,
}

impl Recording {
    /// A recorder that has just recorded H.
    pub(crate) fn resume(&self) -> Recorder {
        let mut recorder = Recorder::new(0, self.inputs);
        for &c in &self.constants {
            recorder.constant_entry(c);
        }
        for &node in &self.nodes[self.inputs..] {
            recorder.node(node);
        }
        recorder
    }
}

impl Recorder {
    /// What has been recorded up to the node of H.
    pub(crate) fn recording(&self, root: u32) -> Recording {
        let nodes = (root as usize + 1).max(self.inputs);
        Recording {
            root,
            inputs: self.inputs,
            nodes: self.nodes[..nodes].into(),
            constants: self.constants.clone().into(),
        }
    }

    pub(crate) fn new(id: u32, inputs: usize) -> Self {
        let mut recorder = Recorder {
            id,
            inputs,
            nodes: Vec::new(),
            constants: Vec::new(),
            foreign: false,
            refusal: None,
            refusals: 0,
            known: HashMap::new(),
            known_constants: HashMap::new(),
        };
        for i in 0..inputs as u32 {
            recorder.node(Node {
                op: Op::Input(i),
                a: 0,
                b: 0,
            });
        }
        recorder
    }

    pub(crate) fn constant(&mut self, c: Constant) -> u32 {
        let k = self.constant_entry(c);
        self.node(Node {
            op: Op::Constant(k),
            a: 0,
            b: 0,
        })
    }

    /// xᶜ. Half-integer powers are roots.
    pub(crate) fn powf(&mut self, x: u32, c: Constant) -> u32 {
        if let Some(n) = c.exact_halves() {
            return self.half_power(x, n);
        }
        let k = self.constant_entry(c);
        self.node(Node {
            op: Op::Powf(k),
            a: x,
            b: x,
        })
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

    /// An operation with at most two operands; a unary one has its operand twice.
    pub(crate) fn apply(&mut self, op: Op, a: u32, b: u32) -> u32 {
        match op {
            Op::Add if self.is_double(a, -0.0) => b,
            Op::Add if self.is_double(b, -0.0) => a,
            Op::Sub if self.is_double(b, 0.0) => a,
            Op::Mul if self.is_double(a, 1.0) => b,
            Op::Mul if self.is_double(b, 1.0) => a,
            Op::Mul if self.is_double(a, -1.0) => self.apply(Op::Neg, b, b),
            Op::Mul if self.is_double(b, -1.0) => self.apply(Op::Neg, a, a),
            Op::Mul if a == b => self.node(Node {
                op: Op::Square,
                a,
                b,
            }),
            Op::Div if self.is_double(b, 1.0) => a,
            Op::Neg if self.nodes[a as usize].op == Op::Neg => self.nodes[a as usize].a,
            Op::Powi(0) => self.constant(Constant::double(1.0)),
            Op::Powi(1) => a,
            Op::Powi(2) => self.node(Node {
                op: Op::Square,
                a,
                b,
            }),
            op if op.is_commutative() => self.node(Node {
                op,
                a: a.min(b),
                b: a.max(b),
            }),
            op => self.node(Node { op, a, b }),
        }
    }

    /// Notes an attempt to look at a value.
    ///
    /// # Panics
    /// When it comes so often that the energy must be in a loop which no answer ends.
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

    fn constant_entry(&mut self, c: Constant) -> u32 {
        *self.known_constants.entry(c.into()).or_insert_with(|| {
            self.constants.push(c);
            self.constants.len() as u32 - 1
        })
    }

    fn node(&mut self, node: Node) -> u32 {
        *self.known.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            self.nodes.len() as u32 - 1
        })
    }
}
