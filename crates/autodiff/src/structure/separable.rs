//! Whether H = T(p) + U(q).
//!
//! The analysis descends from H through sums, differences, signs and constant factors. H is separable if
//! every operation that depends on both q and p is one of these. The criterion is sufficient, not necessary:
//! (q + p)² − 2qp is not recognised.

use crate::recording::graph::Graph;
use crate::recording::op::Op;

/// Whether H is a sum of a function of q and a function of p.
pub(crate) fn is_separable(graph: &Graph) -> bool {
    let m = graph.inputs / 2;
    // On positions, on momenta.
    let mut depends: Vec<[bool; 2]> = Vec::with_capacity(graph.nodes.len());
    for (i, node) in graph.nodes.iter().enumerate() {
        let own = match node.op {
            Op::Input(k) => [(k as usize) < m, (k as usize) >= m],
            _ => graph.operands(i).fold([false; 2], |[on_q, on_p], x| {
                let [x_on_q, x_on_p] = depends[x as usize];
                [on_q || x_on_q, on_p || x_on_p]
            }),
        };
        depends.push(own);
    }
    let mixed = |i: usize| depends[i] == [true; 2];
    let mut is_term = vec![false; graph.nodes.len()];
    is_term[graph.root() as usize] = true;
    for i in (0..=graph.root() as usize).rev().filter(|&i| mixed(i)) {
        if is_term[i] {
            let node = graph.nodes[i];
            let constant = |x: u32| graph.is_constant[x as usize];
            let splits = match node.op {
                Op::Add | Op::Sub | Op::Neg | Op::Sum(_) => true,
                Op::Mul => constant(node.a) || constant(node.b),
                Op::Div => constant(node.b),
                _ => false,
            };
            if !splits {
                return false;
            }
            graph.operands(i).for_each(|x| is_term[x as usize] = true);
        }
    }
    true
}
