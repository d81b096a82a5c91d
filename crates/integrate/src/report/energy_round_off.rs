//! [`EnergyRoundOff`]: the round-off level of H compared with the energies, during the run and at its end.
//!
//! A step conserves the energy to the round-off level of the moment: the running error bound of H there. Two
//! things can make that an empty word. The level may be large compared with the energies themselves. Or it
//! was large for a moment, as in a passage close to a singularity, and the error of that moment is still
//! there when the energies are small again. The second shows at the end of the run only: the error at the
//! end is compared with the energies of the time before the end, and with the round-off level at the end.

use crate::control::policy::{MOST_ROUND_OFF, RECENT, STALE_LEVELS};
use equip_scalar::Float;

/// The largest round-off level of the energy over the steps that conserved it, and what it is compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyRoundOff<T> {
    /// The round-off level, in the unit of H. Of a quadratic H, for which nothing is solved, |H − H_ref|.
    pub round_off: T,
    /// Time of the step at whose end it was largest.
    pub time: T,
    /// |H_ref|; where the level is beyond √ε of that, the largest kinetic energy ½ |Σ p_i ∂H/∂p_i| seen
    /// since, if it is larger.
    pub scale: T,
    /// The round-off level at the end of the last step that conserved the energy.
    pub last: T,
    /// The mean kinetic energy over time, in which the time before the end counts most. Zero as long as no
    /// level is beyond √ε of |H_ref|, which then is large compared with any error.
    pub recent_kinetic: T,
    /// Whether H and all products of a component with its derivative were below the smallest normal number
    /// where the run began, though not zero by their factors: what H is then shows nothing.
    pub underflows: bool,
}

impl<T: Float> EnergyRoundOff<T> {
    /// Of a run that begins at time `t` and the state `y`, where H is `h_ref` and ∇H the `gradient`.
    pub(crate) fn new(t: T, h_ref: T, (y, gradient): (&[T], &[T])) -> Self {
        let zero = T::int(0);
        let mut factors = y.iter().zip(gradient);
        let is_zero = |(&x, &g): (&T, &T)| x == zero || g == zero;
        let is_normal = |(&x, &g): (&T, &T)| (x * g).abs() >= T::MIN_POSITIVE;
        let underflows = h_ref.abs() < T::MIN_POSITIVE
            && !factors.clone().all(is_zero)
            && !factors.any(is_normal);
        EnergyRoundOff {
            round_off: T::int(0),
            time: t,
            scale: h_ref.abs(),
            last: T::int(0),
            recent_kinetic: T::int(0),
            underflows,
        }
    }

    /// Whether an error below the level says that the energy was conserved: the level is at most 1e-6 of the
    /// scale. At rest where H = 0 there is nothing to lose.
    pub fn is_small(&self) -> bool {
        let is_rest = self.scale == T::int(0) && self.round_off.is_finite() && !self.underflows;
        is_rest || self.round_off <= self.scale * T::ratio(1, MOST_ROUND_OFF)
    }

    /// Whether an `error` of the energy at the end of the run, where H was `h_ref` at its start, is small
    /// compared with the energies of the time before: at most 1e-6 of them, and at most √ε of them unless it
    /// is the round-off level of the end.
    pub fn is_small_at_end(&self, error: T, h_ref: T) -> bool {
        let (error, energies) = (error.abs(), h_ref.abs().max(self.recent_kinetic));
        let is_recent =
            error <= self.last * T::int(STALE_LEVELS) || error <= energies * T::EPSILON.sqrt();
        let is_small = error <= energies * T::ratio(1, MOST_ROUND_OFF);
        error == T::int(0) || (is_small && is_recent)
    }

    /// A step has ended at time `t` with this round-off level, where H began with `h_ref`. The `kinetic`
    /// energy there is evaluated only if it matters; it counts by the `share` of the run that the step is.
    pub(crate) fn see(
        &mut self,
        (t, share): (T, T),
        (round_off, h_ref): (T, T),
        kinetic: impl FnOnce() -> T,
    ) {
        self.last = round_off;
        // Once NaN, always.
        if !(round_off <= self.round_off) && self.round_off.is_finite() {
            (self.round_off, self.time) = (round_off, t);
        }
        if !(self.round_off <= h_ref.abs() * T::EPSILON.sqrt()) {
            let kinetic = kinetic();
            self.scale = self.scale.max(kinetic);
            let weight = (T::int(RECENT) * share).min(T::int(1));
            self.recent_kinetic += (kinetic - self.recent_kinetic) * weight;
        }
    }
}

/// ½ |Σ p_i ∂H/∂p_i| over the first `m` momenta of y = (q, p), from ∇H there.
pub(crate) fn kinetic_energy<T: Float>(y: &[T], gradient: &[T], m: usize) -> T {
    let half = y.len() / 2;
    let terms = y[half..][..m].iter().zip(&gradient[half..][..m]);
    let sum = terms.fold(T::int(0), |sum, (&p, &v)| sum + p * v);
    sum.abs() / T::int(2)
}
