//! Columns of ∇²H that can be computed together.
//!
//! Two columns without a common row can share one direction: the product of ∇²H with the sum of their unit
//! vectors has the entries of both, side by side (Curtis, Powell, Reid 1974). Greedy in the order of the
//! columns. Cost: the sum over the rows of their squared numbers of entries.

use crate::Pattern;

/// A direction for every column; columns without entries have none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Colouring {
    pub(crate) colours: usize,
    pub(crate) of_column: Vec<Option<usize>>,
}

impl Colouring {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let n = pattern.dimension();
        let length = |i: usize| pattern.row_starts[i + 1] - pattern.row_starts[i];
        let used = (0..n).filter(|&i| length(i) > 0).count();
        // A full row makes every two columns meet: nothing to search for.
        let full_row = (0..n).any(|i| used > 0 && length(i) == used);
        let mut of_column: Vec<Option<usize>> = vec![None; n];
        let mut colours = 0;
        let mut seen_by = Vec::new();
        for column in (0..n).filter(|&i| length(i) > 0) {
            let colour = if full_row {
                colours
            } else {
                for (_, row) in pattern.row(column) {
                    for colour in pattern.row(row).filter_map(|(_, other)| of_column[other]) {
                        seen_by[colour] = column;
                    }
                }
                seen_by
                    .iter()
                    .position(|&by| by != column)
                    .unwrap_or(colours)
            };
            if colour == colours {
                colours += 1;
                seen_by.push(usize::MAX);
            }
            of_column[column] = Some(colour);
        }
        Colouring { colours, of_column }
    }
}
