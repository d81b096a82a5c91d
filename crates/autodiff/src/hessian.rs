//! [`HessianPlan`]: which directions give which entries of ∇²H.
//!
//! Columns are grouped by [`Colouring`]; the product of ∇²H with the sum of the unit vectors of a colour has
//! in row i the one entry (i, j) whose column j has that colour. Entry and mirror entry are read from the
//! same place, so the matrix is symmetric to the last bit. Cost: about four evaluations of H per colour.

use crate::Pattern;
use crate::colouring::Colouring;
use std::ops::Range;

/// Directions of one sweep.
pub(crate) const DIRECTIONS: usize = 4;

/// Where an entry is found after the sweep of its colour.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pickup {
    pub(crate) entry: u32,
    pub(crate) row: u32,
    pub(crate) direction: u32,
}

/// The sweeps that give every entry of ∇²H.
#[derive(Debug)]
pub(crate) struct HessianPlan {
    pub(crate) colours: usize,
    /// Colour of each input.
    pub(crate) of_column: Vec<Option<usize>>,
    pickups: Vec<Pickup>,
    /// Entry of each sweep in `pickups`.
    sweeps: Vec<Range<usize>>,
}

impl HessianPlan {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let Colouring { colours, of_column } = Colouring::new(pattern);
        let colour_of = |i: usize, j: usize| of_column[i.max(j)].unwrap_or(0);
        let entries = || (0..pattern.dimension()).flat_map(|i| pattern.row(i).map(move |e| (i, e)));
        let mut sweeps = vec![0..0; colours.div_ceil(DIRECTIONS)];
        for (i, (_, j)) in entries() {
            sweeps[colour_of(i, j) / DIRECTIONS].end += 1;
        }
        let mut end = 0;
        for sweep in &mut sweeps {
            // Empty; the pickups are put in one by one.
            let start = end;
            end += sweep.end;
            *sweep = start..start;
        }
        let nowhere = Pickup {
            entry: 0,
            row: 0,
            direction: 0,
        };
        let mut pickups = vec![nowhere; pattern.len()];
        for (i, (entry, j)) in entries() {
            let colour = colour_of(i, j);
            let sweep = &mut sweeps[colour / DIRECTIONS];
            pickups[sweep.end] = Pickup {
                entry: entry as u32,
                row: i.min(j) as u32,
                direction: (colour % DIRECTIONS) as u32,
            };
            sweep.end += 1;
        }
        HessianPlan {
            colours,
            of_column,
            pickups,
            sweeps,
        }
    }

    /// The pickups of each sweep; sweep k has the colours from k·[`DIRECTIONS`] on.
    pub(crate) fn sweeps(&self) -> impl Iterator<Item = &[Pickup]> {
        self.sweeps.iter().map(|range| &self.pickups[range.clone()])
    }
}
