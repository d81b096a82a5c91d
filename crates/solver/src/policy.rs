//! Tuned constants of a step, each with the figure that chose it. Where it says "alike", 1680 cells of `grid
//! --quick` were run with both ends of the range: the mean error beside Gauss's, its 98 % and the work differ
//! by less than 2 %.

/// Updates of α in one step that may fail to halve the energy error: where the derivatives by α all but
/// vanish, Broyden's correction needs some. // updates; with 1 Kepler's problem, e = 0.6, s = 4, returns from
/// 1000 steps and back to 5e-7 in place of 3e-10; with 16 15 of 1320 cells differ.
pub(crate) const MOST_STALLS: u32 = 4;

/// The largest recent round-off level loses 1 over this a step. // steps; levels vary by a factor of 30
/// within an oscillation of some 10 to 50 steps; 16 to 256 alike.
pub(crate) const FADING: i64 = 64;
/// α_k that change, at most, unless there are more constraints. // α_k; further ones disturb the stages the
/// more for the same displacement of the end point. Grid: errors are .71, .68, .67 and .74 of Gauss's with 2,
/// 3, 5 and all of them, work 1.42, 1.44, 1.46, 1.48; with all 1.4 % of the steps more are uncorrected.
pub(crate) const LEADING: usize = 3;
/// The change of y1 may be so many times that which the energy error of the step itself needs, or its local
/// error. // ratio; with 4 times the local error 9 % of the steps of 14 systems are uncorrected, with 16 4 %;
/// errors beyond 3 of Gauss's are 6 and 10 % of the cells; docs/adr/0023.
pub(crate) const FARTHEST: i64 = 16;
/// It moves by 1 over this of its motion at most. // ratio; grid: the energy is 5.5 times as far off as with
/// Gauss at most, with 4 in its place 40 times, with 64 8.5 times.
pub(crate) const SMALL: i64 = 16;
/// Displacements of the end point of so many ε of the state are rounding. // ε; s = 2 and steps whose own
/// error is of that size: of 20 000 of Kepler's problem 45 % are uncorrected without it or 16, none with it;
/// with s ≥ 4, and on the grid, it is alike from 0 to 64.
pub(crate) const STATE_ROUNDING: i64 = 64;
/// Noise of y1 that changes a constraint by one over this of its error does not show in an update of t, which
/// leaves about as little of the error. // ratio; with 100 Kepler's problem, e = 0.3, s = 4, h = 0.3, takes
/// 2.2 updates a step in place of 1.9, and more iterations
pub(crate) const SHARE: i64 = 1000;
/// An energy error of so many round-off levels that updates of α do not reduce is rounding. // levels; with 1
/// 0.5 % of the steps more are uncorrected, with 32 0.2 % fewer, errors and work alike.
pub(crate) const STALLED: i64 = 8;
/// The ridge of the least-squares problem for the direction is the diagonal over this. // ratio; 1e2 to 1e4
/// alike on the grid; with 10 1000 steps of Kepler's problem, e = 0.6, return to 7.5e-6 in place
/// of 3e-10.
pub(crate) const RIDGE: i64 = 1000;
/// Steps for which a cheaper preconditioner that has failed is not tried again: 1, 2, 4, … up to this. //
/// steps; a trial costs some 10 iterations, less than 2 % of those of so many steps; 8 to 512 alike.
pub(crate) const LONGEST_WAIT: u64 = 64;
/// Unknowns s·n up to which the stages are solved with ∇²H at each of them, by a dense matrix. // unknowns; 1
/// s a step beyond.
pub(crate) const MOST_DENSE: usize = 1024;
/// Matrices are sparse if at most one entry in so many is there. // ratio
pub(crate) const SPARSE_SHARE: usize = 8;
