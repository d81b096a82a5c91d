//! ∇²H, appended to a recording of ∇H: the reverse sweep over each component of it.
//!
//! Row i is differentiated by the inputs up to i, and the other triangle is taken from it, so the matrix is
//! symmetric to the last bit. What rows have in common is done once. A sweep meets what its component depends
//! on, at most all of ∇H: the entries take no more operations than ∇H replayed on tangents takes for a
//! direction of each of them. Of chains it has 1.2 times the operations of ∇H, of bodies 3 times.

use super::reverse::Reverse;
use crate::Pattern;
use crate::recording::recorder::Recorder;

/// Appends the entries of the pattern of ∇²H; their nodes. `slopes` are those of ∇H. `None` if there are
/// more than `most` new operations.
pub(crate) fn hessian(
    recorder: &mut Recorder,
    derivatives: &[u32],
    pattern: &Pattern,
    most: usize,
) -> Option<Vec<u32>> {
    let mut reverse = Reverse::new(recorder);
    let most = reverse.recorder.nodes.len() + most;
    let zero = reverse.number(0.0);
    let mut entries = vec![zero; pattern.len()];
    for (row, &derivative) in derivatives.iter().enumerate() {
        for (column, node) in reverse.sweep_up_to(row as u32, derivative, |_, _| {}) {
            for (i, j) in [(row, column as usize), (column as usize, row)] {
                // What is not in the pattern is zero.
                if let Some(place) = pattern.place(i, j) {
                    entries[place] = node;
                }
            }
        }
        if reverse.recorder.nodes.len() > most {
            return None;
        }
    }
    Some(entries)
}
