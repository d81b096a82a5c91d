//! Tuned constants of a step, each with the figure that chose it.

/// Moves of the α's of one step that may fail to halve what they are to remove: where the slopes all but
/// vanish, Broyden's correction needs some.
pub(crate) const MOST_STALLS: u32 = 4;

/// The largest floor of late loses 1 over this a step. // steps; floors swing by 30 within an oscillation of
/// some 10 to 50 steps.
pub(crate) const FADING: i64 = 64;
/// α's that move, at most. // α's; further ones disturb the stages the more for the same displacement of the
/// end point.
pub(crate) const LEADING: usize = 3;
/// The end point may move so many times as far as the defect of the step itself is worth, or as its local
/// error. // ratio; with 4 times the local error 9 % of the steps of 14 systems are carried, with 16 4 %;
/// errors beyond 3 of Gauss's are 6 and 10 % of the cells; docs/adr/0023.
pub(crate) const FARTHEST: i64 = 16;
/// It moves by 1 over this of its motion at most. // ratio; grid: the energy is 5.5 times as far off as with
/// Gauss at most, with 4 in its place 40 times, with 64 8.5 times.
pub(crate) const SMALL: i64 = 16;
/// Displacements of the end point of so many ε of the state are rounding. // ε; s = 2 and steps whose own
/// error is of that size: of 20 000 of Kepler's problem 45 % are carried without it or with 16, none with it;
/// with s ≥ 4, and on the grid, it is alike from 0 to 64.
pub(crate) const STATE_ROUNDING: i64 = 64;
/// A direction turns by so many times the share that the stages move, as its leading terms cancel, and comes
/// to rest by one over this a turn or better, or not at all. // ratio; 300 at a pericentre, s = 4; 1/50 a
/// turn where slopes nearly vanish.
pub(crate) const TURNS: i64 = 64;
/// A defect of so many floors that moves of the α's do not bring down is rounding. // floors
pub(crate) const STALLED: i64 = 8;
/// The ridge of the least-squares problem for the direction is the diagonal over this. // ratio; 1e2 to 1e4
/// alike on the grid.
pub(crate) const RIDGE: i64 = 1000;
/// A factorisation whose iteration contracts worse than this is made anew. // ratio
pub(crate) const OUTDATED: f64 = 0.1;
/// Steps for which a cheaper preconditioner that has failed is not tried again: 1, 2, 4, … up to this. //
/// steps
pub(crate) const LONGEST_WAIT: u64 = 64;
/// Springs are components whose ∂²U/∂q² outweighs the rest of its row so many times, …
pub(crate) const OUTWEIGHS: f64 = 4.0;
/// … and whose h² w κ is at least this. // (hω)²
pub(crate) const SOFTEST: f64 = 0.25;
/// Unknowns s·n up to which the stages are solved with ∇²H at each of them, by a dense matrix. // unknowns; 1
/// s a step beyond.
pub(crate) const MOST_DENSE: usize = 1024;
/// Matrices are sparse if at most one entry in so many is there. // ratio
pub(crate) const SPARSE_SHARE: usize = 8;
