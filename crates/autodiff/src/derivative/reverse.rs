//! ∂H/∂y, appended to the trace of H: reverse-mode differentiation, applied once to operations instead of
//! numbers.
//!
//! With w the derivative of H by a result f(x, y), the operand x receives w ∂f/∂x, and y likewise (Griewank,
//! Walther 2008, section 3.2). The result is a trace like any other. Derivatives are replayed in any float
//! type, equal operations are computed once, constant factors are multiplied in advance, and operations that
//! only H needs are dropped. A trace of ∂H/∂q alone contains nothing of T(p). Factors that are powers of two
//! are collected (`twos`). Cost: one to three times the operations of H, for any number of inputs.
//!
//! At discontinuities of a derivative: |x| has derivative 0 at 0, hypot has (0, 0) at the origin, min and max
//! differentiate their first argument at a tie. √x has the derivative ∞ at 0. The derivative of xʸ by y is 0
//! if xʸ is 0.

use crate::recording::op::{Node, Op};
use crate::recording::recorder::Recorder;
use equip_scalar::{Constant, Written};
use std::collections::{BinaryHeap, HashMap};
use std::sync::Arc;

/// Appends the derivatives of the node `root` by all inputs. Returns their nodes.
pub(crate) fn differentiate(recorder: &mut Recorder, root: u32) -> Vec<u32> {
    Reverse::new(recorder).sweep(root, |_, _| {})
}

/// The first input on which each node depends, `u32::MAX` for constants.
fn first_inputs(recorder: &Recorder) -> Vec<u32> {
    let mut first: Vec<u32> = Vec::with_capacity(recorder.nodes.len());
    for Node { op, a, b } in &recorder.nodes {
        let operands = [a, b].into_iter().take(op.arity());
        let own = match *op {
            Op::Input(k) => k,
            _ => operands.fold(u32::MAX, |least, &x| least.min(first[x as usize])),
        };
        first.push(own);
    }
    first
}

/// The derivative of H by a node: ± 2^twos times the value of another node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Adjoint {
    pub(super) node: u32,
    pub(super) minus: bool,
    pub(super) twos: i32,
}

impl Adjoint {
    pub(super) fn of(node: u32) -> Self {
        Adjoint {
            node,
            minus: false,
            twos: 0,
        }
    }
}

pub(super) struct Reverse<'a> {
    pub(super) recorder: &'a mut Recorder,
    first_input: Vec<u32>,
    /// The last input by which the current pass differentiates.
    last_input: u32,
    /// For each node the sums of the derivatives received so far, one for each power of two.
    received: Vec<Vec<Adjoint>>,
    /// The nodes that have received a derivative.
    pending: BinaryHeap<u32>,
    /// For each node, how often it was passed to others as a derivative by them.
    pub(super) shares: HashMap<u32, u32>,
}

impl<'a> Reverse<'a> {
    /// For derivatives of the nodes recorded so far.
    pub(super) fn new(recorder: &'a mut Recorder) -> Self {
        let first_input = first_inputs(recorder);
        Reverse {
            received: vec![Vec::new(); first_input.len()],
            pending: BinaryHeap::new(),
            shares: HashMap::new(),
            last_input: recorder.inputs as u32 - 1,
            first_input,
            recorder,
        }
    }

    /// The derivatives of a node by all inputs. Calls `visit` with every operation on which the node depends,
    /// and the derivative by this operation.
    pub(super) fn sweep(&mut self, root: u32, visit: impl FnMut(u32, Adjoint)) -> Vec<u32> {
        let mut derivatives = vec![None; self.recorder.inputs];
        for (input, derivative) in self.sweep_up_to(u32::MAX, root, visit) {
            derivatives[input as usize] = Some(derivative);
        }
        let mut or_zero = |derivative: Option<u32>| derivative.unwrap_or_else(|| self.number(0.0));
        derivatives.into_iter().map(&mut or_zero).collect()
    }

