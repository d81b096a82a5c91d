//! Mathematical constants and limits.
//!
//! Each pair is the nearest one: hi = RN(c), lo = RN(c − hi). `tests/double_double_tables.rs` recomputes all
//! of them at 400 bits.
#![allow(clippy::approx_constant)] // They are not approximations of the constants of std, they extend them.

use super::number::{DoubleDouble, dd};
use num_dual::DualNumFloat;
use num_traits::FloatConst;

impl DoubleDouble {
    /// 0.
    pub const ZERO: Self = dd(0.0, 0.0);
    /// 1.
    pub const ONE: Self = dd(1.0, 0.0);
    /// 1/3.
    pub const THIRD: Self = dd(0.3333333333333333, 1.850371707708594e-17);
    /// 2⁻¹⁰⁴, the unit in which errors of double-double arithmetic are counted: sums are within 0.75,
    /// products within 1.25 of it. Two numbers may lie closer (1 and 1 + 2⁻¹⁰⁷⁴ are different), but no
    /// arithmetic resolves that.
    pub const EPSILON: Self = dd(4.930380657631324e-32, 0.0);
    /// Largest finite number: the largest double and the largest lower part that does not round it up.
    pub const MAX: Self = dd(f64::MAX, 9.979201547673598e+291);
    /// −[`MAX`](Self::MAX).
    pub const MIN: Self = dd(-f64::MAX, -9.979201547673598e+291);
    /// 2⁻⁹⁶⁹, the smallest positive number of which all 106 bits are kept.
    pub const MIN_POSITIVE: Self = dd(2.004168360008973e-292, 0.0);
    /// Positive infinity.
    pub const INFINITY: Self = dd(f64::INFINITY, 0.0);
    /// Negative infinity.
    pub const NEG_INFINITY: Self = dd(f64::NEG_INFINITY, 0.0);
    /// Not a number.
    pub const NAN: Self = dd(f64::NAN, 0.0);
}

/// Constants of the type, which are those of num-traits.
macro_rules! constants {
    ($($(#[$doc:meta])* $c:ident = ($hi:expr, $lo:expr);)*) => {
        impl DoubleDouble {
            $($(#[$doc])* pub const $c: Self = dd($hi, $lo);)*
        }
        impl FloatConst for DoubleDouble {
            $(
                #[inline(always)]
                fn $c() -> Self {
                    Self::$c
                }
            )*
        }
    };
}
constants! {
    /// π.
    PI = (3.141592653589793, 1.2246467991473532e-16);
    /// 2π.
    TAU = (6.283185307179586, 2.4492935982947064e-16);
    /// π/2.
    FRAC_PI_2 = (1.5707963267948966, 6.123233995736766e-17);
    /// π/3.
    FRAC_PI_3 = (1.0471975511965979, -1.072081766451091e-16);
    /// π/4.
    FRAC_PI_4 = (0.7853981633974483, 3.061616997868383e-17);
    /// π/6.
    FRAC_PI_6 = (0.5235987755982989, -5.360408832255455e-17);
    /// π/8.
    FRAC_PI_8 = (0.39269908169872414, 1.5308084989341915e-17);
    /// 1/π.
    FRAC_1_PI = (0.3183098861837907, -1.9678676675182486e-17);
    /// 2/π.
    FRAC_2_PI = (0.6366197723675814, -3.935735335036497e-17);
    /// 2/√π.
    FRAC_2_SQRT_PI = (1.1283791670955126, 1.533545961316588e-17);
    /// 1/√2.
    FRAC_1_SQRT_2 = (0.7071067811865476, -4.833646656726457e-17);
    /// √2.
    SQRT_2 = (1.4142135623730951, -9.667293313452913e-17);
    /// Euler's number e.
    E = (2.718281828459045, 1.4456468917292502e-16);
    /// ln 2.
    LN_2 = (0.6931471805599453, 2.3190468138462996e-17);
    /// ln 10.
    LN_10 = (2.302585092994046, -2.1707562233822494e-16);
    /// log₂ e.
    LOG2_E = (1.4426950408889634, 2.0355273740931033e-17);
    /// log₁₀ e.
    LOG10_E = (0.4342944819032518, 1.098319650216765e-17);
    /// log₁₀ 2.
    LOG10_2 = (0.3010299956639812, -2.8037281277851704e-18);
    /// log₂ 10.
    LOG2_10 = (3.321928094887362, 1.661617516973592e-16);
}

impl DualNumFloat for DoubleDouble {
    const THIRD: Self = Self::THIRD;
    const HALF: Self = dd(0.5, 0.0);
    const TWO: Self = dd(2.0, 0.0);
    const THREE: Self = dd(3.0, 0.0);
    const FOUR: Self = dd(4.0, 0.0);
    const SIX: Self = dd(6.0, 0.0);
    const TEN: Self = dd(10.0, 0.0);
    const FIFTEEN: Self = dd(15.0, 0.0);
}
