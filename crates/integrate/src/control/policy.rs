//! Tuned constants of runs, each with the figure that decided its value.

/// The step controller and the search for a step aim at this fraction of the tolerance or target. // ratio;
/// with 0.95 the errors after one revolution (Kepler, 18 settings) rise from 5.4 to 7.1 tolerances.
pub(crate) const SAFETY: f64 = 0.9;
/// Estimates up to this many tolerances are accepted. The size is then within 19 % (s = 4) or 9 % (s = 8) of
/// the right one. // ratio; with 10, 80 of 2480 steps are rejected instead of 118 (Kepler, e = 0.9, s = 8,
/// 1e-12), and the error after 100 revolutions is 1.2e-11 instead of 3.8e-12.
pub(crate) const ACCEPTED: f64 = 4.0;
/// The largest ratio of successive sizes, in both directions, whether it follows from an error or from a
/// singularity. The first step is at most this many turning times. // ratio; 7100 runs of 30 systems from
/// random initial states take .2 % fewer gradients with 2 and 3, with .77 and .97 times the error; growth by
/// up to 1000 takes 1 % more gradients, with 1.05 times the error; docs/adr/0005
pub(crate) const MOST_CHANGE: f64 = 4.0;
/// The contraction, per power of the step size, with the least work per unit of time. Twice the size takes
/// three times the iterations, since the initial guess is worse and the α_k that remove a larger energy error
/// change the stages more. // ratio; for 228 runs of 19 systems the number of gradients varies by 5 % from
/// 0.041 to 0.058; docs/adr/0005
pub(crate) const CHEAPEST: f64 = 0.045;
/// If a tolerance allows steps this many times as long as those with the least work by fixed-point iteration,
/// Newton's method is used. // ratio; the same runs are alike with 32 to 1e6, and have 2.4 times the error
/// for as many gradients with 8; with 128 fast motion below `atol` takes 24 times the gradients
pub(crate) const NEWTON: f64 = 32.0;
/// A contraction above this may belong to motion that the steps do not resolve. // ratio; at hω = s the
/// contraction of the fixed-point iteration is .5 and more; without it 2 of 300 random problems had
/// undetected hω > s.
pub(crate) const SLOW: f64 = 0.25;
/// Coefficients of at most this many ε of the largest are rounding; they are not the end of a decay. // ε;
/// with 0 runs of 5 of 10 scenes with 12 stages and a tolerance of 1e-15 make no progress.
pub(crate) const NOISE: f64 = 1024.0;
/// The maximum number of attempts: for a first step, a step up to switches, a size that meets a rule or a
/// target, a root. // attempts; 7100 runs of 30 systems from random initial states are the same with 12 and
/// 50
pub(crate) const MOST_TRIES: u32 = 25;
/// A small part of a step is one over this. // ratio; the same runs take as many gradients to .1 % with 64;
/// with 4 they do not end in four times the time
pub(crate) const PART: i64 = 16;
/// Sizes and times within this many units of the last place are equal, and vector field values within this
/// many times the running error bound of ∇H. // ε; of 24 runs of stiff springs and of bodies 10⁸ from the
/// origin, 19, 0, 0 and 0 make no progress with 0, 1, 4 and 16 times the bound; docs/adr/0024
pub(crate) const ROUNDING: i64 = 16;
/// A step that meets the first knot of a table within one over this of its size is halved before it is
/// shortened to end at the knot, until it is this many times as short: steps that are not shortened further
/// pass over many knots. // ratio; docs/adr/0017
pub(crate) const SOON: i64 = 8;
/// A force or speed that has grown by this factor indicates a singularity. Step control gives up at sizes
/// down to one over this of those at which fixed steps fail. // ratio; at a pericentre with e = 0.9 the
/// growth is 361; where steps reach the resolution of time it is 1e10 and more; with 16 three stages at 1e-12
/// on U = −q⁶ end with the error of a singularity.
pub(crate) const GROWN: i64 = 1000;
/// A motion escapes if |q| grows by a factor e within this many steps of the size that fails. // steps
pub(crate) const ESCAPING: i64 = 4;
/// If the round-off level exceeds one over this of the energies, conservation to round-off is meaningless. //
/// ratio; for resolved motion in `f64` the level is below 1e-12 of the energies; where terms 10⁹ times as
/// large as H cancel it is 1e-6.
pub(crate) const MOST_ROUND_OFF: i64 = 1_000_000;
/// A trial ends the search if its error is between the target over this and the target. // ratio
pub(crate) const GOOD_ENOUGH: i64 = 8;
/// In parts of a step shorter than one over this, event functions may be noise. The first step is at least
/// this part of the turning time. // ratio; the same runs are alike with 16 and 256
pub(crate) const SHORT: i64 = 64;
/// H is compared on both sides of a switch at one, two and three times this part of a step, which is one over
/// it. // ratio; at tolerance 1e-4 the end of a step is 1e-7 of the step away from the switch; docs/adr/0017
pub(crate) const BESIDE: i64 = 1 << 16;
/// In the time average of an energy the last part of a run has this many times the weight that it has in the
/// plain average. // ratio; the first half of a run has 1/256 of the weight, with 4 1/16
pub(crate) const RECENT: i64 = 8;
/// An energy error at the end of a run of at most this many round-off levels of its last step is at the
/// round-off level. // levels; errors of steps that have just conserved H are at most 8
pub(crate) const STALE_LEVELS: i64 = 64;
/// The longest step after an event has changed the state, in times between the last two changes. // ratio;
/// 120 random bounces and boxes, 11 436 events: with 1, 3/2, 2, 4 20 028, 16 488, 15 654, 14 236 steps, of
/// which 2199, 0, 21, 0 end on the next event and leave a step of rounding; with 4 the energy error is 37
/// times as large
pub(crate) const LONGEST_SINCE: f64 = 1.5;
