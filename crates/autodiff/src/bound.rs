//! The running error bound of H as it is replayed: ∇H, the bound of [`differentiate_with_bound`] and H, as
//! one recording.

use crate::derivative::differentiate_with_bound;
use crate::graph::{Graph, partial_sums};
use crate::recorder::Recording;
use crate::results::Results;
use crate::tape::LONG;
use std::sync::Arc;

/// ∇H, the bound and H, in this order.
pub(crate) fn with_bound(energy: &Recording) -> Results {
    let root = energy.root;
    let mut recorder = energy.resume();
    let is_exact = partial_sums(&recorder, root, LONG);
    let (mut roots, bound) = differentiate_with_bound(&mut recorder, root, &is_exact);
    roots.extend([bound, root]);
    Results::new(Arc::new(Graph::new(&recorder, &roots)))
}
