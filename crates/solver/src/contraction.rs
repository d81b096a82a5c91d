//! How the sweeps of a step contract, and what they have left: sizes, for which doubles will do in any float.
//!
//! A sweep that changes Z by Δ and contracts by ρ leaves an error of Δρ/(1 − ρ). ρ is the worst contraction seen in the step, no less
//! than half of what it was in the last; sweeps from far off, which change Z by 1/8 of its size and more, say nothing of it. Near round-off
//! Δ is noise and says no more how far the stages are: Δ of the sweep before, times ρ, does, which saves half a sweep a step.
//!
//! The stages have settled when the error that is left at the end point is below ε/64, or Δ, near round-off, no longer shrinks and that error is
//! below ε, or Δ does not shrink three times.

use equip_scalar::Float;
use std::marker::PhantomData;

/// Contraction at which Newton is the better choice.
const SLOW: f64 = 0.7;
/// What is allowed of the contraction at the beginning of a step: a change of this many times the first.
const ALLOWANCE: f64 = 16.0;
/// Sweeps are not taken to contract by more than this in advance.
const LEAST: f64 = 1000.0;
/// Changes of Z above 1 over this of its size are far from those that the contraction holds for.
pub(crate) const FAR: f64 = 8.0;
/// Changes of Z below this many ε are rounding if they do not shrink.
const ROUNDING: f64 = 256.0;
/// Changes of Z below this many ε have their share of rounding.
const NOISY: f64 = 16.0;
/// Errors of the end point below ε over this are of no account. With 4 angular momentum grows by 1e-17 a step in Kepler's problem, with
/// 64 not at all, for 0.4 sweeps more.
const SETTLED: f64 = 64.0;
/// Changes of Z in the last digits that do not shrink so many times in a row do not shrink.
const STILL: u32 = 3;

#[derive(Debug)]
pub(crate) struct Contraction<T> {
    /// A sweep is two, from the positions to the momenta and back: ρ is the product of both, and what is left at the end point has had the first only.
    is_twofold: bool,
    /// The worst contraction seen in the step, or where the first sweeps are not like the last the worse of the last two; 0 if none was.
    pub(crate) seen: f64,
    /// The last.
    last: f64,
    /// The sweeps solve for stiff springs: the first are not like the last.
    has_springs: bool,
    /// The α's have moved by slopes: what is seen since is no matter of the sweeps before.
    is_new: bool,
    /// ρ.
    pub(crate) rate: f64,
    /// Error of the end point over the change of Z, and the ρ that it was told by.
    tail: f64,
    tail_of: f64,
    /// The last change of Z, and what it is without its noise.
    pub(crate) change: f64,
    left: f64,
    /// The next change is not to be compared with the last: the sweeps have begun anew, or something else has moved Z.
    is_apart: bool,
    /// The largest change allowed, if the sweeps contract on the whole.
    allowed: Option<f64>,
    /// Sweeps in a row that contracted slowly, and that stood still.
    slow: u32,
    still: u32,
    is_settled: bool,
    /// Z has changed by as much as its size or so.
    pub(crate) is_far: bool,
    float: PhantomData<T>,
}

impl<T: Float> Contraction<T> {
    #[inline(always)]
    fn epsilon() -> f64 {
        T::EPSILON.to_f64()
    }

    pub(crate) fn new(is_twofold: bool) -> Self {
        let zero = 0.0;
        let mut new = Contraction {
            is_twofold,
            seen: zero,
            last: zero,
            has_springs: false,
            is_new: false,
            rate: zero,
            tail: zero,
            tail_of: zero,
            change: zero,
            left: zero,
            is_apart: true,
            allowed: None,
            slow: 0,
            still: 0,
            is_settled: false,
            is_far: false,
            float: PhantomData,
        };
        new.set_rate(0.5);
        new
    }

    pub(crate) fn set_rate(&mut self, rate: f64) {
        self.rate = rate.min(0.9);
    }

    /// Error of the end point over the change of Z.
    #[inline(always)]
    fn tail(&mut self) -> f64 {
        if self.tail_of != self.rate {
            let share = if self.is_twofold {
                self.rate.sqrt()
            } else {
                self.rate
            };
            (self.tail, self.tail_of) = (share / (1.0 - self.rate), self.rate);
        }
        self.tail
    }

    /// A step begins, with springs or without.
    pub(crate) fn begin(&mut self, has_springs: bool) {
        self.has_springs = has_springs;
        self.set_rate((self.rate / 2.0).max(1.0 / LEAST));
        self.begin_anew();
    }

    /// It begins once more, from Z = 0.
    pub(crate) fn begin_from_nothing(&mut self) {
        self.set_rate(0.25);
        self.begin_anew();
    }

    fn begin_anew(&mut self) {
        (self.seen, self.last) = (0.0, 0.0);
        (self.change, self.left) = (f64::INFINITY, f64::INFINITY);
        (self.is_apart, self.is_settled) = (true, false);
        (self.slow, self.still) = (0, 0);
        self.is_far = false;
        self.is_new = false;
        self.allowed = None;
    }

