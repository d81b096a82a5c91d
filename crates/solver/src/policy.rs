//! Tuned constants of a step, each with the figure that decided its value. "Alike" means: in 1680 cells of
//! `grid --quick`, run with both ends of the range, the mean error relative to Gauss, its 98th percentile and
//! the work differ by less than 2 %.

/// The maximum number of updates of α in one step that do not halve the energy error. Where the derivatives
/// by α nearly vanish, Broyden's correction needs some. // updates; with 1 Kepler's problem, e = 0.6, s = 4,
/// returns from 1000 steps forward and back with an error of 5e-7 instead of 3e-10; with 16 15 of 1320 cells
/// differ.
pub(crate) const MOST_STALLS: u32 = 4;

/// The largest recent round-off level decreases by one over this a step. // steps; levels vary by a factor of
/// 30 within an oscillation of 10 to 50 steps; 16 to 256 alike.
pub(crate) const FADING: i64 = 64;
/// The maximum number of parameters α_k that change, unless there are more constraints. // α_k; further ones
/// change the stages more for the same displacement of the end point; with 2, 3, 5 and all of them the errors
/// on the grid are .71, .68, .67 and .74 of those of Gauss, the work 1.42, 1.44, 1.46 and 1.48; with all of
/// them 1.4 % more steps are uncorrected.
pub(crate) const LEADING: usize = 3;
/// The largest admissible change of y1, relative to the local error of the step or to the change that the
/// energy error of the step itself requires. // ratio; with 4 times the local error 9 % of the steps of 14
/// systems are uncorrected, with 16 4 %; the errors of 6 % and 10 % of the cells exceed 3 times those of
/// Gauss; docs/adr/0023.
pub(crate) const FARTHEST: i64 = 16;
/// The change of y1 is at most one over this of the change over the step. // ratio; on the grid the energy
/// error is at most 5.5 times that of Gauss; with 4 40 times, with 64 8.5 times.
pub(crate) const SMALL: i64 = 16;
/// Displacements of the end point of at most this many ε of the state are rounding. // ε; s = 2 and steps
/// whose own error is of that size: of 20 000 steps of Kepler's problem 45 % are uncorrected without it or
/// with 16, none with 64; with s ≥ 4, and on the grid, 0 to 64 are alike.
pub(crate) const STATE_ROUNDING: i64 = 64;
/// An update of t may use constraints whose error due to the noise of y1 is at most one over this of their
/// residual. The update leaves about the same share of the residual. // ratio; with 100 Kepler's problem, e =
/// 0.3, s = 4, h = 0.3, takes 2.2 updates a step instead of 1.9, and more iterations
pub(crate) const SHARE: i64 = 1000;
/// An energy error of at most this many round-off levels that updates of α do not reduce is rounding. //
/// levels; with 1 0.5 % more steps are uncorrected, with 32 0.2 % fewer; errors and work are alike.
pub(crate) const STALLED: i64 = 8;
/// The ridge parameter of the least-squares problem for the search direction is one over this, relative to
/// the diagonal. // ratio; 1e2 to 1e4 alike on the grid; with 10, 1000 steps of Kepler's problem, e = 0.6,
/// return with an error of 7.5e-6 instead of 3e-10.
pub(crate) const RIDGE: i64 = 1000;
/// The waiting time before a less expensive preconditioner that has failed is tried again: 1, 2, 4, … up to
/// this. // steps; a trial costs about 10 iterations, less than 2 % of the iterations of so many steps; 8 to
/// 512 alike.
pub(crate) const LONGEST_WAIT: u64 = 64;
/// The largest number of unknowns s·n for which the stages are solved with ∇²H at each stage, by a dense
/// matrix. // unknowns; 1 s a step beyond.
pub(crate) const MOST_DENSE: usize = 1024;
/// A matrix is treated as sparse if at most one entry in this many is non-zero. // ratio
pub(crate) const SPARSE_SHARE: usize = 8;
