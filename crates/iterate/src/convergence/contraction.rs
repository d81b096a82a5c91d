//! How far an iteration Z ← Z + M⁻¹(K L(Z) − Z) is from its solution, by how its changes of Z shrink.
//!
//! With changes Δ_n of Z relative to the sizes of the components and a contraction ρ = Δ_n/Δ_{n−1} the error
//! that the last one leaves is
//!
//! $$ \frac{\rho}{1-\rho}\,\Delta_n, \qquad \frac{\sqrt\rho}{1-\rho}\,\Delta_n $$
//!
//! in the end point: the second where one iteration goes from the positions to the momenta and back, of which
//! the end point has had the first half only. ρ is the worst seen in the step; preconditioned iterations do
//! not begin as they end, so of these it is the worse of the last two.
//!
//! The iteration goes on until Δ_n and that error are ε/256, or the changes no longer shrink: three in a row
//! are above half of the one before, or a dozen above half of the smallest so far, as where Z goes round in a
//! cycle of a few roundings.
//! Σ_i Δ_n,i · C L_i is what a quadratic invariant yᵀCy is off by, and that is alike from step to step.

use crate::policy::{FAR, NOISY, SETTLED, SLOW, STAGE_ROUNDING, STILL};
use equip_scalar::power::power;

/// What a change of Z says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The iteration continues.
    Contracts,
    /// Z solves the equations to rounding.
    Settled,
    /// The changes do not shrink.
    Diverges,
}

/// Changes of Z so far, and what follows from them.
#[derive(Debug)]
pub struct Contraction {
    /// ε of the floats.
    epsilon: f64,
    is_twofold: bool,
    is_preconditioned: bool,
    /// Changes that are rounding if they do not shrink.
    rounding: f64,
    /// ρ, kept from step to step.
    rate: f64,
    /// The worst contraction seen in the step, zero if none was.
    worst: f64,
    /// The product of those seen, and how many they were.
    product: f64,
    seen: u32,
    /// The last one.
    last: f64,
    /// Δ_n, and the same without its rounding.
    change: f64,
    left: f64,
    /// Noise at y1 that is low enough; zero where the iteration goes to round-off.
    target: f64,
    /// The next change is not to be compared with the last.
    skips_comparison: bool,
    slow: u32,
    still: u32,
    /// The smallest change that is rounding so far, and how many have not halved it.
    least: f64,
    stalled: u32,
}

impl Contraction {
    /// Of iterations through positions and momenta in turn, or of all components at once, in floats with this
    /// ε.
    pub fn new(is_twofold: bool, epsilon: f64) -> Self {
        Contraction {
            epsilon,
            is_twofold,
            is_preconditioned: false,
            rounding: STAGE_ROUNDING * epsilon,
            rate: 0.5,
            worst: 0.0,
            product: 1.0,
            seen: 0,
            last: 0.0,
            change: f64::INFINITY,
            left: f64::INFINITY,
            target: 0.0,
            skips_comparison: true,
            slow: 0,
            still: 0,
            least: f64::INFINITY,
            stalled: 0,
        }
    }

    /// An iteration begins, with M = I or another M.
    pub fn begin(&mut self, is_preconditioned: bool) {
        self.is_preconditioned = is_preconditioned;
        self.set_amplification(1.0);
        self.rate /= 2.0;
        (self.worst, self.last) = (0.0, 0.0);
        (self.product, self.seen) = (1.0, 0);
        (self.change, self.left) = (f64::INFINITY, f64::INFINITY);
        (self.slow, self.still) = (0, 0);
        (self.least, self.stalled) = (f64::INFINITY, 0);
        self.skips_comparison = true;
    }

    /// M⁻¹ makes so many times as much of the rounding of the stages as M = I does.
    pub fn set_amplification(&mut self, amplification: f64) {
        let eps = self.epsilon;
        self.rounding = (STAGE_ROUNDING * eps * amplification.max(1.0)).min(eps.sqrt());
    }

