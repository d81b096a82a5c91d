//! A trace as straight-line code.
//!
//! The graph is traversed depth first from the results: each operation is computed just before the first
//! result that needs it, so few numbers are live at a time. The operations are those of the replay, one by
//! one.

use crate::recording::graph::{Graph, Term};
use crate::recording::op::{Node, Op};
use equip_jit::{Program, Value};
use std::collections::HashMap;

/// The largest number of nodes and terms of a graph that becomes a program. Code and compilation take several
/// hundred bytes for each.
const LARGEST: usize = 1 << 22;

/// The program of a graph that consists of arithmetic, √ and |x| only, if it is not too large. `constants`
/// evaluates the nodes that depend on constants only, as replays do.
pub(crate) fn straight(
    graph: &Graph,
    constants: impl FnOnce(&Graph) -> Vec<(u32, f64)>,
) -> Option<Program> {
    if graph.nodes.len() + graph.terms.len() > LARGEST {
        return None;
    }
    let mut translation = Translation {
        graph,
        program: Program::new(),
        values: vec![None; graph.nodes.len()],
        roots: HashMap::new(),
    };
    for (node, x) in constants(graph) {
        translation.values[node as usize] = Some(translation.program.constant(x));
    }
    for (row, &root) in graph.roots.iter().enumerate() {
        let value = translation.value(root)?;
        translation.program.result(row, value);
    }
    Some(translation.program)
}

/// The remaining tasks for a result.
#[derive(Debug, Clone, Copy)]
enum Task {
    /// Compute a node and everything it depends on.
    Need(u32),
    /// Compute the node, whose operands are known.
    Do(u32),
    /// One term of a sum.
    Add { to: u32, term: Term },
}

struct Translation<'a> {
    graph: &'a Graph,
    program: Program,
    /// The values of nodes; for an incomplete sum the partial sum.
    values: Vec<Option<Value>>,
    /// The square roots of nodes.
    roots: HashMap<u32, Value>,
}

impl Translation<'_> {
    fn value(&mut self, root: u32) -> Option<Value> {
        let mut tasks = vec![Task::Need(root)];
        while let Some(task) = tasks.pop() {
            match task {
                Task::Need(node) if self.values[node as usize].is_some() => {}
                Task::Need(node) => self.need(node, &mut tasks),
                Task::Do(node) => {
                    let Node { op, a, b } = self.graph.nodes[node as usize];
                    let (x, y) = (self.values[a as usize]?, self.values[b as usize]?);
                    self.values[node as usize] = Some(match op {
                        Op::Sqrt => self.root(a, x),
                        Op::HalfPower(n) => self.half_power(a, x, n),
                        op => self.operation(op, x, y)?,
                    });
                }
                Task::Add { to, term } => {
                    let x = self.values[term.node as usize]?;
                    let sum = match (self.values[to as usize], term.minus) {
                        (None, _) => x,
                        (Some(sum), false) => self.program.add(sum, x),
                        (Some(sum), true) => self.program.sub(sum, x),
                    };
                    self.values[to as usize] = Some(sum);
                }
            }
        }
        self.values[root as usize]
    }

    fn need(&mut self, node: u32, tasks: &mut Vec<Task>) {
        let Node { op, a, b } = self.graph.nodes[node as usize];
        match op {
            Op::Input(k) => self.values[node as usize] = Some(self.program.input(k as usize)),
            Op::Sum(k) => {
                for &term in self.graph.terms[self.graph.sums[k as usize].clone()]
                    .iter()
                    .rev()
                {
                    tasks.extend([Task::Add { to: node, term }, Task::Need(term.node)]);
                }
            }
            _ => {
                tasks.push(Task::Do(node));
                if op.arity() == 2 {
                    tasks.push(Task::Need(b));
                }
                tasks.push(Task::Need(a));
            }
        }
    }

    fn operation(&mut self, op: Op, a: Value, b: Value) -> Option<Value> {
        let program = &mut self.program;
        Some(match op {
            Op::Add => program.add(a, b),
            Op::Sub => program.sub(a, b),
            Op::Mul => program.mul(a, b),
            Op::Square => program.mul(a, a),
            Op::Div => program.div(a, b),
            Op::Neg => program.neg(a),
            Op::Recip => self.reciprocal(a),
            Op::Abs => program.abs(a),
            Op::Powi(n) => self.power(a, n),
            _ => return None,
        })
    }

    fn reciprocal(&mut self, x: Value) -> Value {
        let one = self.program.constant(1.0);
        self.program.div(one, x)
    }

    /// √x of a node, computed once.
    fn root(&mut self, node: u32, x: Value) -> Value {
        let program = &mut self.program;
        *self.roots.entry(node).or_insert_with(|| program.sqrt(x))
    }

    /// x^(n/2) in the order of `Scalar::powf`.
    fn half_power(&mut self, node: u32, x: Value, n: i32) -> Value {
        let root = self.root(node, x);
        let whole = self.power(x, n.abs() / 2);
        let power = self.program.mul(whole, root);
        if n < 0 { self.reciprocal(power) } else { power }
    }

    /// Binary powering from the lowest bit upwards, in the order of the lanes.
    fn power(&mut self, x: Value, n: i32) -> Value {
        let mut exponent = n.unsigned_abs();
        let (mut square, mut power) = (x, None);
        while exponent > 0 {
            if exponent & 1 == 1 {
                power = Some(power.map_or(square, |power| self.program.mul(power, square)));
            }
            exponent >>= 1;
            if exponent > 0 {
                square = self.program.mul(square, square);
            }
        }
        let power = power.unwrap_or_else(|| self.program.constant(1.0));
        if n < 0 { self.reciprocal(power) } else { power }
    }
}