    /// The next change is not to be compared with the last.
    pub(crate) fn disturb(&mut self) {
        self.is_apart = true;
    }

    /// The same, and what it has done to Z goes away like no error before: K is another.
    pub(crate) fn renew(&mut self) {
        self.disturb();
        self.last = 0.0;
        self.is_new = true;
    }

    /// A sweep that is not to be compared with others has changed Z.
    pub(crate) fn jump(&mut self, change: f64) {
        (self.change, self.left, self.is_apart) = (change, change, true);
    }

    /// Z has changed by `change`, and by `last` before.
    #[inline(always)]
    fn contract(&mut self, change: f64, last: f64) {
        if self.has_springs || self.is_new {
            let now = change / last;
            self.seen = now.max(std::mem::replace(&mut self.last, now));
            self.set_rate(self.seen.max(1.0 / LEAST));
            return;
        }
        // Without branches: no processor foretells which sweep contracts worst.
        let zero = 0.0;
        let now = if last <= 1.0 / FAR {
            change / last
        } else {
            zero
        };
        self.seen = if now > self.seen { now } else { self.seen };
        let most = self.seen.min(0.9);
        self.rate = if most > self.rate { most } else { self.rate };
    }

    /// What [`Self::see`] does with most changes: those above rounding that are at most half of the last. Returns whether this is one of them; of
    /// others it sees nothing.
    #[inline(always)]
    pub(crate) fn see_plain(&mut self, change: f64) -> bool {
        let (last, eps) = (self.change, Self::epsilon());
        let Some(allowed) = self.allowed else {
            return self.see_first(change);
        };
        let allowed = allowed * SLOW;
        let contracts = (change <= last / 2.0) & (change <= allowed);
        if self.is_apart | !contracts | !(change > NOISY * eps) {
            return false;
        }
        if last > ROUNDING * eps {
            self.contract(change, last);
            self.slow = 0;
        }
        self.allowed = Some(allowed);
        (self.change, self.left) = (change, change);
        (self.still, self.is_settled) = (0, false);
        true
    }

    /// The same of the first change of a step, if that is above rounding.
    #[inline(always)]
    fn see_first(&mut self, change: f64) -> bool {
        let is_first = !self.change.is_finite();
        if !is_first | !(change > NOISY * Self::epsilon()) | !change.is_finite() {
            return false;
        }
        self.allowed = Some(ALLOWANCE * change);
        (self.change, self.left, self.is_apart) = (change, change, false);
        (self.still, self.is_settled) = (0, false);
        self.is_far = change > 1.0 / FAR;
        true
    }

    /// The same of changes that are rounding to a good part, which may be the last.
    #[inline(always)]
    fn see_rounding(&mut self, change: f64) -> bool {
        let (last, eps) = (self.change, Self::epsilon());
        if self.is_apart | !last.is_finite() | !(change <= NOISY * eps) {
            return false;
        }
        if last > ROUNDING * eps {
            self.contract(change, last);
            self.slow = 0;
        }
        let left = self.left * self.rate;
        self.left = if left < change { left } else { change };
        self.change = change;
        self.settle(true, change > last / 2.0);
        true
    }

    /// Whether the stages have settled, by an error that was `observed` or not, and a change that `stagnates` or not.
    #[inline(always)]
    fn settle(&mut self, observed: bool, stagnates: bool) {
        let (error, eps) = (self.error(), Self::epsilon());
        self.still = if stagnates { self.still + 1 } else { 0 };
        self.is_settled = (observed & (error <= eps / SETTLED))
            | (stagnates & (error <= eps))
            | self.stands_still();
    }

    /// A sweep has changed Z by `change`, and with it perhaps what it is relative to. Returns whether it is worth while to go on; before
    /// anything but sweeps has moved Z (`alone`) it is not if they do not contract on the whole.
    #[inline(always)]
    pub(crate) fn see(&mut self, change: f64, is_remeasured: bool, alone: bool) -> bool {
        (!is_remeasured && (self.see_rounding(change) || self.see_plain(change)))
            || self.see_any(change, is_remeasured, alone)
    }

    fn see_any(&mut self, change: f64, is_remeasured: bool, alone: bool) -> bool {
        let eps = Self::epsilon();
        let (last, is_first) = (self.change, !self.change.is_finite());
        let is_apart = std::mem::replace(&mut self.is_apart, is_remeasured);
        let compares = !is_first && !is_apart;
        let is_rounding = change <= ROUNDING * eps;
        if compares && last > ROUNDING * eps {
            let is_slow = change > last * SLOW;
            self.slow = if is_slow { self.slow + 1 } else { 0 };
            self.contract(change, last);
        }
        let allowed = match self.allowed {
            Some(allowed) => allowed * SLOW,
            None => ALLOWANCE * change,
        };
        // The first change from nothing is relative to sizes that were not known yet.
        self.allowed = (!(is_first && is_remeasured)).then_some(allowed);
        let grows = self.slow > 1 && change > 2.0 * last;
        // Not one sweep after the other, perhaps, but on the whole.
        let behind = alone && !is_rounding && change > allowed;
        if self.slow > 2 || grows || behind || !change.is_finite() {
            self.change = change;
            return false;
        }
        self.left = if compares && change <= NOISY * eps {
            change.min(self.left * self.rate)
        } else {
            change
        };
        self.change = change;
        self.is_far |= change > 1.0 / FAR;
        // Rounding, and sweeps contract well enough for it not to be blown up.
        let stagnates = is_rounding && (compares || is_first) && change > last / 2.0;
        // What is relative to sizes that were not known yet says nothing.
        let observed = !is_first || (change <= 4.0 * eps && !is_remeasured);
        self.settle(observed, stagnates);
        true
    }

