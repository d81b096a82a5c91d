//! Points one after the other, for functions that are not computed in lanes.

use crate::replay::batch::Batch;
use equip_scalar::Float;

/// Workspace for one state and its results.
#[derive(Debug, Clone)]
pub(crate) struct Points<T> {
    state: Vec<T>,
    results: Vec<T>,
}

// Not derived, since `T` need not have a default.
impl<T> Default for Points<T> {
    fn default() -> Self {
        Points {
            state: Vec::new(),
            results: Vec::new(),
        }
    }
}

impl<T: Float> Points<T> {
    /// Calls `compute` for each point of a batch, with states and results of these lengths. If the batch has
    /// fewer components than a state, the remaining ones are 0; results that it has no room for are lost.
    pub(crate) fn each(
        &mut self,
        batch: Batch<T>,
        [components, results]: [usize; 2],
        mut compute: impl FnMut(&[T], &mut [T]),
    ) {
        self.state.clear();
        self.state.resize(components, T::int(0));
        self.results.resize(results, T::int(0));
        for i in 0..batch.count {
            let rows = batch.states.chunks_exact(batch.stride);
            for (place, row) in self.state.iter_mut().zip(rows) {
                *place = row[i];
            }
            compute(&self.state, &mut self.results);
            let rows = batch.gradients.chunks_exact_mut(batch.stride);
            for (row, &result) in rows.zip(&self.results) {
                row[i] = result;
            }
        }
    }
}

/// # Panics
/// If a slice does not have this number of components.
pub(crate) fn check_components(n: usize, lengths: &[usize]) {
    assert!(
        lengths.iter().all(|&length| length == n),
        "a state of this system has {n} components"
    );
}

/// # Panics
/// If H is not T(p) + U(q).
#[inline(always)]
pub(crate) fn require_separable(is_separable: bool) {
    assert!(
        is_separable,
        "forces depend on the positions alone only if H = T(p) + U(q)"
    );
}
