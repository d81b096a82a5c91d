//! Tuned constants of runs, each with the figure that chose it.

/// Aim below the tolerance, and below a target. // ratio; with 0.95 errors of a revolution (Kepler, 18
/// settings) go up to 7.1 tolerances from 5.4.
pub(crate) const SAFETY: f64 = 0.9;
/// Estimates up to this many tolerances are accepted: the size is within 19 % (s = 4), 9 % (s = 8) of what it
/// should be. // ratio; with 10 80 of 2480 steps are refused in place of 118 (Kepler, e = 0.9, s = 8, 1e-12),
/// and the error after 100 revolutions is 1.2e-11 in place of 3.8e-12.
pub(crate) const ACCEPTED: f64 = 4.0;
/// A size is foretold from an error, and from what limits the motion, at most so many times as long or as
/// short, and the first step is at most so many times as long as the motion takes to turn. // ratio; 7100
/// runs of 30 systems from random starts take .2 % fewer gradients with 2 and 3, and have .77 and .97 of the
/// error; growing by up to 1000 takes 1 % more and has 1.05 times the error; docs/adr/0005
pub(crate) const MOST_CHANGE: f64 = 4.0;
/// Contraction, per power of the step size, at which iterations cost least for the time they cover: twice the
/// size takes three times the iterations, as the start is foretold worse, and the α_k that remove a larger
/// defect disturb the stages more. // ratio; 228 runs of 19 systems take as many gradients to 5 % from 0.041
/// to 0.058; docs/adr/0005
pub(crate) const CHEAPEST: f64 = 0.045;
/// A tolerance that allows steps so many times as long as fixed-point iterations are made for asks for
/// Newton's method. // ratio; the same runs are alike with 32 to 1e6, and have 2.4 times the error for as
/// many gradients with 8; with 128 fast motion below `atol` takes 24 times the gradients
pub(crate) const NEWTON: f64 = 32.0;
/// Contractions above this may be those of motion that steps do not resolve. // ratio; at hω = s fixed-point
/// iterations contract by .5 and more; 2 of 300 random problems had hω beyond s unseen without it.
pub(crate) const SLOW: f64 = 0.25;
/// Coefficients of so many ε of the largest are rounding, and no end of a decay. // ε; with 0 runs of 5 of 10
/// scenes do not come on with 12 stages and a tolerance of 1e-15.
pub(crate) const NOISE: f64 = 1024.0;
/// Tries of whatever is tried again: of a first step, of a step up to switches, of a size that meets a rule
/// or a target, of a root. // tries; 7100 runs of 30 systems from random starts are the same with 12 and 50
pub(crate) const MOST_TRIES: u32 = 25;
/// A small part of a step is one over this. // ratio; the same runs take as many gradients to .1 % with 64;
/// with 4 they do not end in four times the time
pub(crate) const PART: i64 = 16;
/// Sizes and times within so many units of the last place are the same, and slopes within so many times the
/// running error bound of ∇H. // ε; 24 runs of stiff springs and of bodies 10⁸ from the origin, with 0, 1, 4
/// and 16 times the bound: 19, 0, 0 and 0 do not come on; docs/adr/0024
pub(crate) const ROUNDING: i64 = 16;
/// A step that meets the first knot of a table within one over this of its size is halved before it is made
/// to end there, until it would be so many times as short: many knots are passed over by steps that are not.
/// // ratio; docs/adr/0017
pub(crate) const SOON: i64 = 8;
/// Force or speed that has grown by this factor nears a singularity, and sizes that control goes down to are
/// at least one over this of those that fixed steps fail with. // ratio; of a pericentre e = 0.9 it is 361,
/// of what stops steps at the resolution of time 1e10 and more; with 16 three stages at 1e-12 on U = −q⁶ end
/// at a singularity.
pub(crate) const GROWN: i64 = 1000;
/// A motion whose |q| grows by a factor e in so many steps of the size that fails escapes. // steps
pub(crate) const ESCAPING: i64 = 4;
/// A round-off level beyond one over this of the energies makes "kept" an empty word. // ratio; of resolved
/// motion in doubles are below 1e-12, and where 10⁹ times as much as is left cancels within H, 1e-6.
pub(crate) const MOST_ROUND_OFF: i64 = 1_000_000;
/// A trial whose error is the target over no more than this will do. // ratio
pub(crate) const GOOD_ENOUGH: i64 = 8;
/// Parts of a step shorter than one over this may have event functions that are noise, and the first try is
/// at least such a part of the time in which the motion turns. // ratio; the same runs alike with 16 and 256
pub(crate) const SHORT: i64 = 64;
/// H is compared on both sides of a switch at one over this of a step from it. // ratio; at tolerance 1e-4
/// the end of a step is 1e-7 of it from the switch; jumps are told that are 1e-5 of what H bends by in one.
pub(crate) const BESIDE: i64 = 1 << 16;
/// In the mean over time of an energy the last part of a run counts so many times as much as in the plain
/// mean. // ratio; the first half of a run has 1/256 of the weight, with 4 in its place 1/16
pub(crate) const RECENT: i64 = 8;
/// An error of the energy at the end of a run of so many round-off levels of its last step is of that level.
/// // levels; errors of steps just conserved are at most 8
pub(crate) const STALE_LEVELS: i64 = 64;
