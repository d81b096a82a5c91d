//! Exact operations, which are not rounded: changes of sign, products with powers of two, selections.
//!
//! They are exact unless overflow or underflow is near. They do not contribute to the running error bound.
//! Therefore the bound agrees bit for bit if H is written with another sign, in units that differ by a power
//! of two, or in other pieces.

use crate::recording::op::{Node, Op, Operations};
use equip_scalar::{Constant, DoubleDouble};

/// The value of a node, as far as it is known for all states.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    Nothing,
    /// This number, in every floating-point type.
    Number(f64),
    /// −1, 0 or 1.
    Sign,
}

/// Marks the operations that are exact at every state.
pub(crate) fn exact_operations(recorder: &Operations) -> Vec<bool> {
    let mut known: Vec<Known> = Vec::with_capacity(recorder.nodes.len());
    let mut is_exact = Vec::with_capacity(recorder.nodes.len());
    for &node in &recorder.nodes {
        known.push(of(recorder, &known, node));
        is_exact.push(is_exact_operation(recorder, &known, node));
    }
    is_exact
}

fn of(recorder: &Operations, known: &[Known], Node { op, a, b }: Node) -> Known {
    if let Op::Constant(k) = op {
        return exact_double(recorder.constants[k as usize]);
    }
    if let Op::Sign | Op::AtMost = op {
        return Known::Sign;
    }
    if op.arity() == 0 {
        return Known::Nothing;
    }
    let number = |x: Option<f64>| x.map_or(Known::Nothing, Known::Number);
    let is_at_most = |x: u32| recorder.nodes[x as usize].op == Op::AtMost;
    match (op, known[a as usize], known[b as usize]) {
        (Op::Neg, Known::Number(x), _) => Known::Number(-x),
        (Op::Neg, Known::Sign, _) => Known::Sign,
        (Op::Sub, Known::Number(1.0), _) if is_at_most(b) => Known::Sign,
        (Op::Sub, Known::Number(x), Known::Number(y)) => number(Op::Add.exact(x, -y)),
        (Op::Add | Op::Mul | Op::Div, Known::Number(x), Known::Number(y)) => number(op.exact(x, y)),
        _ => Known::Nothing,
    }
}

fn exact_double(c: Constant) -> Known {
    let wide = c.to::<DoubleDouble>();
    match wide.lo() == 0.0 {
        true => Known::Number(wide.hi()),
        false => Known::Nothing,
    }
}

fn is_exact_operation(recorder: &Operations, known: &[Known], Node { op, a, b }: Node) -> bool {
    let scales = |x: u32| match known[x as usize] {
        Known::Number(x) => is_power_of_two(x),
        known => known == Known::Sign,
    };
    let is_zero = |x: u32| known[x as usize] == Known::Number(0.0);
    match op {
        Op::Neg | Op::Abs | Op::Min | Op::Max | Op::Powi(0 | 1) => true,
        Op::Sign | Op::AtMost | Op::WhereNonzero => true,
        Op::Mul => scales(a) || scales(b),
        Op::Div => scales(b),
        Op::Sub => is_zero(a) || is_zero(b),
        Op::Add => a == b || is_zero(a) || is_zero(b) || is_choice(recorder, known, a, b),
        _ => false,
    }
}

/// Whether one of the two is 0 at every state: x is taken if a test is true, y otherwise.
fn is_choice(recorder: &Operations, known: &[Known], x: u32, y: u32) -> bool {
    let [x, y] = [x, y].map(|x| recorder.nodes[x as usize]);
    let is_rest = |rest: u32, test: u32| {
        let Node { op, a, b } = recorder.nodes[rest as usize];
        op == Op::Sub && known[a as usize] == Known::Number(1.0) && b == test
    };
    let are_parts = x.op == Op::WhereNonzero && y.op == Op::WhereNonzero;
    are_parts
        && [(x, y), (y, x)]
            .iter()
            .any(|(x, y)| recorder.nodes[x.b as usize].op == Op::AtMost && is_rest(y.b, x.b))
}

/// ± 2^k.
pub(crate) fn is_power_of_two(x: f64) -> bool {
    x.is_normal() && x.to_bits() << 12 == 0
}
