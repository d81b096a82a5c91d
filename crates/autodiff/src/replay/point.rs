//! Points one after the other, for functions that are not computed in lanes.

use equip_scalar::Float;

/// Workspace for one state and one gradient.
#[derive(Debug, Clone)]
pub(crate) struct Points<T> {
    state: Vec<T>,
    derivative: Vec<T>,
}

// Not derived, since `T` need not have a default.
impl<T> Default for Points<T> {
    fn default() -> Self {
        Points {
            state: Vec::new(),
            derivative: Vec::new(),
        }
    }
}

impl<T: Float> Points<T> {
    pub(crate) fn new(n: usize) -> Self {
        Points {
            state: vec![T::int(0); n],
            derivative: vec![T::int(0); n],
        }
    }

    /// Resizes the workspace for states and results of these lengths.
    pub(crate) fn make_room(&mut self, state: usize, results: usize) {
        self.state.resize(state, T::int(0));
        self.derivative.resize(results, T::int(0));
    }

    /// Calls `gradient` for each point of a batch that is stored component by component. If the batch has
    /// fewer components than a state, the remaining ones are 0.
    pub(crate) fn each(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
        mut gradient: impl FnMut(&[T], &mut [T]),
    ) {
        let components = states.len() / stride;
        self.state[components..].fill(T::int(0));
        for i in 0..count {
            for (place, row) in self.state.iter_mut().zip(states.chunks_exact(stride)) {
                *place = row[i];
            }
            gradient(&self.state, &mut self.derivative);
            for (row, &derivative) in gradients.chunks_exact_mut(stride).zip(&self.derivative) {
                row[i] = derivative;
            }
        }
    }
}

/// # Panics
/// If a batch does not have this number of components.
#[inline(always)]
pub(crate) fn check_batch(components: usize, lengths: [usize; 2], stride: usize, count: usize) {
    assert!(
        lengths == [components * stride; 2] && count <= stride,
        "a batch of this system has {components} components with room for {count} points each"
    );
}

/// # Panics
/// If there are not n components of states, and the entries of as many ∇²H: `rows`.
#[inline(always)]
pub(crate) fn check_hessians(rows: [usize; 2], lengths: [usize; 2], stride: usize, count: usize) {
    assert!(
        lengths == rows.map(|rows| rows * stride) && count <= stride,
        "a state of this system has {} components and its Hessian {} entries, with room for {count} points each",
        rows[0],
        rows[1]
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
