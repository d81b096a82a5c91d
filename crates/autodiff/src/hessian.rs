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
        let mut by_colour: Vec<(usize, Pickup)> = Vec::with_capacity(pattern.len());
        for i in 0..pattern.dimension() {
            for (entry, j) in pattern.row(i) {
                if let Some(colour) = of_column[i.max(j)] {
                    let direction = (colour % DIRECTIONS) as u32;
                    let row = i.min(j) as u32;
                    by_colour.push((
                        colour / DIRECTIONS,
                        Pickup {
                            entry: entry as u32,
                            row,
                            direction,
                        },
                    ));
                }
            }
        }
        by_colour.sort_by_key(|&(sweep, _)| sweep);
        let mut sweeps = Vec::new();
        let mut start = 0;
        for group in by_colour.chunk_by(|x, y| x.0 == y.0) {
            sweeps.push(start..start + group.len());
            start += group.len();
        }
        let pickups = by_colour.into_iter().map(|(_, pickup)| pickup).collect();
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
