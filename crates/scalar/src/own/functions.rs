//! Default elementary functions for floats of any precision.
//!
//! ε determines the number of terms of a series. The first 53 bits come from `f64` if this saves iterations.
//! Measured errors are a few ε (`tests/own.rs`).

use num_traits::{Float, FloatConst};

pub(crate) mod arcs;
pub(crate) mod error_function;
pub(crate) mod exponential;
pub(crate) mod roots;
pub(crate) mod trigonometric;

/// A float as num-traits has it, that doubles are numbers of.
pub(crate) trait Real: Float + FloatConst + From<f64> {
    /// A double, exactly.
    #[inline(always)]
    fn exact(x: f64) -> Self {
        <Self as From<f64>>::from(x)
    }
    /// The nearest double.
    #[inline(always)]
    fn double(self) -> f64 {
        self.to_f64().unwrap_or(f64::NAN)
    }
}

impl<T: Float + FloatConst + From<f64>> Real for T {}

/// The number as an unevaluated sum of doubles, largest first.
pub(crate) fn words<T: Real, const N: usize>(mut x: T) -> [f64; N] {
    let mut words = [0.0; N];
    for word in &mut words {
        *word = x.double();
        if *word == 0.0 || !word.is_finite() {
            break;
        }
        x = x - T::exact(*word);
    }
    words
}

/// Their sum, from the smallest on; of a zero the sign too.
pub(crate) fn sum<T: Real>(words: &[f64]) -> T {
    let last = words.iter().rposition(|&word| word != 0.0).unwrap_or(0);
    let add = |sum, &word: &f64| sum + T::exact(word);
    words[..last].iter().rev().fold(T::exact(words[last]), add)
}

/// 1 + z/d₁ (1 + z/d₂ (1 + …)) for |z| ≤ `largest`, with the denominators d_j = d(j).
fn nested<T: Real>(z: T, largest: f64, d: impl Fn(f64) -> f64) -> T {
    let epsilon = T::epsilon().double() / 16.0;
    let (mut count, mut term) = (0.0, 1.0);
    while term > epsilon {
        count += 1.0;
        term *= (largest / d(count)).abs();
    }
    let one = T::exact(1.0);
    let mut sum = one;
    while count > 0.0 {
        sum = one + z * sum / T::exact(d(count));
        count -= 1.0;
    }
    sum
}

/// x·2ᵏ.
fn scaled<T: Real>(mut x: T, mut k: i32) -> T {
    while k != 0 && x.is_finite() && x != T::exact(0.0) {
        let step = k.clamp(-1000, 1000);
        x = x * T::exact(2f64.powi(step));
        k -= step;
    }
    if x.is_finite() {
        x
    } else {
        T::infinity().copysign(x)
    }
}

/// (m, k) with x = m·2ᵏ, about 2^(−1/2) ≤ |m| ≤ 2^(1/2), of a finite x ≠ 0.
fn parts<T: Real>(x: T) -> (T, i32) {
    let mut scale = 0;
    let mut near = x;
    while near.double().is_infinite() {
        scale += 1000;
        near = near * T::exact(2f64.powi(-1000));
    }
    while near.double().abs() < 1e-290 {
        scale -= 900;
        near = near * T::exact(2f64.powi(900));
    }
    let k = near.double().abs().log2().round() as i32;
    (scaled(near, -k), scale + k)
}
