//! Tuned constants of the iteration, each with the figure that decided its value. "Alike" means: in 1680
//! cells of `grid --quick`, run with both ends of the range, the mean error relative to Gauss, its 98th
//! percentile and the work differ by less than 2 %.

/// A contraction above this is slow. // ratio; the iteration then takes 7 iterations for one digit, and a
/// factorisation for any system of the grid costs less; from 0.5 to 0.85 the work varies by 3 %.
pub(crate) const SLOW: f64 = 0.7;
/// If a change of Z is at least this share of a component, the iteration is far from the solution, and its
/// contraction does not predict the following ones. // ratio; without it Newton's method takes over for a
/// chain at rest that is kicked; 0.03 to 0.5 alike.
pub(crate) const FAR: f64 = 0.125;
/// A change of at most this many ε that does not shrink is rounding. // ε; 16 lanes of 32 stages round to 60
/// ε; 64 to 1024 alike.
pub(crate) const STAGE_ROUNDING: f64 = 256.0;
/// A change of at most this many ε contains rounding. An iteration whose expected change of Z is larger is
/// incremental. // ε; from 8 to 256 the time varies by 3 % (Kepler, chain of 1024); with 4 the grid did not
/// end in 4 minutes, against 33 s otherwise.
pub(crate) const NOISY: f64 = 16.0;
/// The iteration has converged if its last change and its error are at most ε over this. // ratio; with 16
/// the angular momentum of Kepler's problem, e = 0.3, s = 4, drifts by 1e-19 a step; with 64 that of the
/// outer solar system, s = 4, 200 days, drifts by 5 times a random walk in 10⁶ steps; 2 % more iterations
/// than with 64; docs/adr/0021.
pub(crate) const CONVERGED: f64 = 256.0;
/// If this many changes in a row do not shrink, the changes do not shrink. After as many linearised
/// iterations their effect on the end point is known. // iterations; with 2 Gauss takes 4 % fewer iterations;
/// with 6 it takes 4.8 times as many on the grid, spent where it does not converge.
pub(crate) const STILL: u32 = 3;
/// The maximum number of iterations for the stages of a step, the linearised equations, and the updates of
/// the α_k. // iterations
pub const MOST_ITERATIONS: u32 = 100;
/// The largest ratio of L of a step to L of the last step. // ratio; without it Kepler's problem with 2.24
/// steps a period, s = 16, starts with an error of 100 orbits instead of one; steps over a discontinuity
/// grazed by 1e-10 end with an error of 2.6e-7 instead of 1e-10; and the rounding of a chain of 1024 is left
/// to Newton's method.
pub(crate) const LIKELY: i64 = 8;
/// The number of products with (J∇²H)² to compute its largest eigenvalue. // iterations; ω has an error of 3
/// % for chains, stiff modes, 2 to 8 bodies and dense ∇²H, 200 random ones of each.
pub(crate) const ITERATIONS: u32 = 32;
/// The number of upper bounds of ω computed before the power iteration decides. // iterations; without them a
/// step with α_k takes 1.2 times as long for Kepler's problem, 1.7 times for a chain of 32; the fourth bound
/// is within 4 % of ω for chains and stiff modes, 23 % for bodies, and useless for dense ∇²H with mixed
/// signs: up to 9.5 ω.
pub(crate) const BOUNDS: u32 = 4;
/// A linearised iteration is assumed to contract by at best one over this, even if its last two changes
/// shrink faster. // ratio; the leading terms of u_k cancel, so its changes shrink by more than the following
/// ones do
pub(crate) const STEEPEST: i64 = 16;
