//! [`Derived`]: a recording, and what is derived from it when it is first asked for.

use super::bound::with_bound;
use super::results::Results;
use crate::derivative::differentiate;
use crate::derivative::hessian::HessianPlan;
use crate::recording::graph::Graph;
use crate::recording::recorder::Recording;
use crate::replay::order::Blocks;
use crate::replay::tape::{LONG, Tape};
use crate::replay::values::Replay;
use crate::structure::facts::HessianPattern;
use crate::structure::{degree, separable};
use crate::{BuildError, Structure};
use std::sync::{Arc, OnceLock};

/// A recording and what is derived from it, shared by the evaluators of all float types.
#[derive(Debug)]
pub(crate) struct Derived {
    recording: Recording,
    pub(crate) energy: Results,
    /// H has a sum that is worth compensating.
    pub(crate) has_long_sums: bool,
    slopes: OnceLock<Slopes>,
    with_bound: OnceLock<Results>,
    plan: OnceLock<HessianPlan>,
    pub(crate) structure: Structure,
}

/// The derivatives of H.
#[derive(Debug)]
pub(crate) struct Slopes {
    /// All n components of ∇H.
    pub(crate) gradient: Results,
    /// ∇U, if H = T(p) + U(q).
    pub(crate) forces: Option<Results>,
}

impl Derived {
    pub(crate) fn new(m: usize, recording: Recording) -> Result<Self, BuildError> {
        let graph = Arc::new(Graph::new(&recording.operations, &[recording.root]));
        check_constants(&graph)?;
        Ok(Derived {
            recording,
            has_long_sums: graph.has_sum_of(LONG),
            structure: Structure {
                degrees_of_freedom: m,
                separable: separable::is_separable(&graph),
                degree: degree::degree(&graph, 0..2 * m),
                degree_in_q: degree::degree(&graph, 0..m),
                degree_in_p: degree::degree(&graph, m..2 * m),
                hessian: HessianPattern::new(Arc::clone(&graph)),
            },
            energy: Results::new(graph),
            slopes: OnceLock::new(),
            with_bound: OnceLock::new(),
            plan: OnceLock::new(),
        })
    }

    pub(crate) fn slopes(&self) -> &Slopes {
        self.slopes.get_or_init(|| {
            let Structure {
                separable,
                degrees_of_freedom: m,
                ..
            } = self.structure;
            let mut recorder = self.recording.resume();
            let slopes = differentiate(&mut recorder, self.recording.root);
            let results = |roots: &[u32]| Results::new(Arc::new(Graph::new(&recorder, roots)));
            Slopes {
                gradient: results(&slopes),
                forces: separable.then(|| results(&slopes[..m])),
            }
        })
    }

    pub(crate) fn gradient(&self) -> &Results {
        &self.slopes().gradient
    }

    /// ∇H, the bound of rounding and H.
    pub(crate) fn with_bound(&self) -> &Results {
        self.with_bound.get_or_init(|| with_bound(&self.recording))
    }

    pub(crate) fn plan(&self) -> &HessianPlan {
        (self.plan).get_or_init(|| HessianPlan::new(&self.structure.hessian))
    }
}

/// Refuses constants, and what is computed of them alone, that are NaN or infinite.
fn check_constants(graph: &Graph) -> Result<(), BuildError> {
    let (constants, _) = graph.constants_only();
    let tape = Tape::new(&constants, Blocks::One);
    let numbers = Replay::<f64>::new(&tape);
    let exponents = graph
        .nodes
        .iter()
        .filter_map(|node| graph.exponent(node.op));
    let exponents = exponents.map(|c| c.to::<f64>());
    let mut all = numbers.values.iter().copied().chain(exponents);
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
