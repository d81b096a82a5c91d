//! Exponential and logarithm, powers by them, and hyperbolic functions with their inverses.
//!
//! eˣ = 2ᵏ eʳ with |r| ≤ ln 2/2 and the series of eʳ − 1. A logarithm is a double y close to ln(1 + x),
//! corrected by three terms of ln((1 + x)e⁻ʸ). The error of a power is about |y ln x| ε.

use super::{Real, nested, parts, scaled};
use crate::double_double::text::parse::Decimal;
use std::f64::consts;
use std::sync::LazyLock;

/// ln 2 to 104 decimals.
const LN_2: &str = "0.69314718055994530941723212145817656807550013436025\
    525412068000949339362196969471560586332699641868754200";

/// ln 2 as a sum of doubles with at most 27 bits, so that they have exact products with integers up to 2²⁶.
pub(crate) fn ln_2_words() -> &'static [f64; 12] {
    static WORDS: LazyLock<[f64; 12]> = LazyLock::new(|| {
        let long: [f64; 6] = Decimal::read(LN_2).map_or([f64::NAN; 6], |text| text.to_words());
        std::array::from_fn(|i| {
            let word = long[i / 2];
            let upper = f64::from_bits(word.to_bits() & !0x7ff_ffff);
            if i % 2 == 0 { upper } else { word - upper }
        })
    });
    &WORDS
}

/// eˣ − 1 for |x| ≤ 0.4.
fn series<T: Real>(x: T) -> T {
    x * nested(x, 0.4, |j| j + 1.0)
}

/// (k, eʳ − 1) with x = k ln 2 + r.
fn reduced<T: Real>(x: T) -> (i32, T) {
    let k = (x.double() * consts::LOG2_E).round();
    let r = ln_2_words()
        .iter()
        .fold(x, |rest, word| rest - T::exact(k * word));
    (k as i32, series(r))
}

pub(crate) fn exp<T: Real>(x: T) -> T {
    let size = x.double();
    if size.is_nan() {
        return x;
    }
    if size.abs() > 4e7 {
        return if size > 0.0 {
            T::infinity()
        } else {
            T::exact(0.0)
        };
    }
    let (k, rest) = reduced(x);
    scaled(T::exact(1.0) + rest, k)
}

pub(crate) fn exp2<T: Real>(x: T) -> T {
    let k = x.double().round();
    if !(k.abs() < 4e7) {
        return exp(x);
    }
    let rest = series((x - T::exact(k)) * T::LN_2());
    scaled(T::exact(1.0) + rest, k as i32)
}

pub(crate) fn exp_m1<T: Real>(x: T) -> T {
    let one = T::exact(1.0);
    if x.double().abs() < 0.4 {
        return series(x);
    }
    if !(x.double().abs() < 600.0) {
        return exp(x) - one;
    }
    let (k, rest) = reduced(x);
    let power = T::exact(2f64.powi(k));
    power * rest + (power - one)
}

pub(crate) fn ln<T: Real>(x: T) -> T {
    if x == T::exact(0.0) {
        return -T::infinity();
    }
    if x == T::infinity() {
        return x;
    }
    if !(x > T::exact(0.0)) {
        return T::nan();
    }
    let (m, k) = parts(x);
    let rest = ln_near_1(m - T::exact(1.0));
    if k == 0 {
        rest
    } else {
        T::exact(k.into()) * T::LN_2() + rest
    }
}

pub(crate) fn ln_1p<T: Real>(x: T) -> T {
    if -0.29 < x.double() && x.double() < 0.41 {
        ln_near_1(x)
    } else {
        ln(T::exact(1.0) + x)
    }
}

/// ln(1 + x) for −0.3 < x < 0.42.
fn ln_near_1<T: Real>(x: T) -> T {
    let y = T::exact(x.double().ln_1p());
    let power = series(y);
    let d = (x - power) / (T::exact(1.0) + power);
    let w = d / (T::exact(2.0) + d);
    let square = w * w;
    let rest = square * (T::exact(1.0) / T::exact(3.0) + square / T::exact(5.0));
    y + (w + w) * (T::exact(1.0) + rest)
}

/// Whole exponents up to 64 by products, all others by exp(y ln x).
pub(crate) fn powf<T: Real>(x: T, y: T) -> T {
    let zero = T::exact(0.0);
    let is_whole = y == y.trunc();
    if is_whole && y.double().abs() <= 64.0 {
        return x.powi(y.double() as i32);
    }
    if x == zero || !x.is_finite() || !y.is_finite() {
        return T::exact(x.double().powf(y.double()));
    }
    let size = (y * x.abs().ln()).exp();
    if x > zero {
        return size;
    }
    let half = y * T::exact(0.5);
    match (is_whole, half == half.trunc()) {
        (false, _) => T::nan(),
        (true, true) => size,
        (true, false) => -size,
    }
}

/// By eˣ − 1 up to 1; where eˣ is infinite, from its root.
pub(crate) fn sinh<T: Real>(x: T) -> T {
    let half = T::exact(0.5);
    let size = x.abs();
    if size < T::exact(1.0) {
        let e = exp_m1(x);
        return half * (e + e / (e + T::exact(1.0)));
    }
    let e = size.exp();
    let sinh = if e.is_finite() {
        half * (e - e.recip())
    } else {
        half * (half * size).exp() * (half * size).exp()
    };
    sinh.copysign(x)
}

pub(crate) fn cosh<T: Real>(x: T) -> T {
    let half = T::exact(0.5);
    let e = x.abs().exp();
    if e.is_infinite() {
        return sinh(x.abs());
    }
    half * (e + e.recip())
}

pub(crate) fn tanh<T: Real>(x: T) -> T {
    let size = x.abs();
    let e = exp_m1(size + size);
    let tanh = if e.is_infinite() {
        T::exact(1.0)
    } else {
        e / (e + T::exact(2.0))
    };
    tanh.copysign(x)
}

/// ln(2x) for an x whose square is infinite, or so large that 1 is lost beside it.
fn ln_twice<T: Real>(x: T) -> T {
    x.ln() + T::LN_2()
}

pub(crate) fn asinh<T: Real>(x: T) -> T {
    let size = x.abs();
    let one = T::exact(1.0);
    let asinh = if size * T::epsilon() > one {
        ln_twice(size)
    } else {
        let square = size * size;
        (size + square / (one + (one + square).sqrt())).ln_1p()
    };
    asinh.copysign(x)
}

/// ln(1 + (t + √(t(t + 2)))), t = x − 1.
pub(crate) fn acosh<T: Real>(x: T) -> T {
    let one = T::exact(1.0);
    if x * T::epsilon() > one {
        return ln_twice(x);
    }
    let t = x - one;
    (t + (t * (t + T::exact(2.0))).sqrt()).ln_1p()
}

/// ½ ln(1 + 2x/(1 − x)) for x ≥ 0.
pub(crate) fn atanh<T: Real>(x: T) -> T {
    let size = x.abs();
    let one = T::exact(1.0);
    if size == one {
        return T::infinity().copysign(x);
    }
    (T::exact(0.5) * ((size + size) / (one - size)).ln_1p()).copysign(x)
}
