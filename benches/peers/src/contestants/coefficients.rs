//! [`Composition`]: coefficients γ_i of symmetric compositions of a symmetric method of order 2.
//!
//! One step of size h is Φ_{γ_1 h} ∘ … ∘ Φ_{γ_r h} with r odd, γ_i = γ_{r+1−i} and Σ γ_i = 1. With the
//! Störmer–Verlet method as Φ these are the explicit methods that EQUIP is compared with. They also compute
//! the reference end states of problems without a closed-form solution.
//!
//! The coefficients solve polynomial systems that have no closed-form solution. The published decimals are
//! used: 25 digits (order 8) and 32 digits (order 10).

use equip::scalar::Float;

/// A composition: its order, its name, and the first half of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Composition {
    /// The name for display.
    pub name: &'static str,
    /// The order of the composed method.
    pub order: u32,
    /// γ_1 … γ_⌈r/2⌉.
    half: &'static [&'static str],
}

impl Composition {
    /// γ_1 … γ_r.
    pub fn gammas<T: Float>(&self) -> Vec<T> {
        let read = |text: &&str| T::decimal(text).unwrap_or(T::NAN);
        let half: Vec<T> = self.half.iter().map(read).collect();
        half.iter()
            .chain(half.iter().rev().skip(1))
            .copied()
            .collect()
    }
}

/// s17odr8a (Kahan, Li, "Composition constants for raising the orders of unconventional schemes for ordinary
/// differential equations", Math. Comp. 66 (1997); Hairer, Lubich, Wanner, V.3.2).
pub const KAHAN_LI: Composition = Composition {
    name: "Kahan–Li 8",
    order: 8,
    half: &[
        "0.13020248308889008087881763",
        "0.56116298177510838456196441",
        "-0.38947496264484728640807860",
        "0.15884190655515560089621075",
        "-0.39590389413323757733623154",
        "0.18453964097831570709183254",
        "0.25837438768632204729397911",
        "0.29501172360931029887096624",
        "-0.60550853383003451169892108",
    ],
};

/// Order 10 with 35 stages (Sofroniou, Spaletta, "Derivation of symmetric composition constants for symmetric
/// integrators", Optim. Methods Softw. 20 (2005)).
pub const SOFRONIOU_SPALETTA: Composition = Composition {
    name: "Sofroniou–Spaletta 10",
    order: 10,
    half: &[
        "0.078795722521686419263907679337684",
        "0.31309610341510852776481247192647",
        "0.027918383235078066109520273275299",
        "-0.22959284159390709415121339679655",
        "0.13096206107716486317465685927961",
        "-0.26973340565451071434460973222411",
        "0.074973343155891435666137105641410",
        "0.11199342399981020488957508073640",
        "0.36613344954622675119314812353150",
        "-0.39910563013603589787862981058340",
        "0.10308739852747107731580277001372",
        "0.41143087395589023782070411897608",
        "-0.0048663605831352617621956593099771",
        "-0.39203335370863990644808193642610",
        "0.051942502962449647037182904015976",
        "0.050665090759924496335874344156866",
        "0.049674370639729879054568800279461",
        "0.049317735759594537917680008339338",
    ],
};

#[cfg(test)]
mod tests {
    use super::{Composition, KAHAN_LI, SOFRONIOU_SPALETTA};
    use equip::scalar::{DoubleDouble, Float};

    type D = DoubleDouble;

    fn power_sum(scheme: &Composition, k: i32) -> f64 {
        let sum = (scheme.gammas::<D>().into_iter()).fold(D::int(0), |s, g| s + g.powi(k));
        let expected = D::int(i64::from(k == 1));
        (sum - expected).to_f64().abs()
    }

    /// Σ γ_i = 1, and Σ γ_i^k = 0 for odd k below the order: necessary conditions. The orders themselves are
    /// measured by tests that run the methods.
    #[test]
    fn odd_power_sums_vanish() {
        for (scheme, bound) in [(KAHAN_LI, 3e-25), (SOFRONIOU_SPALETTA, 2e-31)] {
            assert_eq!(scheme.gammas::<D>().len(), 2 * scheme.half.len() - 1);
            for k in (1..scheme.order as i32).step_by(2) {
                let off = power_sum(&scheme, k);
                assert!(off < bound, "{}, k = {k}: {off:e}", scheme.name);
            }
        }
    }

    #[test]
    fn they_read_the_same_backwards() {
        for scheme in [KAHAN_LI, SOFRONIOU_SPALETTA] {
            let gammas = scheme.gammas::<f64>();
            assert!(gammas.iter().eq(gammas.iter().rev()), "{}", scheme.name);
        }
    }
}