    /// Noise at y1 that is low enough; zero where the iteration goes to round-off.
    pub fn set_target(&mut self, noise: f64) {
        self.target = noise;
    }

    /// Whether the noise at y1 is that low, by a contraction that was seen in the step.
    pub fn is_at_target(&self) -> bool {
        self.worst > 0.0 && self.noise() <= self.target
    }

    /// A change that the next iteration leaves as rounding, or as noise that is low enough.
    pub(crate) fn last_change(&self) -> f64 {
        (NOISY * self.epsilon).max(self.target)
    }

    /// Something else has moved Z: the next change is not to be compared with the last.
    pub fn disturb(&mut self) {
        self.skips_comparison = true;
        (self.slow, self.still) = (0, 0);
        (self.least, self.stalled) = (f64::INFINITY, 0);
    }

    /// An iteration has changed Z by `change`; of sizes that were measured anew since the last one
    /// `is_remeasured`.
    #[inline(always)]
    pub fn observe(&mut self, change: f64, is_remeasured: bool) -> Progress {
        let eps = self.epsilon;
        let last = self.change;
        let compares = !self.skips_comparison;
        self.skips_comparison = is_remeasured;
        if compares && last > STAGE_ROUNDING * eps {
            let ratio = change / last;
            self.slow = if ratio > SLOW { self.slow + 1 } else { 0 };
            if last <= FAR {
                let (before, kept) = if self.is_preconditioned {
                    (self.last, 0.0)
                } else {
                    (self.worst, self.rate)
                };
                (self.worst, self.last) = (ratio.max(before), ratio);
                self.product = (self.product * ratio).max(f64::MIN_POSITIVE);
                self.seen += 1;
                self.rate = self.worst.max(kept).min(0.9);
            }
        }
        self.left = if compares && change <= NOISY * eps {
            change.min(self.left * self.rate)
        } else {
            change
        };
        self.change = change;
        let is_small = change <= self.rounding;
        let grows = self.slow > 1 && change > 2.0 * last;
        if !change.is_finite() || (!is_small && (self.slow >= STILL || grows)) {
            return Progress::Diverges;
        }
        let stagnates = is_small && compares && change > last / 2.0;
        self.still = if stagnates { self.still + 1 } else { 0 };
        if is_small {
            let halves = change <= self.least / 2.0;
            self.stalled = if halves { 0 } else { self.stalled + 1 };
            self.least = self.least.min(change);
        }
        let error = self.error();
        let is_known = compares || self.worst > 0.0 || (change <= 4.0 * eps && !is_remeasured);
        let is_settled = is_known && error.max(self.left) <= eps / SETTLED;
        if is_settled || self.still >= STILL || self.stalled >= 4 * STILL {
            Progress::Settled
        } else {
            Progress::Contracts
        }
    }

    /// Error of the end point that the last iteration has left.
    #[inline(always)]
    fn error(&self) -> f64 {
        self.left * self.tail()
    }

    #[inline(always)]
    fn tail(&self) -> f64 {
        let share = if self.is_twofold {
            self.rate.sqrt()
        } else {
            self.rate
        };
        share / (1.0 - self.rate)
    }

    /// Rounding at the end point, of an iteration that has settled.
    pub fn noise(&self) -> f64 {
        if self.is_preconditioned {
            self.change
        } else {
            self.change * self.tail().min(1.0)
        }
    }

    /// The next change of Z, as far as can be told.
    #[inline(always)]
    pub fn next_change(&self) -> f64 {
        self.left * self.rate
    }

    /// The last change of Z.
    pub fn change(&self) -> f64 {
        self.change
    }

    /// The last change is so small that what is linearised at these stages is as good as at the solution.
    pub fn is_near(&self) -> bool {
        self.change <= self.epsilon.cbrt()
    }

    /// The last change is of the size of a component or so.
    pub fn is_far(&self) -> bool {
        self.change > FAR
    }

