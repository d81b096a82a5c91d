//! Exponential and logarithm, powers by them, and hyperbolic functions with their inverses.
//!
//! eˣ = 2ᵏ eʳ with |r| ≤ ln 2/2 and the series of eʳ − 1. Logarithms are corrected by it: a double y close to
//! ln(1 + x) leaves ln((1 + x)e⁻ʸ), of which three terms are enough. Powers lose as many ε as |y ln x| is.

use super::{nested, parts, scaled};
use crate::double_double::text::parse::Decimal;
use crate::own::{Arithmetic, Own};
use num_traits::FloatConst;
use std::f64::consts;
use std::sync::LazyLock;

/// ln 2 to 104 decimals.
const LN_2: &str = "0.69314718055994530941723212145817656807550013436025\
    525412068000949339362196969471560586332699641868754200";

/// ln 2 as a sum of doubles with at most 27 bits, so that they have exact products with integers up to 2²⁶.
pub(in crate::own) fn ln_2_words() -> &'static [f64; 12] {
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
fn series<A: Arithmetic>(x: Own<A>) -> Own<A> {
    x * nested(x, 0.4, |j| j + 1.0)
}

/// (k, eʳ − 1) with x = k ln 2 + r.
fn reduced<A: Arithmetic>(x: Own<A>) -> (i32, Own<A>) {
    let k = (x.hi() * consts::LOG2_E).round();
    let r = ln_2_words()
        .iter()
        .fold(x, |rest, word| rest - Own::small(k * word));
    (k as i32, series(r))
}

pub(in crate::own) fn exp<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let size = x.hi();
    if size.is_nan() {
        return x;
    }
    if size.abs() > 4e7 {
        return if size > 0.0 {
            Own(A::INFINITY)
        } else {
            Own::small(0.0)
        };
    }
    let (k, rest) = reduced(x);
    scaled(Own::small(1.0) + rest, k)
}

pub(in crate::own) fn exp2<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let k = x.hi().round();
    if !(k.abs() < 4e7) {
        return exp(x);
    }
    let rest = series((x - Own::small(k)) * Own::LN_2());
    scaled(Own::small(1.0) + rest, k as i32)
}

pub(in crate::own) fn exp_m1<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let one = Own::small(1.0);
    if x.hi().abs() < 0.4 {
        return series(x);
    }
    if !(x.hi().abs() < 600.0) {
        return exp(x) - one;
    }
    let (k, rest) = reduced(x);
    let power = Own::small(2f64.powi(k));
    power * rest + (power - one)
}

pub(in crate::own) fn ln<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if x == Own::small(0.0) {
        return -Own(A::INFINITY);
    }
    if x == Own(A::INFINITY) {
        return x;
    }
    if !(x > Own::small(0.0)) {
        return Own(A::NAN);
    }
    let (m, k) = parts(x);
    let rest = ln_near_1(m - Own::small(1.0));
    if k == 0 {
        rest
    } else {
        Own::small(k.into()) * Own::LN_2() + rest
    }
}

pub(in crate::own) fn ln_1p<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if -0.29 < x.hi() && x.hi() < 0.41 {
        ln_near_1(x)
    } else {
        ln(Own::small(1.0) + x)
    }
}

/// ln(1 + x) for −0.3 < x < 0.42.
fn ln_near_1<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let y = Own::small(x.hi().ln_1p());
    let power = series(y);
    let d = (x - power) / (Own::small(1.0) + power);
    let w = d / (Own::small(2.0) + d);
    let square = w * w;
    let rest = square * (Own::small(1.0) / Own::small(3.0) + square / Own::small(5.0));
    y + (w + w) * (Own::small(1.0) + rest)
}

/// Whole exponents up to 64 by products, all others by exp(y ln x).
pub(in crate::own) fn powf<A: Arithmetic>(x: Own<A>, y: Own<A>) -> Own<A> {
    let zero = Own::small(0.0);
    let is_whole = y == y.trunc();
    if is_whole && y.hi().abs() <= 64.0 {
        return x.powi(y.hi() as i32);
    }
    if x == zero || !x.is_finite() || !y.is_finite() {
        return Own::small(x.hi().powf(y.hi()));
    }
    let size = (y * x.abs().ln()).exp();
    if x > zero {
        return size;
    }
    let half = y * Own::small(0.5);
    match (is_whole, half == half.trunc()) {
        (false, _) => Own(A::NAN),
        (true, true) => size,
        (true, false) => -size,
    }
}

/// By eˣ − 1 up to 1; where eˣ is infinite, from its root.
pub(in crate::own) fn sinh<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let half = Own::small(0.5);
    let size = x.abs();
    if size < Own::small(1.0) {
        let e = exp_m1(x);
        return half * (e + e / (e + Own::small(1.0)));
    }
    let e = size.exp();
    let sinh = if e.is_finite() {
        half * (e - e.recip())
    } else {
        half * (half * size).exp() * (half * size).exp()
    };
    sinh.copysign(x)
}

pub(in crate::own) fn cosh<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let half = Own::small(0.5);
    let e = x.abs().exp();
    if e.is_infinite() {
        return sinh(x.abs());
    }
    half * (e + e.recip())
}

pub(in crate::own) fn tanh<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let size = x.abs();
    let e = exp_m1(size + size);
    let tanh = if e.is_infinite() {
        Own::small(1.0)
    } else {
        e / (e + Own::small(2.0))
    };
    tanh.copysign(x)
}

/// ln(2x) for an x whose square is infinite, or so large that 1 is lost beside it.
fn ln_twice<A: Arithmetic>(x: Own<A>) -> Own<A> {
    x.ln() + Own::LN_2()
}

pub(in crate::own) fn asinh<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let size = x.abs();
    let one = Own::small(1.0);
    let asinh = if size * Own(A::EPSILON) > one {
        ln_twice(size)
    } else {
        let square = size * size;
        (size + square / (one + (one + square).sqrt())).ln_1p()
    };
    asinh.copysign(x)
}

/// ln(1 + (t + √(t(t + 2)))), t = x − 1.
pub(in crate::own) fn acosh<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let one = Own::small(1.0);
    if x * Own(A::EPSILON) > one {
        return ln_twice(x);
    }
    let t = x - one;
    (t + (t * (t + Own::small(2.0))).sqrt()).ln_1p()
}

/// ½ ln(1 + 2x/(1 − x)) for x ≥ 0.
pub(in crate::own) fn atanh<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let size = x.abs();
    let one = Own::small(1.0);
    if size == one {
        return Own(A::INFINITY).copysign(x);
    }
    (Own::small(0.5) * ((size + size) / (one - size)).ln_1p()).copysign(x)
}
