//! log₂, 2ˣ and xᵃ to eight digits, by + − × ÷ alone, with the same bits on every machine.
//!
//! The step controller needs few digits, but a step size that differs in one bit leads to another run. The
//! functions of the C library are not correctly rounded, and differ between instruction sets on one machine.
//!
//! With x = 2ᵉ m, √½ ≤ m < √2 and t = (m − 1)/(m + 1),
//!
//! $$ \log_2 x = e + \frac{2}{\ln 2} \Big( t + \frac{t^3}{3} + \frac{t^5}{5} + \dots \Big) , $$
//!
//! and with n the integer next to x and f = x − n the power series of 2ᶠ. The truncation errors are below
//! 2e-9, and below 8e-9 relative to the value.

/// Bits of the fraction of an f64, and the offset of its exponent.
const FRACTION: u32 = 52;
const OFFSET: i64 = 1023;

/// log₂ `x`, with an error of at most 2e-9; −∞ for zero, NaN for negative numbers.
#[inline]
pub fn log2(x: f64) -> f64 {
    if x == 0.0 {
        return f64::NEG_INFINITY;
    }
    if !(x > 0.0 && x < f64::INFINITY) {
        return if x > 0.0 { x } else { f64::NAN };
    }
    // Subnormal numbers become normal ones.
    let (x, shift) = if x < f64::MIN_POSITIVE {
        (x * power_of_two(i64::from(FRACTION)), i64::from(FRACTION))
    } else {
        (x, 0)
    };
    let bits = x.to_bits();
    let mut exponent = (bits >> FRACTION) as i64 - OFFSET - shift;
    let one = 1.0_f64.to_bits();
    let mut m = f64::from_bits(bits & ((1 << FRACTION) - 1) | one);
    if m > std::f64::consts::SQRT_2 {
        (m, exponent) = (m / 2.0, exponent + 1);
    }
    let t = (m - 1.0) / (m + 1.0);
    let square = t * t;
    let series = 1.0 + square * (1.0 / 3.0 + square * (0.2 + square * (1.0 / 7.0 + square / 9.0)));
    exponent as f64 + 2.0 * std::f64::consts::LOG2_E * t * series
}

/// 2ˣ, with a relative error of at most 8e-9; 0 and ∞ beyond the normal numbers.
#[inline]
pub fn exp2(x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    let n = (x + if x < 0.0 { -0.5 } else { 0.5 }) as i64;
    if n < 1 - OFFSET {
        return 0.0;
    }
    if n > OFFSET {
        return f64::INFINITY;
    }
    let y = (x - n as f64) * std::f64::consts::LN_2;
    let tail = 1.0 / 24.0 + y * (1.0 / 120.0 + y * (1.0 / 720.0 + y * (1.0 / 5040.0)));
    let series = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * tail)));
    series * power_of_two(n)
}

/// `x`ᵃ for x ≥ 0, with a relative error of at most 2e-9 |a| + 8e-9.
#[inline]
pub fn power(x: f64, a: f64) -> f64 {
    exp2(a * log2(x))
}

/// 2ⁿ, a normal number.
#[inline]
fn power_of_two(n: i64) -> f64 {
    f64::from_bits(((n + OFFSET) as u64) << FRACTION)
}

#[cfg(test)]
mod tests {
    use super::{exp2, log2, power};

    /// So many numbers between 2^from and 2^to.
    fn numbers(from: f64, to: f64) -> impl Iterator<Item = f64> {
        (0..=20_000).map(move |i| from + (to - from) * f64::from(i) / 20_000.0)
    }

    #[test]
    fn as_those_of_the_c_library_to_the_digits_that_are_promised() {
        for y in numbers(-1070.0, 1023.0).chain(numbers(-1.0, 1.0)) {
            let x = y.exp2();
            assert!((log2(x) - x.log2()).abs() <= 2e-9, "log2 {x:e}");
        }
        for x in numbers(-1022.0, 1023.0).chain(numbers(-1.0, 1.0)) {
            assert!((exp2(x) / x.exp2() - 1.0).abs() <= 8e-9, "exp2 {x}");
        }
        for x in numbers(-50.0, 50.0).map(f64::exp2) {
            for a in [-2.0, -0.5, 1.0 / 64.0, 0.1, 1.0, 3.0] {
                let off = power(x, a) / x.powf(a) - 1.0;
                assert!(off.abs() <= 8e-9 + 2e-9 * a.abs(), "{x:e}^{a}: {off:e}");
            }
        }
    }

    #[test]
    fn limits() {
        assert_eq!(log2(0.0), f64::NEG_INFINITY);
        assert_eq!(log2(f64::INFINITY), f64::INFINITY);
        assert!(log2(-1.0).is_nan() && log2(f64::NAN).is_nan() && exp2(f64::NAN).is_nan());
        assert_eq!(log2(f64::from_bits(1)), -1074.0);
        assert_eq!([exp2(f64::NEG_INFINITY), exp2(-1e4)], [0.0, 0.0]);
        assert_eq!([exp2(f64::INFINITY), exp2(1024.0)], [f64::INFINITY; 2]);
        assert_eq!([power(0.0, 0.5), power(1.0, 0.3)], [0.0, 1.0]);
        for n in -1022..1024 {
            assert_eq!(log2(exp2(f64::from(n))), f64::from(n));
        }
    }

    /// Bits, so that a change of an operation or of a machine shows.
    #[test]
    fn bits() {
        let pinned: [(f64, u64); 6] = [
            (log2(3.0), 0x3ff9_5c01_a3a9_042e),
            (log2(1e-12), 0xc043_ee7b_471b_3a95),
            (log2(0.9), 0xbfc3_74d6_5d9e_603c),
            (exp2(0.3), 0x3ff3_b2c4_7bf9_69cf),
            (exp2(-7.7), 0x3f73_b2c4_7bf9_69ce),
            (power(1e-12, 1.0 / 16.0), 0x3fc6_c310_e123_3975),
        ];
        for (found, bits) in pinned {
            assert_eq!(found.to_bits(), bits, "{found}: {:#x}", found.to_bits());
        }
    }
}
