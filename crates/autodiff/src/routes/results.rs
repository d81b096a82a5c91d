//! [`Results`]: the results of a trace in every form in which they are evaluated, each computed on first use.

use crate::native::compiled::Compiled;
use crate::native::straight::straight;
use crate::recording::graph::Graph;
use crate::replay::layout::{Blocks, layout};
use crate::replay::tape::Tape;
use std::sync::{Arc, OnceLock};

/// A graph, and its tapes and machine code. Shared by the evaluators of all float types.
#[derive(Debug)]
pub(crate) struct Results {
    pub(crate) graph: Arc<Graph>,
    one: OnceLock<Tape>,
    many: OnceLock<Tape>,
    compiled: OnceLock<Option<Arc<Compiled>>>,
}

impl Results {
    pub(crate) fn new(graph: Arc<Graph>) -> Self {
        Results {
            graph,
            one: OnceLock::new(),
            many: OnceLock::new(),
            compiled: OnceLock::new(),
        }
    }

    /// The tape for single points.
    pub(crate) fn one(&self) -> &Tape {
        let tape = || layout(&self.graph, Blocks::One);
        self.one.get_or_init(tape)
    }

    /// The tape for many points at once.
    pub(crate) fn many(&self) -> &Tape {
        let tape = || layout(&self.graph, Blocks::InCache);
        self.many.get_or_init(tape)
    }

    /// Machine code, if there is any.
    pub(crate) fn compiled(
        &self,
        constants: impl FnOnce(&Graph) -> Vec<(u32, f64)>,
    ) -> &Option<Arc<Compiled>> {
        let program = || straight(&self.graph, constants);
        self.compiled.get_or_init(|| Compiled::new(program))
    }
}