    /// What the last sweep has left of an error at the end point.
    pub(crate) fn error(&mut self) -> f64 {
        self.left * self.tail()
    }

    /// Rounding at the end point, of stages that have settled.
    pub(crate) fn noise(&mut self) -> f64 {
        let left = (self.change * self.tail()).min(self.change);
        if self.has_springs {
            // Sweeps that solve for stiff springs contract what is off, not what rounding the forces makes anew.
            left.max(self.change.min(NOISY * Self::epsilon()))
        } else {
            left
        }
    }

    /// The stages are there, as far as sweeps can take them.
    pub(crate) fn is_settled(&self) -> bool {
        self.is_settled
    }

    /// The stages no longer come nearer.
    pub(crate) fn stands_still(&self) -> bool {
        self.still == STILL
    }

    /// The next change of Z, as far as can be told.
    #[inline(always)]
    pub(crate) fn next_change(&self) -> f64 {
        self.left * self.rate
    }

    /// The error that it leaves.
    pub(crate) fn next_error(&mut self) -> f64 {
        self.next_change() * self.tail()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first two changes tell the contraction; one that the sizes or the α's have part in does not, nor one from far off.
    #[test]
    fn the_worst_contraction_is_seen() {
        let mut contraction = Contraction::<f64>::new(false);
        contraction.begin(false);
        assert!(contraction.see(1.0, false, true));
        assert_eq!(contraction.seen, 0.0);
        assert!(contraction.see(0.125, false, true));
        assert_eq!(contraction.seen, 0.0, "from far off");
        assert!(contraction.is_far);
        assert!(contraction.see(0.015625, false, true));
        assert_eq!(contraction.seen, 0.125);
        contraction.disturb();
        assert!(contraction.see(0.0625, false, false));
        assert_eq!(contraction.seen, 0.125);
        assert!(contraction.see(0.03125, false, false));
        assert_eq!((contraction.seen, contraction.rate), (0.5, 0.5));
    }

    /// Where all begins at rest positions the first change is relative to anything, and what it allows says nothing of the second.
    #[test]
    fn sizes_that_were_not_known_allow_nothing() {
        let mut contraction = Contraction::<f64>::new(true);
        contraction.begin(false);
        assert!(contraction.see(0.125, true, true));
        assert!(contraction.see(7.0, true, true));
        assert!(contraction.see(0.25, false, true));
        assert_eq!(contraction.seen, 0.0);
        contraction.begin(false);
        assert!(contraction.see(0.125, false, true));
        assert!(!contraction.see(7.0, true, true));
    }

    /// What is seen in a few operations is what is seen by all of them.
    #[test]
    fn the_short_ways_see_the_same() {
        let sequences: [&[f64]; 5] = [
            &[1e-3, 1e-5, 2e-8, 1e-11, 3e-14, 2e-16],
            &[0.7, 0.3, 0.2, 0.19, 1e-2, 1e-4],
            &[1e-15, 3e-16, 2e-16, 2e-16, 2e-16],
            &[1e-6, f64::INFINITY],
            &[1e-9, 1e-12, 4e-15, 3e-15, 5e-15],
        ];
        for springs in [false, true] {
            for changes in sequences {
                let mut pair = [Contraction::<f64>::new(true), Contraction::new(true)];
                pair.iter_mut().for_each(|c| c.begin(springs));
                for &change in changes {
                    let [short, long] = &mut pair;
                    let seen = short.see(change, false, true);
                    assert_eq!(seen, long.see_any(change, false, true), "{changes:?}");
                    if change <= 16.0 * f64::EPSILON {
                        // What is allowed above rounding is nobody's concern below.
                        long.allowed = short.allowed;
                    }
                    assert_eq!(short.tail(), long.tail(), "{changes:?}");
                    assert_eq!(format!("{short:?}"), format!("{long:?}"), "{changes:?}");
                }
            }
        }
    }

    /// Near round-off it is by the contraction that the stages are known to be there, not by the noise of the last change.
    #[test]
    fn noise_is_no_error() {
        let eps = f64::EPSILON;
        let mut contraction = Contraction::<f64>::new(false);
        contraction.set_rate(0.0);
        contraction.begin(false);
        for change in [1e-8, 1e-10, 1e-12, 1e-14] {
            assert!(contraction.see(change, false, true) && !contraction.is_settled());
        }
        assert!(contraction.see(2.0 * eps, false, true));
        assert!(contraction.is_settled());
        assert!(contraction.error() < eps / 64.0 && eps / 64.0 < contraction.noise());
    }
}
