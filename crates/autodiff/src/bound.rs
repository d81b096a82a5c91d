//! [`Bound`]: the running error bound of H as it is replayed.
//!
//! One recording has ∇H, the bound of [`differentiate_with_bound`] and H as its results. It is made when it
//! is first asked for.

use crate::batch::Batch;
use crate::compiled::{Compiled, Runs};
use crate::derivative::differentiate_with_bound;
use crate::graph::{Graph, partial_sums};
use crate::order::Blocks;
use crate::peephole::peephole;
use crate::recorder::Recording;
use crate::tape::{LONG, Tape};
use crate::values::Replay;
use equip_scalar::{Float, InstructionSet};
use std::sync::{Arc, OnceLock};

/// ∇H, the bound and H of one recording, shared by all evaluators.
#[derive(Debug)]
pub(crate) struct Bound {
    energy: Recording,
    made: OnceLock<Made>,
}

#[derive(Debug)]
struct Made {
    tape: Tape,
    compiled: Option<Arc<Compiled>>,
}

impl Bound {
    pub(crate) fn new(energy: Recording) -> Self {
        Bound {
            energy,
            made: OnceLock::new(),
        }
    }

    fn made(&self) -> &Made {
        self.made.get_or_init(|| {
            let root = self.energy.root;
            let mut recorder = self.energy.resume();
            let is_exact = partial_sums(&recorder, root, LONG);
            let (mut roots, bound) = differentiate_with_bound(&mut recorder, root, &is_exact);
            roots.extend([bound, root]);
            let graph = Graph::new(&recorder, &roots);
            drop(recorder);
            Made {
                compiled: Compiled::new(&graph),
                tape: Tape::new(&peephole(graph), Blocks::One),
            }
        })
    }
}

/// Evaluates it in the float type `T`.
#[derive(Debug, Clone)]
pub(crate) struct BoundRuns<T> {
    runs: Runs,
    /// Where there is no machine code.
    replay: Option<Replay<T>>,
    /// ∇H, the bound and H.
    results: Vec<T>,
}

impl<T: Float> BoundRuns<T> {
    pub(crate) fn new(bound: &Bound, n: usize) -> Self {
        BoundRuns {
            runs: Runs::new::<T>(&bound.made().compiled),
            replay: None,
            results: vec![T::int(0); n + 2],
        }
    }

    /// ∇H, the bound and H, without compensated sums.
    pub(crate) fn run(&mut self, set: InstructionSet, bound: &Bound, y: &[T]) -> (&[T], T, T) {
        let n = y.len();
        let batch = Batch::one(y, &mut self.results);
        if self.runs.run(set, batch).is_none() {
            let tape = &bound.made().tape;
            let replay = self.replay.get_or_insert_with(|| Replay::new(tape));
            self.results.copy_from_slice(replay.run(tape, |k| y[k]));
        }
        (&self.results[..n], self.results[n], self.results[n + 1])
    }
}
