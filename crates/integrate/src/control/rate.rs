//! The rate ϱ at which the Legendre coefficients of a component decay, from the sizes of a few of them. The
//! formulas are in control/estimate.rs.
//!
//! ϱ of the step is the largest ϱ of its components. Whether a further component has a larger ϱ is decided by
//! comparing powers; roots are computed only if it has.

use equip_scalar::power::{exp2, log2, power};

/// The sizes of the coefficients of one component, in units of its change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    /// |γ_1|.
    pub(crate) second: f64,
    /// |γ_{s−2}|, but at least of degree 1.
    pub(crate) before: f64,
    /// |γ_{s−1}|.
    pub(crate) last: f64,
    /// |γ_s|.
    pub(crate) next: f64,
    /// g, the larger one of |γ_s| and |γ_{s+1}|.
    pub(crate) tail: f64,
    /// Whether g exceeds rounding and the tolerance.
    pub(crate) has_tail: bool,
}

/// The largest ϱ of the components so far.
#[derive(Debug)]
pub(crate) struct Rate {
    s: usize,
    pub(crate) largest: f64,
    /// ϱ^{s−2}, ϱ^{s−1} and ϱ^s.
    powers: [f64; 3],
}

impl Rate {
    /// No component yet; s ≥ 2.
    pub(crate) fn new(s: usize) -> Self {
        let (largest, powers) = (0.0, [0.0; 3]);
        Rate { s, largest, powers }
    }

    /// Includes a further component; `None` if its coefficients are not finite.
    pub(crate) fn raise(&mut self, sizes: Option<&Sizes>) {
        let Some(x) = sizes else {
            self.largest = f64::INFINITY;
            return;
        };
        let [second_last, before_last, last] = self.powers;
        let exceeds =
            |unit: f64, [at, after]: [f64; 2]| x.last > unit * at || x.next > unit * after;
        if exceeds(1.0, [before_last, last]) && exceeds(x.second, [second_last, before_last]) {
            let [last, next, second] = [x.last, x.next, x.second].map(log2);
            let degree = self.s as f64;
            let first = (last / (degree - 1.0)).max(next / degree);
            let after = (next - second) / (degree - 1.0);
            let decays = match self.s {
                2 => after,
                _ => after.max((last - second) / (degree - 2.0)),
            };
            self.raise_to(exp2(first.min(decays)));
        }
        if x.has_tail {
            // Two coefficients, since one may vanish: 92 of 2400 steps are rejected instead of 450.
            let r = (x.tail / x.last).min((x.tail / x.before).sqrt()).min(1.0);
            let error = x.tail / (x.second / r).max(1.0) * whole(r, self.s);
            let last = self.powers[2];
            if error > last * last {
                self.raise_to(power(error, 0.5 / self.s as f64));
            }
        }
    }

    fn raise_to(&mut self, rate: f64) {
        if rate > self.largest {
            self.largest = rate;
            let second_last = whole(rate, self.s - 2);
            let before_last = second_last * rate;
            self.powers = [second_last, before_last, before_last * rate];
        }
    }
}

/// xⁿ.
fn whole(x: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |product, _| product * x)
}

#[cfg(test)]
mod tests {
    use super::{Rate, Sizes, whole};

    /// Coefficients ϱ^k.
    fn sizes(s: usize, rate: f64) -> Sizes {
        let size = |k: usize| whole(rate, k);
        Sizes {
            second: size(1),
            before: size((s - 2).max(1)),
            last: size(s - 1),
            next: size(s),
            tail: size(s),
            has_tail: true,
        }
    }

    #[test]
    fn the_largest_of_components_in_any_order() {
        for s in [2, 3, 8, 12] {
            let rates = [0.01, 0.3, 0.2, 0.29999, 0.02];
            let mut found = Rate::new(s);
            for rate in rates {
                found.raise(Some(&sizes(s, rate)));
            }
            assert!(
                (found.largest / 0.3 - 1.0).abs() < 1e-7,
                "{}",
                found.largest
            );
            found.raise(None);
            assert_eq!(found.largest, f64::INFINITY);
        }
    }

    /// Even and odd motions, in which every other coefficient is zero, and no motion.
    #[test]
    fn coefficients_that_vanish() {
        let zero = Sizes {
            second: 0.0,
            before: 0.0,
            last: 0.0,
            next: 0.0,
            tail: 0.0,
            has_tail: false,
        };
        let mut rate = Rate::new(8);
        rate.raise(Some(&zero));
        assert_eq!(rate.largest, 0.0);
        rate.raise(Some(&Sizes { last: 1e-7, ..zero }));
        assert!((rate.largest / 0.1 - 1.0).abs() < 1e-7);
        rate.raise(Some(&Sizes {
            next: 0.2_f64.powi(8),
            ..zero
        }));
        assert!((rate.largest / 0.2 - 1.0).abs() < 1e-7);
    }

    /// A tail that hardly decays counts with its own ratio: (g/max(1, a_1/r)) r^s.
    #[test]
    fn a_decay_that_has_ended_is_not_extrapolated() {
        let mut rate = Rate::new(4);
        rate.raise(Some(&Sizes {
            second: 0.1,
            before: 1e-3,
            last: 1e-3,
            next: 9e-4,
            tail: 9e-4,
            has_tail: true,
        }));
        let error = 9e-4 * 0.9_f64.powi(4);
        let expected = error.powf(0.125);
        assert!((rate.largest / expected - 1.0).abs() < 1e-7);
    }
}
