//! [`EnergyRoundOff`]: the round-off level of H compared with the energies, during the run and at its end.
//!
//! A step conserves the energy to the current round-off level, the running error bound of H. In two cases
//! this is meaningless. First, the level may be large compared with the energies themselves. Second, the
//! level was large for a short time, as in a passage close to a singularity, and the error of that time is
//! still there when the energies are small again. The second case shows at the end of the run only: the final
//! error is compared with the energies just before the end, and with the final round-off level.

use crate::control::policy::{MOST_ROUND_OFF, RECENT, STALE_LEVELS};
use equip_scalar::Float;

/// The largest round-off level of the energy over the steps that conserved it, and the energies for
/// comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyRoundOff<T> {
    /// The round-off level, in the unit of H; |H − H_ref| for a quadratic H, for which α is not solved.
    pub round_off: T,
    /// The time at the end of the step with the largest level.
    pub time: T,
    /// |H_ref|; or, if the level exceeds √ε |H_ref|, the largest kinetic energy ½ |Σ p_i ∂H/∂p_i| since then,
    /// if that is larger.
    pub scale: T,
    /// The round-off level at the end of the last step that conserved the energy; zero for a quadratic H with
    /// an error of at most √ε |H_ref|.
    pub last: T,
    /// The time average of the kinetic energy, with most weight on the time before the end. Zero as long as
    /// no level exceeds √ε |H_ref|; |H_ref| is then large compared with every error.
    pub recent_kinetic: T,
    /// Whether H and all products of a component with its derivative were below the smallest normal number at
    /// the start of the run, although their factors were not zero. The value of H is then meaningless.
    pub underflows: bool,
}

impl<T: Float> EnergyRoundOff<T> {
    /// For a run that begins at time `t` and state `y`, where H is `h_ref` and ∇H is `gradient`.
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

    /// Whether an error below the level means that the energy was conserved: the level is at most 1e-6 of the
    /// scale. Also true if H = 0 at rest and the level is finite.
    pub fn is_small(&self) -> bool {
        let is_rest = self.scale == T::int(0) && self.round_off.is_finite() && !self.underflows;
        is_rest || self.round_off <= self.scale * T::ratio(1, MOST_ROUND_OFF)
    }

    /// Whether the final `error` of the energy is small compared with the recent energies: at most 1e-6 of
    /// them, and at most √ε of them unless it is at the final round-off level. H was `h_ref` at the start of
    /// the run.
    pub fn is_small_at_end(&self, error: T, h_ref: T) -> bool {
        let (error, energies) = (error.abs(), h_ref.abs().max(self.recent_kinetic));
        let is_recent =
            error <= self.last * T::int(STALE_LEVELS) || error <= energies * T::EPSILON.sqrt();
        let is_small = error <= energies * T::ratio(1, MOST_ROUND_OFF);
        error == T::int(0) || (is_small && is_recent)
    }

    /// Records a step that ended at time `t` with this round-off level. H had the initial value `h_ref`. The
    /// `kinetic` energy is evaluated only if it matters; its weight is the `share` of the step in the run.
    pub(crate) fn see(
        &mut self,
        (t, share): (T, T),
        (round_off, h_ref): (T, T),
        kinetic: impl FnOnce() -> T,
    ) {
        self.last = round_off;
        // NaN is final.
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

/// ½ |Σ p_i ∂H/∂p_i| over the first `m` momenta of y = (q, p), from ∇H at y.
pub(crate) fn kinetic_energy<T: Float>(y: &[T], gradient: &[T], m: usize) -> T {
    let half = y.len() / 2;
    let terms = y[half..][..m].iter().zip(&gradient[half..][..m]);
    let sum = terms.fold(T::int(0), |sum, (&p, &v)| sum + p * v);
    sum.abs() / T::int(2)
}
