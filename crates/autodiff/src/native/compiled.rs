//! [`Compiled`]: a trace as machine code, compiled at its first run.

use crate::replay::batch::Batch;
use equip_jit::{Code, Program};
use equip_scalar::{Float, InstructionSet, Lanes};
use std::sync::{Arc, Mutex, PoisonError};

/// A trace as a program, with the code compiled so far; shared by all evaluators.
#[derive(Debug)]
pub(crate) struct Compiled {
    program: Program,
    codes: Mutex<Vec<(Layout, Option<Arc<Code>>)>>,
}

/// The parameters of the code: the instruction set, and the length of rows.
type Layout = (InstructionSet, usize);

/// The supported lengths of rows: a single point, and the padded numbers of stages. Other lengths would each
/// need their own code.
const STRIDES: [usize; 6] = [1, 4, 8, 16, 24, 32];

impl Compiled {
    /// `None` if the trace is not a program, or the processor lacks the instructions.
    pub(crate) fn new(program: impl FnOnce() -> Option<Program>) -> Option<Arc<Self>> {
        if InstructionSet::best() == InstructionSet::PORTABLE {
            return None;
        }
        let program = program()?;
        let codes = Mutex::default();
        Some(Arc::new(Compiled { program, codes }))
    }

    fn code(&self, layout: Layout) -> Option<Arc<Code>> {
        let mut codes = self.codes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, code)) = codes.iter().find(|(known, _)| *known == layout) {
            return code.clone();
        }
        let (set, stride) = layout;
        let code = Code::new(&self.program, set, stride).map(Arc::new);
        codes.push((layout, code.clone()));
        code
    }
}

/// A trace that one evaluator runs as machine code, if there is any.
#[derive(Debug, Clone)]
pub(crate) struct Runs {
    compiled: Option<Arc<Compiled>>,
    /// The code that has been run so far.
    codes: Vec<(Layout, Option<Arc<Code>>)>,
    scratch: Vec<Lanes<8>>,
}

impl Runs {
    /// For this float type. There is code for `f64` only.
    pub(crate) fn new<T: Float>(compiled: impl FnOnce() -> Option<Arc<Compiled>>) -> Self {
        Runs {
            compiled: if T::IS_DOUBLE { compiled() } else { None },
            codes: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Runs the code at all points. `None` if there is no code. At the first run with a layout the code is
    /// compiled, or taken from the shared code.
    #[inline]
    pub(crate) fn run<T: Float>(
        &mut self,
        set: InstructionSet,
        batch: &mut Batch<T>,
    ) -> Option<()> {
        let batch = batch.in_doubles()?;
        let k = self.known((set, batch.stride))?;
        let code = self.codes[k].1.as_deref()?;
        code.run(
            batch.states,
            batch.gradients,
            &mut self.scratch,
            batch.count,
        );
        Some(())
    }

    /// The code for rows of `stride` numbers, if it needs no scratch memory.
    #[inline]
    pub(crate) fn without_scratch(&mut self, set: InstructionSet, stride: usize) -> Option<&Code> {
        let k = self.known((set, stride))?;
        let code = self.codes[k].1.as_deref();
        code.filter(|code| code.scratch() == 0)
    }

    #[inline]
    fn known(&mut self, layout: Layout) -> Option<usize> {
        self.compiled.as_ref()?;
        let known = self.codes.iter().position(|(known, _)| *known == layout);
        known.or_else(|| self.begin(layout))
    }

    #[cold]
    fn begin(&mut self, layout: Layout) -> Option<usize> {
        if !STRIDES.contains(&layout.1) {
            return None;
        }
        let code = self.compiled.as_ref()?.code(layout);
        let scratch = code.as_ref().map_or(0, |code| code.scratch());
        if self.scratch.len() < scratch {
            self.scratch.resize(scratch, Lanes::splat(0.0));
        }
        self.codes.push((layout, code));
        Some(self.codes.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::{Batch, Compiled, Runs};
    use crate::Var;
    use crate::native::straight::straight;
    use crate::recording::graph::Graph;
    use crate::recording::trace::record;
    use crate::replay::values::constants;
    use equip_scalar::{DoubleDouble, InstructionSet};
    use std::sync::Arc;

    fn compiled(energy: fn(&[Var], &[Var]) -> Var) -> Option<Arc<Compiled>> {
        let recording = record(1, energy).unwrap_or_else(|e| panic!("{e}"));
        let graph = Graph::new(&recording.operations, &[recording.root]);
        Compiled::new(|| straight(&graph, constants))
    }

    fn runs(runs: &mut Runs, set: InstructionSet, stride: usize) -> bool {
        let (states, mut values) = (vec![2.0; 2 * stride], vec![0.0; stride]);
        let mut batch = Batch {
            states: &states,
            gradients: &mut values,
            stride,
            count: stride,
        };
        let has_run = runs.run(set, &mut batch).is_some();
        assert!(!has_run || values.iter().all(|&h| h == 10.0));
        has_run
    }

    /// The code is run, not a replay with the same result.
    #[test]
    fn arithmetic_is_run_as_machine_code() {
        let compiled = compiled(|q, p| q[0].powi(3) + p[0]);
        let mut own = Runs::new::<f64>(|| compiled.clone());
        for set in InstructionSet::available() {
            let has_code = set.min(InstructionSet::best()) > InstructionSet::PORTABLE;
            for stride in [1, 4, 8, 16, 24, 32] {
                assert_eq!(runs(&mut own, set, stride), has_code, "{set:?} {stride}");
            }
            assert!(!runs(&mut own, set, 3) && !runs(&mut own, set, 12));
        }
        assert!(own.codes.len() <= 6 * InstructionSet::available().count());
        let mut clone = Runs::new::<f64>(|| compiled.clone());
        let set = InstructionSet::best();
        let (first, second) = (own.without_scratch(set, 8), clone.without_scratch(set, 8));
        match (first, second) {
            (Some(first), Some(second)) => assert!(std::ptr::eq(first, second), "made twice"),
            (first, second) => assert!(first.is_none() && second.is_none()),
        }
    }

    #[test]
    fn what_is_replayed() {
        assert!(compiled(|q, p| q[0].exp() + p[0]).is_none());
        let arithmetic = compiled(|q, p| q[0] * p[0]);
        let has_code = InstructionSet::best() > InstructionSet::PORTABLE;
        assert_eq!(arithmetic.is_some(), has_code);
        let mut runs = Runs::new::<DoubleDouble>(|| arithmetic.clone());
        let (one, mut value) = (DoubleDouble::from(1.0), [DoubleDouble::from(0.0)]);
        let mut batch = Batch {
            states: &[one, one],
            gradients: &mut value,
            stride: 1,
            count: 1,
        };
        assert!(runs.run(InstructionSet::best(), &mut batch).is_none());
    }
}