    /// The non-zero derivatives by the inputs up to `last_input`, in ascending order.
    pub(super) fn sweep_up_to(
        &mut self,
        last_input: u32,
        root: u32,
        mut visit: impl FnMut(u32, Adjoint),
    ) -> Vec<(u32, u32)> {
        self.last_input = last_input.min(self.recorder.inputs as u32 - 1);
        self.shares.clear();
        let one = Adjoint::of(self.number(1.0));
        self.give(root, one);
        let mut inputs = Vec::new();
        while let Some(node) = self.pending.pop() {
            if (node as usize) < self.recorder.inputs {
                inputs.push(node);
            } else if let Some(w) = self.total(node as usize) {
                visit(node, w);
                self.pass_on(node, w);
            }
        }
        inputs.reverse();
        let derivatives = inputs.into_iter();
        derivatives
            .filter_map(|input| Some((input, self.result(input)?)))
            .collect()
    }
}

impl Reverse<'_> {
    /// Passes the derivative w of the node f on to its operands.
    #[rustfmt::skip]
    fn pass_on(&mut self, f: u32, w: Adjoint) {
        let Node { op, a: x, b: y } = self.recorder.nodes[f as usize];
        match op {
            Op::Constant(_) | Op::Input(_) | Op::Sum(_) | Op::Powi(0) => {}
            Op::Sign | Op::AtMost => {}
            Op::WhereNonzero => {
                let node = self.apply(op, w.node, y);
                self.give(x, Adjoint { node, ..w });
            }
            Op::Add => { self.give(x, w); self.give(y, w); }
            Op::Sub => { self.give(x, w); self.give_minus(y, w); }
            Op::Neg => self.give_minus(x, w),
            Op::Mul => { self.give_times(x, w, y); self.give_times(y, w, x); }
            Op::Div => self.quotient(x, y, w),
            Op::Square => { let twice = self.times_two(w, 1); self.give_times(x, twice, x); }
            Op::Recip => { let derivative = self.apply(Op::Square, f, f); self.give_times(x, opposite(w), derivative); }
            Op::Sqrt => {
                // The reciprocal is shared with a following 1/√x.
                let (half, derivative) = (self.times_two(w, -1), self.reciprocal(f));
                self.give_times(x, half, derivative);
            }
            Op::Powi(n) => {
                let factor = self.number(f64::from(n));
                let w = self.times(w, factor);
                let power = self.apply(Op::Powi(n.saturating_sub(1)), x, x);
                self.give_times(x, w, power);
            }
            Op::HalfPower(n) => {
                let c = self.number(0.5 * f64::from(n));
                if n > 0 {
                    let w = self.times(w, c);
                    let power = self.recorder.half_power(x, n - 2);
                    self.give_times(x, w, power);
                } else {
                    let multiple = self.product(c, f);
                    let derivative = self.apply(Op::Div, multiple, x);
                    self.give_times(x, w, derivative);
                }
            }
            Op::Powf(k) => {
                if self.recorder.constants[k as usize].to::<f64>() != 0.0 {
                    let derivative = self.apply(Op::PowfDerivative(k), x, f);
                    self.give_times(x, w, derivative);
                }
            }
            Op::PowfDerivative(k) => {
                if let Some(derivative) = self.second_powf_derivative(x, k) {
                    self.give_times(x, w, derivative);
                }
            }
            Op::Pow => {
                let one = self.number(1.0);
                let less = self.apply(Op::Sub, y, one);
                let power = self.apply(Op::Pow, x, less);
                let by_x = self.product(y, power);
                self.give_times(x, w, by_x);
                let ln = self.apply(Op::Ln, x, x);
                let by_y = self.product(f, ln);
                let by_y = self.apply(Op::WhereNonzero, by_y, f);
                self.give_times(y, w, by_y);
            }
            Op::Abs => { let derivative = self.apply(Op::Sign, x, x); self.give_times(x, w, derivative); }
            Op::Cbrt => { let below = self.three_squares(f); self.give_over(x, w, below); }
            Op::Exp => self.give_times(x, w, f),
            Op::Exp2 => { let derivative = self.ln_2_times(f); self.give_times(x, w, derivative); }
            Op::ExpM1 => { let derivative = self.apply(Op::Exp, x, x); self.give_times(x, w, derivative); }
            Op::Ln => self.give_over(x, w, x),
            Op::Ln1p => { let below = self.one_plus(x); self.give_over(x, w, below); }
            Op::Sin => { let derivative = self.apply(Op::Cos, x, x); self.give_times(x, w, derivative); }
            Op::Cos => { let derivative = self.apply(Op::Sin, x, x); self.give_times(x, opposite(w), derivative); }
            Op::Tan => { let derivative = self.one_plus_square(f); self.give_times(x, w, derivative); }
            Op::Asin => { let below = self.root_of_rest(x); self.give_over(x, w, below); }
            Op::Acos => { let below = self.root_of_rest(x); self.give_over(x, opposite(w), below); }
            Op::Atan => { let below = self.one_plus_square(x); self.give_over(x, w, below); }
            Op::Sinh => { let derivative = self.apply(Op::Cosh, x, x); self.give_times(x, w, derivative); }
            Op::Cosh => { let derivative = self.apply(Op::Sinh, x, x); self.give_times(x, w, derivative); }
            Op::Tanh => { let derivative = self.square_of_sech(x); self.give_times(x, w, derivative); }
            Op::Asinh => {
                let one = self.number(1.0);
                let below = self.apply(Op::Hypot, x, one);
                self.give_over(x, w, below);
            }
            Op::Acosh => { let below = self.root_of_excess(x); self.give_over(x, w, below); }
            Op::Atanh => { let below = self.rest_of_square(x); self.give_over(x, w, below); }
            Op::Erf => { let derivative = self.bell(x); self.give_times(x, w, derivative); }
            Op::Erfc => { let derivative = self.bell(x); self.give_times(x, opposite(w), derivative); }
            Op::Outside { function, orders: [i, j] } => {
                let f = Arc::clone(&self.recorder.functions[function as usize]);
                let by_x = self.recorder.outside(&f, [i + 1, j], [x, y]);
                self.give_times(x, w, by_x);
                if f.variables() == 2 {
                    let by_y = self.recorder.outside(&f, [i, j + 1], [x, y]);
                    self.give_times(y, w, by_y);
                }
            }
            Op::Atan2 => {
                // f is the angle of the point (y, x). It is divided by the radius twice, since the square of
                // the radius may overflow.
                let r = self.apply(Op::Hypot, y, x);
                let by_x = self.twice_over(y, r);
                self.give_times(x, w, by_x);
                let by_y = self.twice_over(x, r);
                self.give_times(y, opposite(w), by_y);
            }
            Op::Hypot => {
                for z in [x, y] {
                    let derivative = self.apply(Op::Div, z, f);
                    let derivative = self.apply(Op::WhereNonzero, derivative, f);
                    self.give_times(z, w, derivative);
                }
            }
            Op::Min => self.either(x, y, w, [x, y]),
            Op::Max => self.either(x, y, w, [y, x]),
        }
    }

    /// x/y, with the reciprocal of y in place of further divisions.
    fn quotient(&mut self, x: u32, y: u32, w: Adjoint) {
        if !self.depends(y) {
            return self.give_over(x, w, y);
        }
        let r = self.reciprocal(y);
        let by_y = if self.depends(x) {
            let by_x = self.times(w, r);
            self.give(x, by_x);
            self.times(by_x, x)
        } else {
            // Constants first, since they are multiplied in advance.
            let wx = self.times(w, x);
            self.times(wx, r)
        };
        self.give_times(y, opposite(by_y), r);
    }

    /// Passes w to x if `smaller[0]` ≤ `smaller[1]`, and to y otherwise.
    fn either(&mut self, x: u32, y: u32, w: Adjoint, smaller: [u32; 2]) {
        let first = self.apply(Op::AtMost, smaller[0], smaller[1]);
        self.give_times(x, w, first);
        let one = self.number(1.0);
        let second = self.apply(Op::Sub, one, first);
        self.give_times(y, w, second);
    }

    fn give_over(&mut self, operand: u32, w: Adjoint, below: u32) {
        let node = self.fold(Op::Div, w.node, below);
        self.give(operand, Adjoint { node, ..w });
    }

    fn give_times(&mut self, operand: u32, w: Adjoint, derivative: u32) {
        if self.depends(operand) {
            let part = self.times(w, derivative);
            self.give(operand, part);
        }
    }

    fn give_minus(&mut self, operand: u32, w: Adjoint) {
        self.give(operand, opposite(w));
    }

    /// Adds a derivative to those that the operand has received.
    fn give(&mut self, operand: u32, new: Adjoint) {
        if !self.depends(operand) {
            return;
        }
        *self.shares.entry(new.node).or_default() += 1;
        let received = &self.received[operand as usize];
        if received.is_empty() {
            self.pending.push(operand);
        }
        match received.iter().position(|old| old.twos == new.twos) {
            Some(k) => {
                let sum = self.joined(received[k], new);
                self.received[operand as usize][k] = sum;
            }
            None => self.received[operand as usize].push(new),
        }
    }

    /// The sum of two derivatives with the same power of two. Signs are resolved here.
    fn joined(&mut self, x: Adjoint, y: Adjoint) -> Adjoint {
        let node = match (x.minus, y.minus) {
            (false, true) => self.apply(Op::Sub, x.node, y.node),
            (true, false) => self.apply(Op::Sub, y.node, x.node),
            _ => self.sum(x.node, y.node),
        };
        let minus = x.minus && y.minus;
        Adjoint { node, minus, ..x }
    }

    /// The sum of all derivatives that a node has received.
    fn total(&mut self, node: usize) -> Option<Adjoint> {
        let mut received = std::mem::take(&mut self.received[node]).into_iter();
        let mut total = received.next()?;
        for w in received {
            let (x, y) = (self.settled(total), self.settled(w));
            total = self.joined(x, y);
        }
        Some(total)
    }

    fn result(&mut self, input: u32) -> Option<u32> {
        let w = self.total(input as usize)?;
        let Adjoint { node, minus, .. } = self.settled(w);
        if minus {
            return Some(self.apply(Op::Neg, node, node));
        }
        Some(node)
    }

    /// Whether a node depends on an input by which the current pass differentiates.
    fn depends(&self, node: u32) -> bool {
        self.first_input[node as usize] <= self.last_input
    }

    fn times(&mut self, w: Adjoint, factor: u32) -> Adjoint {
        let node = self.product(w.node, factor);
        Adjoint { node, ..w }
    }

    pub(super) fn product(&mut self, x: u32, y: u32) -> u32 {
        self.fold(Op::Mul, x, y)
    }

    pub(super) fn sum(&mut self, x: u32, y: u32) -> u32 {
        self.fold(Op::Add, x, y)
    }

    /// The operation, or its result if both operands are doubles and the result is exact: ½ + ½ is 1, and 1·x
    /// is x.
    fn fold(&mut self, op: Op, x: u32, y: u32) -> u32 {
        match (self.double(x), self.double(y)) {
            (Some(a), Some(b)) => match op.exact(a, b) {
                Some(result) => self.number(result),
                None => self.apply(op, x, y),
            },
            _ => self.apply(op, x, y),
        }
    }

    pub(super) fn double(&self, node: u32) -> Option<f64> {
        match self.recorder.nodes[node as usize].op {
            Op::Constant(k) => match self.recorder.constants[k as usize].written() {
                Written::Double(x) => Some(x),
                _ => None,
            },
            _ => None,
        }
    }

    pub(super) fn number(&mut self, x: f64) -> u32 {
        self.recorder.constant(Constant::double(x))
    }

    pub(super) fn apply(&mut self, op: Op, x: u32, y: u32) -> u32 {
        self.recorder.apply(op, x, y)
    }
}

fn opposite(w: Adjoint) -> Adjoint {
    Adjoint {
        minus: !w.minus,
        ..w
    }
}
