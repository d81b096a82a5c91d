//! The running error bound of H, appended to its trace together with ∂H/∂y.
//!
//! The rounding of an operation v_k of H changes v_k by ε|v_k|, and H by that times the derivative of H by
//! v_k. Likewise rounding the state changes H by ε|y_i ∂_iH|. The sum of all these changes, without its
//! factor ε, is
//!
//! B(y) = Σ_k r_k |v_k ∂H/∂v_k| + Σ_i |y_i ∂H/∂y_i|.
//!
//! The reverse mode computes the derivatives by the v_k in any case. Operations with the same derivative w
//! are grouped, Σ|w|·(Σ r_k|v_k|): the terms of a sum have the same w. r_k = 1 unless [`Op::roundings`]
//! returns more. Exact operations, and partial sums of compensated sums, are not rounded and have r_k = 0.
//! Cost: one or two operations for each operation of H, in addition to those of ∇H.

use super::reverse::{Adjoint, Reverse};
use crate::recording::op::Op;
use crate::recording::recorder::Recorder;
use std::collections::HashMap;

/// Appends the derivatives of the node `root` by all inputs, and B. Returns their nodes. `is_exact` marks the
/// operations that are not rounded.
pub(crate) fn differentiate_with_bound(
    recorder: &mut Recorder,
    root: u32,
    is_exact: &[bool],
) -> (Vec<u32>, u32) {
    let mut reverse = Reverse::new(recorder);
    let mut rounded: Vec<(u32, Adjoint)> = Vec::new();
    let derivatives = reverse.sweep(root, |node, w| {
        if !is_exact[node as usize] {
            rounded.push((node, w));
        }
    });
    let by_inputs = (0..).zip(derivatives.iter().map(|&node| Adjoint::of(node)));
    rounded.extend(by_inputs);
    let bound = reverse.bound(&rounded);
    (derivatives, bound)
}

impl Reverse<'_> {
    /// Σ r|v w| over pairs of an operation and the derivative by it.
    fn bound(&mut self, rounded: &[(u32, Adjoint)]) -> u32 {
        let mut places: HashMap<(u32, i32), usize> = HashMap::new();
        let mut groups: Vec<(Adjoint, u32)> = Vec::new();
        for &(node, w) in rounded {
            if self.double(w.node) == Some(0.0) {
                continue;
            }
            let size = self.rounding(node);
            let place = *places.entry((w.node, w.twos)).or_insert(groups.len());
            match groups.get_mut(place) {
                Some((_, sum)) => *sum = self.sum(*sum, size),
                None => groups.push((w, size)),
            }
        }
        let mut bound = None;
        for (w, sum) in groups {
            let derivative = self.settled(w).node;
            let derivative = self.size(derivative);
            let part = self.product(derivative, sum);
            bound = Some(bound.map_or(part, |bound| self.sum(bound, part)));
        }
        bound.unwrap_or_else(|| self.number(0.0))
    }

    /// r|v|.
    fn rounding(&mut self, node: u32) -> u32 {
        let roundings = self.recorder.nodes[node as usize].op.roundings();
        let factor = self.number(f64::from(roundings));
        let size = self.size(node);
        self.product(factor, size)
    }

    fn size(&mut self, node: u32) -> u32 {
        match self.double(node) {
            Some(x) => self.number(x.abs()),
            None if self.recorder.nodes[node as usize].op.is_never_negative() => node,
            None => self.apply(Op::Abs, node, node),
        }
    }
}
