//! Powers of two in derivatives. Squares and roots contribute one each. They are collected until a constant
//! absorbs them or others cancel them.
//!
//! The product with a power of two is exact unless overflow or underflow is near, so no more than
//! 2^[`MOST_TWOS`] is collected.

use super::reverse::{Adjoint, Reverse};
use crate::recording::op::{Node, Op};

/// The number of nested operations into which a power of two is absorbed.
const DEPTH: u32 = 3;
/// The largest collected exponent.
const MOST_TWOS: i32 = 8;

impl Reverse<'_> {
    /// 2^twos w, absorbed by constants if possible.
    pub(super) fn times_two(&mut self, w: Adjoint, twos: i32) -> Adjoint {
        let twos = w.twos + twos;
        let waiting = Adjoint { twos, ..w };
        if self.absorbs(w.node, twos, DEPTH) {
            let node = self.absorbed(w.node, twos);
            Adjoint { node, twos: 0, ..w }
        } else if twos.abs() > MOST_TWOS {
            self.settled(waiting)
        } else {
            waiting
        }
    }

    /// w with its power of two multiplied in.
    pub(super) fn settled(&mut self, w: Adjoint) -> Adjoint {
        let node = match w.twos {
            0 => w.node,
            1 => self.apply(Op::Add, w.node, w.node),
            twos => {
                let factor = self.number(2f64.powi(twos));
                self.product(w.node, factor)
            }
        };
        Adjoint { node, twos: 0, ..w }
    }

    /// Whether constants absorb the factor 2^twos at no cost: c, c·x, and c/x and sums of these if they are
    /// used once.
    fn absorbs(&self, node: u32, twos: i32, depth: u32) -> bool {
        let Node { op, a, b } = self.recorder.nodes[node as usize];
        let is_own = self.shares.get(&node).is_none_or(|&shares| shares <= 1);
        let constant = |x: u32| {
            let c = self.double(x);
            c.is_some_and(|c| Op::Mul.exact(c, 2f64.powi(twos)).is_some())
        };
        constant(node)
            || match op {
                Op::Mul => constant(a) || constant(b),
                Op::Div => is_own && constant(a),
                Op::Add | Op::Sub | Op::Neg if is_own && depth > 0 => {
                    [a, b].into_iter().all(|x| self.absorbs(x, twos, depth - 1))
                }
                _ => false,
            }
    }

    /// 2^twos times a node that absorbs it.
    fn absorbed(&mut self, node: u32, twos: i32) -> u32 {
        let Node { op, a, b } = self.recorder.nodes[node as usize];
        match op {
            Op::Mul if self.double(a).is_none() => {
                let b = self.absorbed(b, twos);
                self.apply(op, a, b)
            }
            Op::Mul | Op::Div => {
                let a = self.absorbed(a, twos);
                self.apply(op, a, b)
            }
            Op::Constant(_) => {
                let factor = self.number(2f64.powi(twos));
                self.product(node, factor)
            }
            _ => {
                let (a, b) = (self.absorbed(a, twos), self.absorbed(b, twos));
                self.apply(op, a, b)
            }
        }
    }
}
