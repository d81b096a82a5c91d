//! Polynomial degrees of H, as upper bounds.
//!
//! Degrees add in products, and sums take the maximum. A quotient by an expression that does not depend on
//! the given variables does not change the degree, and a function of such an expression has degree 0.
//! Cancellation is not detected: x³ − x³ has degree 3.

use crate::recording::graph::Graph;
use crate::recording::op::Op;
use equip_scalar::{Constant, Written};
use std::ops::Range;

/// The degree of H in the inputs of the given range, with all others fixed; `None` if H is not known to be a
/// polynomial in them.
pub(crate) fn degree(graph: &Graph, variables: Range<usize>) -> Option<u32> {
    let mut degrees: Vec<Option<u32>> = Vec::with_capacity(graph.nodes.len());
    for (i, node) in graph.nodes.iter().enumerate() {
        let (a, b) = match node.op.arity() {
            0 => (Some(0), Some(0)),
            _ => (degrees[node.a as usize], degrees[node.b as usize]),
        };
        let largest = || {
            graph
                .operands(i)
                .map(|x| degrees[x as usize])
                .try_fold(0, larger)
        };
        let degree = match node.op {
            Op::Input(k) => Some(u32::from(variables.contains(&(k as usize)))),
            Op::Add | Op::Sub | Op::Neg | Op::Sum(_) => largest(),
            Op::Mul => a.zip(b).map(|(a, b)| a.saturating_add(b)),
            Op::Square => a.map(|a| a.saturating_mul(2)),
            Op::Div if b == Some(0) => a,
            Op::Powi(n) => power(a, u32::try_from(n).ok()),
            Op::Powf(k) => power(a, whole(graph.constants[k as usize])),
            _ => largest().filter(|&d| d == 0),
        };
        degrees.push(degree);
    }
    degrees[graph.root() as usize]
}

fn larger(a: u32, b: Option<u32>) -> Option<u32> {
    b.map(|b| a.max(b))
}

/// The degree of a power with the given exponent, if the exponent is an integer ≥ 0.
fn power(degree: Option<u32>, exponent: Option<u32>) -> Option<u32> {
    match (degree?, exponent) {
        (0, _) => Some(0),
        (degree, exponent) => Some(degree.saturating_mul(exponent?)),
    }
}

/// An integer exponent ≥ 0 that is written as a double.
fn whole(c: Constant) -> Option<u32> {
    match c.written() {
        Written::Double(x) if x == f64::from(x as u32) => Some(x as u32),
        _ => None,
    }
}
