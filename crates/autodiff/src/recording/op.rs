//! [`Op`]: the operations of a trace.

use equip_scalar::{Constant, Outside};
use std::sync::Arc;

/// One operation. Payloads are part of the operation, so that a run of equal operations shares them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Op {
    /// An entry of the table of constants.
    Constant(u32),
    /// A component of y = (q, p).
    Input(u32),
    /// An entry of the table of sums.
    Sum(u32),
    Add,
    Sub,
    Mul,
    Square,
    Div,
    Neg,
    Recip,
    Sqrt,
    Cbrt,
    Abs,
    /// Integer power.
    Powi(i32),
    /// Power with a constant exponent, which is an entry of the table of constants.
    Powf(u32),
    /// Power with the exponent n/2, n odd, |n| from 3 to 15.
    HalfPower(i32),
    Pow,
    Exp,
    Exp2,
    Ln,
    ExpM1,
    Ln1p,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    Erf,
    Erfc,
    Hypot,
    Min,
    Max,
    /// A derivative of an entry of the table of functions, of the given orders in a and b. A function of one
    /// variable has its operand twice.
    Outside {
        function: u32,
        orders: [u8; 2],
    },
    /// The sign, as in [`Scalar`](equip_scalar::Scalar::signum): −1, 0 or 1.
    Sign,
    /// 1 where a ≤ b, else 0.
    AtMost,
    /// a where b is not 0, else 0.
    WhereNonzero,
    /// The derivative of the power b = aᶜ with a constant exponent, an entry of the table of constants.
    /// Occurs in derivatives only.
    PowfDerivative(u32),
}

/// The second derivatives of an operation by its operands a and b that can be non-zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// None; |x|, min, max and selections are piecewise linear.
    None,
    /// (a, b).
    Product,
    /// (a, b) and (b, b).
    Quotient,
    /// All pairs.
    Full,
}

impl Op {
    /// The number of operands. The operands of a sum are stored elsewhere.
    pub(crate) fn arity(self) -> usize {
        match self {
            Op::Constant(_) | Op::Input(_) | Op::Sum(_) => 0,
            Op::Add
            | Op::Sub
            | Op::Mul
            | Op::Div
            | Op::Pow
            | Op::Atan2
            | Op::Hypot
            | Op::Min
            | Op::Max
            | Op::Outside { .. }
            | Op::AtMost
            | Op::WhereNonzero
            | Op::PowfDerivative(_) => 2,
            _ => 1,
        }
    }

    /// The number of roundings, in units of ε of the result: 1 in general. A power is rounded to ε/2 by each
    /// of its multiplications, and an interpolated table is a polynomial.
    pub(crate) fn roundings(self) -> u32 {
        match self {
            Op::Powi(n) => n.unsigned_abs().div_ceil(2).max(1),
            Op::HalfPower(n) => (n.unsigned_abs() / 2 + 2).div_ceil(2),
            Op::Outside { .. } => 2,
            _ => 1,
        }
    }

    /// Whether the result is non-negative for all operands.
    pub(crate) fn is_never_negative(self) -> bool {
        match self {
            Op::Powi(n) => n % 2 == 0,
            Op::Square
            | Op::Sqrt
            | Op::HalfPower(_)
            | Op::Abs
            | Op::Exp
            | Op::Exp2
            | Op::Cosh
            | Op::Acosh
            | Op::Erfc
            | Op::Hypot
            | Op::AtMost
            | Op::Acos => true,
            _ => false,
        }
    }

    /// Whether exchanging the operands gives the same result bit for bit.
    pub(crate) fn is_commutative(self) -> bool {
        matches!(self, Op::Add | Op::Mul)
    }

    /// The result for two doubles if it is exact, and neither overflow nor underflow is near.
    pub(crate) fn exact(self, a: f64, b: f64) -> Option<f64> {
        let moderate = |x: f64| x == 0.0 || (1e-100..1e100).contains(&x.abs());
        let result = match self {
            Op::Add => a + b,
            Op::Mul => a * b,
            Op::Div => a / b,
            _ => return None,
        };
        let is_exact = match self {
            Op::Add => result - a == b && result - b == a,
            Op::Mul => a.mul_add(b, -result) == 0.0,
            _ => result.mul_add(b, -a) == 0.0,
        };
        (is_exact && [a, b, result].into_iter().all(moderate)).then_some(result)
    }

    /// The second derivatives by the operands.
    pub(crate) fn curvature(self) -> Curvature {
        match self {
            Op::Constant(_)
            | Op::Input(_)
            | Op::Sum(_)
            | Op::Add
            | Op::Sub
            | Op::Neg
            | Op::Abs
            | Op::Min
            | Op::Max
            | Op::Sign
            | Op::AtMost
            | Op::WhereNonzero => Curvature::None,
            Op::Mul => Curvature::Product,
            Op::Div => Curvature::Quotient,
            _ => Curvature::Full,
        }
    }
}

/// An operation with its operands, which are earlier nodes. A unary operation has its operand twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Node {
    pub(crate) op: Op,
    pub(crate) a: u32,
    pub(crate) b: u32,
}

impl Node {
    pub(crate) fn new(op: Op, a: u32, b: u32) -> Self {
        Node { op, a, b }
    }

    /// Without operands of its own.
    pub(crate) fn leaf(op: Op) -> Self {
        Node::new(op, 0, 0)
    }
}

/// Operations in the order of the trace, inputs first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Operations {
    pub(crate) inputs: usize,
    pub(crate) nodes: Vec<Node>,
    pub(crate) constants: Vec<Constant>,
    pub(crate) functions: Vec<Arc<dyn Outside>>,
}
