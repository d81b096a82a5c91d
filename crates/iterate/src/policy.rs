//! Tuned constants of the iteration, each with the figure that chose it. Where it says "alike", 1680 cells of
//! `grid --quick` were run with both ends of the range: the mean error beside Gauss's, its 98 % and the work
//! differ by less than 2 %.

/// Contractions worse than this are slow. // ratio; an iteration then costs 7 for one digit, a factorisation
/// of any system of the grid costs less; 0.5 to 0.85 within 3 % of the work.
pub(crate) const SLOW: f64 = 0.7;
/// Changes of this share of a component or more are far from the solution: contractions seen there say
/// nothing of the rest. // ratio; without it Newton's method takes over a chain at rest that is kicked; 0.03
/// to 0.5 alike.
pub(crate) const FAR: f64 = 0.125;
/// Changes of so many ε that do not shrink are rounding. // ε; 16 lanes of 32 stages round to 60 ε; 64 to
/// 1024 alike.
pub(crate) const STAGE_ROUNDING: f64 = 256.0;
/// Changes of so many ε have rounding in them: iterations that are expected to change Z by more are
/// incremental. // ε; 8 to 256 within 3 % of the time, Kepler and a chain of 1024; with 4 the grid had not
/// ended in 4 minutes, 33 s otherwise.
pub(crate) const NOISY: f64 = 16.0;
/// A last change, and an error, of ε over this are of no account. // with 16 angular momentum of Kepler's
/// problem, e = 0.3, s = 4, drifts by 1e-19 a step, with 64 that of the outer solar system, s = 4, 200 days,
/// by 5 of a random walk in 10⁶ steps; 2 % more iterations than with 64; docs/adr/0021.
pub(crate) const SETTLED: f64 = 256.0;
/// Changes that do not shrink so many times in a row do not shrink, and what a change is worth at the end
/// point shows after so many linearised iterations. // iterations; with 2 Gauss does 4 % less, with 6 what it
/// does on the grid is 4.8 times as much, where it does not converge.
pub(crate) const STILL: u32 = 3;
/// Iterations of whatever is iterated: the stages of a step, linearised iterations, moves of the α_k. //
/// iterations
pub const MOST_ITERATIONS: u32 = 100;
/// L of a step is at most so many times that of the last. // ratio; without it Kepler's problem with 2.24
/// steps a period, s = 16, begins 100 orbits off in place of one, steps over a kink grazed by 1e-10 end
/// 2.6e-7 off in place of 1e-10, and rounding of a chain of 1024 is left to Newton's method.
pub(crate) const LIKELY: i64 = 8;
/// Products with (J∇²H)² for its largest eigenvalue. // iterations; ω to 3 % for chains, springs, 2 to 8
/// bodies and dense ∇²H, 200 random ones of each.
pub(crate) const ITERATIONS: u32 = 32;
/// Bounds of it that are tried before. // iterations; without them a step with α_k takes 1.2 times as long
/// for Kepler's problem, 1.7 times for a chain of 32. The fourth is within 4 % of ω for chains and springs,
/// 23 % for bodies, and tells nothing of dense ∇²H without a sign, up to 9.5 ω.
pub(crate) const BOUNDS: u32 = 4;
/// A linearised iteration is taken to contract by one over this at best, whatever its last two changes say.
/// // ratio; the leading terms of u_k cancel, and its changes shrink by more than the next ones will
pub(crate) const STEEPEST: i64 = 16;
