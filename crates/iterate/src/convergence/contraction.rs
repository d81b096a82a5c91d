//! Convergence of the iteration Z ← Z + M⁻¹(K L(Z) − Z), judged by how its changes of Z shrink.
//!
//! Let Δ_n be the changes of Z relative to the sizes of the components, and ρ = Δ_n/Δ_{n−1} the contraction.
//! After iteration n the error of the end point is
//!
//! $$ \frac{\rho}{1-\rho}\,\Delta_n, \qquad \frac{\sqrt\rho}{1-\rho}\,\Delta_n $$
//!
//! The second formula holds if one iteration goes from the positions to the momenta and back: the end point
//! then lacks the second half only. ρ is the worst contraction observed in the step, but at least half the ρ
//! of the last step. A preconditioned iteration contracts differently at its beginning and at its end, so for
//! it ρ is the worse of the last two contractions.
//!
//! The iteration ends when Δ_n and this error are at most ε/256, or when the changes are at round-off level
//! and no longer shrink. They no longer shrink if three in a row exceed half of the previous change, or if a
//! dozen in a row exceed half of the smallest change so far. The second case occurs if Z runs through a cycle
//! of a few roundings. The bound holds for Δ_n itself because the last change alters a quadratic invariant
//! yᵀCy by 2 Σ_i L_iᵀ C Δ_n,i in the step; this does not average out over the steps (docs/adr/0021).

use crate::policy::{CONVERGED, FAR, NOISY, SLOW, STAGE_ROUNDING, STILL};
use equip_scalar::power::power;

/// The state of the iteration after a change of Z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The iteration continues.
    Contracts,
    /// Converged: Z solves the equations to round-off.
    Converged,
    /// The changes do not shrink.
    Diverges,
}

/// The changes of Z so far, and the estimates derived from them.
#[derive(Debug)]
pub struct Contraction {
    /// ε of the floating-point type.
    epsilon: f64,
    is_twofold: bool,
    is_preconditioned: bool,
    /// Changes up to this size are rounding if they do not shrink.
    rounding: f64,
    /// ρ, preserved from step to step.
    rate: f64,
    /// The worst contraction observed in the step; zero before the first.
    worst: f64,
    /// The product of the observed contractions, and their number.
    product: f64,
    seen: u32,
    /// The last observed contraction.
    last: f64,
    /// Δ_n, and Δ_n without its rounding.
    change: f64,
    left: f64,
    /// The iteration may end once the noise of y1 is at most this; zero to iterate to round-off.
    target: f64,
    /// The next change must not be compared with the last one.
    skips_comparison: bool,
    slow: u32,
    still: u32,
    /// The smallest change at round-off level so far, and how many changes since have not halved it.
    least: f64,
    stalled: u32,
}

impl Contraction {
    /// For iterations that go from positions to momenta and back (`is_twofold`), or that treat all components
    /// alike, in a floating-point type with this ε.
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

    /// Begins an iteration with M = I or another M.
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

    /// Sets the factor by which M⁻¹ amplifies the rounding of the stages compared with M = I.
    pub fn set_amplification(&mut self, amplification: f64) {
        let eps = self.epsilon;
        self.rounding = (STAGE_ROUNDING * eps * amplification.max(1.0)).min(eps.sqrt());
    }

    /// The iteration may end once the noise of y1 is at most `noise`; zero to iterate to round-off.
    pub fn set_target(&mut self, noise: f64) {
        self.target = noise;
    }

    /// Whether the noise of y1 has reached the target, by a contraction observed in this step.
    pub fn is_at_target(&self) -> bool {
        self.worst > 0.0 && self.noise() <= self.target
    }

    /// After a change of at most this size the next one is rounding, or noise below the target.
    pub(crate) fn last_change(&self) -> f64 {
        (NOISY * self.epsilon).max(self.target)
    }

    /// Called if Z was changed by anything but an iteration: the next change is not compared with the last
    /// one.
    pub fn disturb(&mut self) {
        self.skips_comparison = true;
        (self.slow, self.still) = (0, 0);
        (self.least, self.stalled) = (f64::INFINITY, 0);
    }

    /// Records that an iteration has changed Z by `change`. If `is_remeasured`, the sizes of the components
    /// were measured anew afterwards, and the next change is not compared with this one.
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
        let has_converged = is_known && error.max(self.left) <= eps / CONVERGED;
        if has_converged || self.still >= STILL || self.stalled >= 4 * STILL {
            Progress::Converged
        } else {
            Progress::Contracts
        }
    }

    /// The error of the end point after the last iteration.
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

    /// The rounding error of the end point after a converged iteration.
    pub fn noise(&self) -> f64 {
        if self.is_preconditioned {
            self.change
        } else {
            self.change * self.tail().min(1.0)
        }
    }

    /// The expected next change of Z.
    #[inline(always)]
    pub fn next_change(&self) -> f64 {
        self.left * self.rate
    }

    /// The last change of Z.
    pub fn change(&self) -> f64 {
        self.change
    }

    /// Whether the last change is so small that the linearisation at these stages is as good as at the
    /// solution.
    pub fn is_near(&self) -> bool {
        self.change <= self.epsilon.cbrt()
    }

    /// Whether the last change is of the order of the size of a component.
    pub fn is_far(&self) -> bool {
        self.change > FAR
    }

    /// The geometric mean of the contractions of the step, zero if none was observed. It determines the
    /// number of iterations. The first contraction reflects the error of the initial guess and may be many
    /// times larger than the others.
    pub fn mean(&self) -> f64 {
        if self.seen == 0 {
            0.0
        } else {
            power(self.product, 1.0 / f64::from(self.seen))
        }
    }

    /// ρ, the initial value for the next step.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Restores ρ.
    pub fn set_rate(&mut self, rate: f64) {
        self.rate = rate.clamp(0.0, 0.9);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes that shrink by a constant factor converge where the geometric series predicts it, and not
    /// before.
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
        assert!(seen.contains(&Progress::Converged), "{seen:?}");
    }

    /// Roundings may run through a cycle in which changes shrink as often as they grow.
    #[test]
    fn a_cycle_of_roundings_settles() {
        for cycle in [[6.0, 2.0, 6.0], [6.0, 6.0, 1.0], [6.0, 0.5, 2.0]] {
            let mut contraction = Contraction::new(true, f64::EPSILON);
            contraction.begin(true);
            // So slow that the geometric series needs a hundred further iterations.
            let begun = [1e-10, 9e-11, 8e-11].into_iter();
            let rounding = cycle.map(|x| x * f64::EPSILON);
            let changes = begun.chain(rounding.into_iter().cycle());
            let mut seen = changes.map(|change| contraction.observe(change, false));
            let made = seen.position(|progress| progress != Progress::Contracts);
            assert!(made.is_some_and(|made| made < 20), "{cycle:?}: {made:?}");
        }
    }

    /// If the components at rest have no size yet, the first change is not comparable with the second.
    #[test]
    fn changes_in_sizes_measured_anew_are_not_compared_with_those_of_before() {
        let mut contraction = Contraction::new(true, f64::EPSILON);
        contraction.begin(false);
        assert_eq!(contraction.observe(1e-20, true), Progress::Contracts);
        for change in [1e7, 1e-3, 1e-6, 1e-9] {
            assert_eq!(contraction.observe(change, false), Progress::Contracts);
        }
    }

    /// A change of Z by anything but the iteration is not a contraction.
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
