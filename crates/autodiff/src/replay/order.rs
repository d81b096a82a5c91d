//! [`Order`]: in which block of results, and how deep in it, an operation is done.

use crate::recording::graph::Graph;
use crate::recording::op::Op;

/// How many operations belong to a block.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Blocks {
    /// All of them: the longest runs, a slot for each.
    One,
    /// As many as fill about half of a first-level cache with 8 lanes each.
    InCache,
}

impl Blocks {
    fn size(self) -> usize {
        match self {
            Blocks::One => usize::MAX,
            Blocks::InCache => 384,
        }
    }
}

/// When the operations of a graph are done.
pub(crate) struct Order {
    /// Number of blocks.
    pub(crate) count: u32,
    /// The first block that needs an operation.
    pub(crate) blocks: Vec<u32>,
    /// Steps from the leaves.
    pub(crate) levels: Vec<u32>,
    /// Whether a later block needs the operation too.
    pub(crate) is_kept: Vec<bool>,
    /// Nodes of the inputs each block needs, ascending; each block reads its own.
    pub(crate) inputs: Vec<Vec<u32>>,
    /// Results that are known after each block.
    pub(crate) results: Vec<Vec<u32>>,
}

impl Order {
    pub(crate) fn new(graph: &Graph, size: Blocks) -> Self {
        let (nodes, roots) = (graph.nodes.len(), graph.roots.len());
        let results_of_a_block = size.size().saturating_mul(roots) / nodes.max(1);
        let results_of_a_block = results_of_a_block.clamp(1, roots.max(1));
        let count = roots.div_ceil(results_of_a_block);
        let mut blocks = vec![u32::MAX; nodes];
        for (k, &root) in graph.roots.iter().enumerate() {
            let block = &mut blocks[root as usize];
            *block = (*block).min((k / results_of_a_block) as u32);
        }
        for i in (0..nodes).rev() {
            for x in graph.operands(i) {
                blocks[x as usize] = blocks[x as usize].min(blocks[i]);
            }
        }
        let mut order = Order {
            count: count as u32,
            levels: Vec::with_capacity(nodes),
            is_kept: vec![false; nodes],
            inputs: vec![Vec::new(); count],
            results: vec![Vec::new(); count],
            blocks,
        };
        for (k, &root) in graph.roots.iter().enumerate() {
            let block = order.blocks[root as usize] as usize;
            order.results[block].push(k as u32);
            order.use_in(graph, root, block as u32);
        }
        for i in 0..nodes {
            let mut level = 0;
            for x in graph.operands(i) {
                level = level.max(order.levels[x as usize] + 1);
                order.use_in(graph, x, order.blocks[i]);
            }
            order.levels.push(level);
        }
        for inputs in &mut order.inputs {
            inputs.sort_unstable();
            inputs.dedup();
        }
        order
    }

    fn use_in(&mut self, graph: &Graph, node: u32, block: u32) {
        let i = node as usize;
        match graph.nodes[i].op {
            Op::Constant(_) => {}
            Op::Input(_) => {
                if let Some(inputs) = self.inputs.get_mut(block as usize) {
                    inputs.push(node);
                }
            }
            _ => self.is_kept[i] |= !graph.is_constant[i] && self.blocks[i] != block,
        }
    }
}
