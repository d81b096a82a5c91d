//! [`Traced`]: the trace of H. Everything derived from the trace is computed on first use, and shared by the
//! evaluators of all float types.

use super::results::Results;
use crate::derivative::bound::differentiate_with_bound;
use crate::derivative::exact::exact_operations;
use crate::derivative::hessian::hessian;
use crate::derivative::reverse::differentiate;
use crate::recording::bytes;
use crate::recording::graph::{Graph, partial_sums};
use crate::recording::recorder::Recording;
use crate::replay::tape::LONG;
use crate::replay::values::constants;
use crate::structure::colouring::Colouring;
use crate::structure::facts::HessianPattern;
use crate::structure::{degree, separable, sparsity};
use crate::{BuildError, Structure};
use std::sync::{Arc, OnceLock};

/// The trace of an energy and everything derived from it, shared by the evaluators of all float types.
#[derive(Debug)]
pub(crate) struct Traced {
    recording: Recording,
    pub(crate) energy: Results,
    /// Whether H has a sum that is long enough to be compensated.
    pub(crate) has_long_sums: bool,
    derivatives: OnceLock<Gradients>,
    with_bound: OnceLock<Results>,
    hessian: OnceLock<Hessian>,
    pub(crate) structure: Structure,
}

/// The derivatives of H.
#[derive(Debug)]
pub(crate) struct Gradients {
    /// All n components of ∇H.
    pub(crate) gradient: Results,
    /// ∇U, if H = T(p) + U(q).
    pub(crate) forces: Option<Results>,
}

/// The entries of ∇²H.
#[derive(Debug)]
pub(crate) enum Hessian {
    Recorded(Box<Results>),
    /// By products with a vector for each colour of the columns. Used if the trace would be too long, for a
    /// long formula in which all parts depend on many variables.
    ByColours(Colouring),
}

/// The number of operations up to which ∇²H is traced in any case. 200 bodies have 1.3 million operations,
/// which take 3 s to prepare. Beyond, ∇²H is traced up to a multiple of the operations of ∇H and the entries.
/// For chains and bodies this multiple is less than 3.
const LONG_HESSIAN: usize = 1 << 20;
const MOST_TIMES: usize = 16;

impl Traced {
    pub(crate) fn of(recording: Recording) -> Result<Arc<Self>, BuildError> {
        let m = recording.operations.inputs / 2;
        let graph = Arc::new(Graph::new(&recording.operations, &[recording.root]));
        check_constants(&graph)?;
        Ok(Arc::new(Traced {
            recording,
            has_long_sums: graph.has_sum_of(LONG),
            structure: Structure {
                degrees_of_freedom: m,
                separable: separable::is_separable(&graph),
                degree: degree::degree(&graph, 0..2 * m),
                degree_in_q: degree::degree(&graph, 0..m),
                degree_in_p: degree::degree(&graph, m..2 * m),
                hessian: hessian_pattern(Arc::clone(&graph)),
            },
            energy: Results::new(graph),
            derivatives: OnceLock::new(),
            with_bound: OnceLock::new(),
            hessian: OnceLock::new(),
        }))
    }

    /// The trace of H.
    pub(crate) fn recording(&self) -> &Recording {
        &self.recording
    }

    pub(crate) fn operations(&self) -> usize {
        self.energy.one().operations()
    }

    pub(crate) fn gradient_operations(&self) -> usize {
        self.gradient().one().operations()
    }

    pub(crate) fn hessian_operations(&self) -> usize {
        match self.hessian() {
            Hessian::Recorded(entries) => entries.one().operations(),
            Hessian::ByColours(colouring) => 3 * colouring.colours * self.gradient_operations(),
        }
    }

    pub(super) fn formula_checksum(&self) -> u64 {
        bytes::formula_checksum(&self.recording)
    }

    pub(crate) fn derivatives(&self) -> &Gradients {
        self.derivatives.get_or_init(|| {
            let Structure {
                separable,
                degrees_of_freedom: m,
                ..
            } = self.structure;
            let mut recorder = self.recording.resume();
            let derivatives = differentiate(&mut recorder, self.recording.root);
            let results = |roots: &[u32]| Results::new(Arc::new(Graph::new(&recorder, roots)));
            Gradients {
                gradient: results(&derivatives),
                forces: separable.then(|| results(&derivatives[..m])),
            }
        })
    }

    pub(crate) fn gradient(&self) -> &Results {
        &self.derivatives().gradient
    }

    /// ∇H, the running error bound, and H.
    pub(crate) fn with_bound(&self) -> &Results {
        self.with_bound.get_or_init(|| with_bound(&self.recording))
    }

    pub(crate) fn hessian(&self) -> &Hessian {
        self.hessian.get_or_init(|| {
            let pattern = &self.structure.hessian;
            let mut recorder = self.recording.resume();
            let derivatives = differentiate(&mut recorder, self.recording.root);
            let most = MOST_TIMES * (recorder.nodes.len() + pattern.len());
            match hessian(&mut recorder, &derivatives, pattern, most.max(LONG_HESSIAN)) {
                Some(entries) => {
                    let graph = Arc::new(Graph::new(&recorder, &entries));
                    Hessian::Recorded(Box::new(Results::new(graph)))
                }
                None => Hessian::ByColours(Colouring::new(pattern)),
            }
        })
    }
}

fn hessian_pattern(graph: Arc<Graph>) -> HessianPattern {
    HessianPattern::new(graph.inputs, move |rows| {
        sparsity::hessian_pattern(&graph, rows)
    })
}

/// ∇H, the running error bound and H, in this order.
fn with_bound(energy: &Recording) -> Results {
    let root = energy.root;
    let mut recorder = energy.resume();
    let compensated = partial_sums(&recorder, root, LONG);
    let is_exact: Vec<bool> = (exact_operations(&recorder).iter().zip(compensated))
        .map(|(&is_exact, is_compensated)| is_exact || is_compensated)
        .collect();
    let (mut roots, bound) = differentiate_with_bound(&mut recorder, root, &is_exact);
    roots.extend([bound, root]);
    Results::new(Arc::new(Graph::new(&recorder, &roots)))
}

/// Rejects constants, and values computed from constants alone, that are NaN or infinite.
fn check_constants(graph: &Graph) -> Result<(), BuildError> {
    let exponents = graph
        .nodes
        .iter()
        .filter_map(|node| graph.exponent(node.op));
    let exponents = exponents.map(|c| c.to::<f64>());
    let numbers = constants(graph).into_iter().map(|(_, x)| x);
    let mut all = numbers.chain(exponents);
    let mut found = Ok(());
    if let Some(x) = all.find(|x| !x.is_finite()) {
        found = Err(if x.is_nan() || all.any(f64::is_nan) {
            BuildError::ConstantNotANumber
        } else {
            BuildError::ConstantInfinite
        });
    }
    found
}
