//! Pairs of operations that are replayed as one: a² + b and 1/√a.
//!
//! A replay mostly waits for reading operands and writing results. An operation whose result is used once is
//! therefore computed together with its user. Each is still rounded separately, so results agree bit for bit.
//! This is done after the analyses of structure.

use crate::recording::graph::Graph;
use crate::recording::op::{Node, Op};
use equip_scalar::Constant;

/// The same graph with fewer operations.
pub(crate) fn peephole(graph: &Graph) -> Graph {
    let uses = count_uses(graph);
    let mut taken = vec![false; graph.nodes.len()];
    let mut nodes = graph.nodes.clone();
    for (i, node) in graph.nodes.iter().enumerate() {
        let alone = |x: u32, op: Op| {
            graph.nodes[x as usize].op == op
                && uses[x as usize] == 1
                && !graph.is_constant[x as usize]
        };
        let Node { op, a, b } = *node;
        let (inner, op) = match op {
            Op::Add if a != b && alone(b, Op::Square) => (b, Op::SquareAdd),
            Op::Add if a != b && alone(a, Op::Square) => (a, Op::SquareAdd),
            Op::Div if graph.is_one(a) && alone(b, Op::Sqrt) => (b, Op::RecipSqrt),
            _ => continue,
        };
        taken[inner as usize] = true;
        let x = graph.nodes[inner as usize].a;
        let other = if inner == a { b } else { a };
        nodes[i] = match op {
            Op::SquareAdd => Node { op, a: x, b: other },
            _ => Node { op, a: x, b: x },
        };
    }
    graph.without(&taken, nodes)
}

/// How often each node is an operand or a result.
fn count_uses(graph: &Graph) -> Vec<u32> {
    let mut uses = vec![0; graph.nodes.len()];
    for i in 0..graph.nodes.len() {
        graph.operands(i).for_each(|x| uses[x as usize] += 1);
    }
    graph.roots.iter().for_each(|&x| uses[x as usize] += 1);
    uses
}

impl Graph {
    fn is_one(&self, node: u32) -> bool {
        match self.nodes[node as usize].op {
            Op::Constant(k) => self.constants[k as usize] == Constant::double(1.0),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Graph, peephole};
    use crate::Var;
    use crate::derivative::reverse::differentiate;
    use crate::recording::op::Op;
    use crate::recording::trace::record;
    use crate::replay::layout::{Blocks, layout};
    use crate::replay::tape::Tape;
    use crate::replay::values::Replay;

    fn potential(q: &[Var]) -> Var {
        let r2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
        // q₀² is used elsewhere too, and remains.
        1.0 / r2.sqrt() + (q[0] * q[0]).exp()
    }

    #[test]
    fn what_goes_nowhere_else_is_taken_up() {
        let recording = record(3, |q, _| potential(q)).unwrap_or_else(|e| panic!("{e}"));
        let graph = peephole(&Graph::new(&recording.operations, &[recording.root]));
        let found: Vec<Op> = graph.nodes.iter().map(|node| node.op).collect();
        let count = |op: Op| found.iter().filter(|&&x| x == op).count();
        assert_eq!(count(Op::Square), 1);
        assert_eq!(count(Op::SquareAdd), 2);
        assert_eq!([Op::RecipSqrt, Op::Sqrt, Op::Div].map(count), [1, 0, 0]);
        assert_eq!(count(Op::Add), 1);
    }

    /// A chain whose springs share a factor, in a force that depends on all masses: some results are used in
    /// many blocks, and one is a term of a sum in each block.
    #[test]
    fn blocks_and_operations_in_one_have_the_bits_of_single_operations() {
        let m = 400;
        let recording = record(m, |q, _| {
            let shared = (q[0] * q[0]).exp();
            let r2 = q.iter().map(|&q| q * q).sum::<Var>();
            let springs = q.windows(2).map(|q| {
                let d = q[1] - q[0];
                shared * (d * d) + (d * d + 0.25 * (q[0] * q[0])).sqrt()
            });
            springs.sum::<Var>() + q[m - 1] / r2.sqrt() + 1.0 / (q[1] * q[1] + q[2] * q[2]).sqrt()
        })
        .unwrap_or_else(|e| panic!("{e}"));
        let mut recorder = recording.resume();
        let derivatives = differentiate(&mut recorder, recording.root);
        let graph = || Graph::new(&recorder, &derivatives);
        let results = |tape: Tape| -> Vec<u64> {
            let mut replay = Replay::<f64>::new(&tape);
            let number = |k: usize| ((k * k + 3) as f64 * 0.37).sin();
            let bits = |x: &f64| x.to_bits();
            replay.run(&tape, number).iter().map(bits).collect()
        };
        let expected = results(layout(&graph(), Blocks::One));
        let in_blocks = layout(&graph(), Blocks::InCache);
        assert!(in_blocks.blocks.len() > 2 && in_blocks.copies.len() > 2);
        assert_eq!(results(in_blocks), expected);
        assert_eq!(results(layout(&peephole(&graph()), Blocks::One)), expected);
        let both = layout(&peephole(&graph()), Blocks::InCache);
        assert!(both.operations() == layout(&graph(), Blocks::One).operations());
        assert_eq!(results(both), expected);
        assert!(expected.iter().any(|&x| x != expected[0]));
    }
}