    /// The geometric mean of the contractions of the step, zero if none was seen: what its iterations cost.
    /// The first of them says what the guess was off by, and may be many times the others.
    pub fn mean(&self) -> f64 {
        if self.seen == 0 {
            0.0
        } else {
            power(self.product, 1.0 / f64::from(self.seen))
        }
    }

    /// ρ, which the next step begins from.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Sets ρ as it was kept.
    pub fn set_rate(&mut self, rate: f64) {
        self.rate = rate.clamp(0.0, 0.9);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes that shrink by a known factor settle where the geometric series says, and not before.
    #[test]
    fn a_geometric_series_settles_when_its_tail_is_below_rounding() {
        for ratio in [0.5, 0.1, 1e-2] {
            let mut contraction = Contraction::new(false, f64::EPSILON);
            contraction.begin(false);
            let (mut change, mut made) = (1e-3, 0);
            while contraction.observe(change, false) == Progress::Contracts {
                change *= ratio;
                made += 1;
                assert!(made < 80);
            }
            let tail = change * ratio / (1.0 - ratio);
            assert!(tail <= f64::EPSILON / 16.0, "ratio {ratio}: {tail:e}");
            assert!(
                tail / ratio / ratio > f64::EPSILON / 1e3,
                "ratio {ratio}: {tail:e}"
            );
        }
    }

    #[test]
    fn what_does_not_shrink_diverges_unless_it_is_rounding() {
        let mut contraction = Contraction::new(true, f64::EPSILON);
        contraction.begin(false);
        let seen: Vec<_> = [1e-3, 9e-4, 8.5e-4, 8e-4]
            .map(|x| contraction.observe(x, false))
            .to_vec();
        assert_eq!(seen[3], Progress::Diverges);
        contraction.begin(false);
        assert_eq!(contraction.observe(1e-3, false), Progress::Contracts);
        assert_eq!(contraction.observe(f64::NAN, false), Progress::Diverges);
        contraction.begin(false);
        let seen = [1e-8, 1e-13, 2e-15, 2e-15, 2e-15, 2e-15].map(|x| contraction.observe(x, false));
        assert!(seen.contains(&Progress::Settled), "{seen:?}");
    }

    /// Rounding may go round in a cycle that shrinks as often as it grows.
    #[test]
    fn a_cycle_of_roundings_settles() {
        for cycle in [[6.0, 2.0, 6.0], [6.0, 6.0, 1.0], [6.0, 0.5, 2.0]] {
            let mut contraction = Contraction::new(true, f64::EPSILON);
            contraction.begin(true);
            // Slow enough that the geometric series takes a hundred more.
            let begun = [1e-10, 9e-11, 8e-11].into_iter();
            let rounding = cycle.map(|x| x * f64::EPSILON);
            let changes = begun.chain(rounding.into_iter().cycle());
            let mut seen = changes.map(|change| contraction.observe(change, false));
            let made = seen.position(|progress| progress != Progress::Contracts);
            assert!(made.is_some_and(|made| made < 20), "{cycle:?}: {made:?}");
        }
    }

    /// Where components at rest have no size yet, the first change says nothing of the second.
    #[test]
    fn changes_in_sizes_measured_anew_are_not_compared_with_those_of_before() {
        let mut contraction = Contraction::new(true, f64::EPSILON);
        contraction.begin(false);
        assert_eq!(contraction.observe(1e-20, true), Progress::Contracts);
        for change in [1e7, 1e-3, 1e-6, 1e-9] {
            assert_eq!(contraction.observe(change, false), Progress::Contracts);
        }
    }

    /// A move of Z by something else is not a contraction.
    #[test]
    fn what_else_moves_z_is_not_compared() {
        let mut contraction = Contraction::new(false, f64::EPSILON);
        contraction.begin(false);
        contraction.observe(1e-2, false);
        contraction.observe(1e-3, false);
        contraction.disturb();
        contraction.observe(0.1, false);
        assert!((contraction.mean() - 0.1).abs() < 1e-9);
    }
}
