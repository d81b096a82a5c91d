//! Elementary functions of a float of any precision, for those whose type has none of its own.
//!
//! ε says how many terms a series has; the first 53 bits come from `f64` wherever that saves iterations.
//! Measured errors are a few ε (`tests/own.rs`).

use super::{Arithmetic, Own};

pub(super) mod arcs;
pub(super) mod error_function;
pub(super) mod exponential;
pub(super) mod roots;
pub(super) mod trigonometric;

/// 1 + z/d₁ (1 + z/d₂ (1 + …)) for |z| ≤ `largest`, with the denominators d_j = d(j).
fn nested<A: Arithmetic>(z: Own<A>, largest: f64, d: impl Fn(f64) -> f64) -> Own<A> {
    let epsilon = A::to_f64(A::EPSILON) / 16.0;
    let (mut count, mut term) = (0.0, 1.0);
    while term > epsilon {
        count += 1.0;
        term *= (largest / d(count)).abs();
    }
    let one = Own::small(1.0);
    let mut sum = one;
    while count > 0.0 {
        sum = one + z * sum / Own::small(d(count));
        count -= 1.0;
    }
    sum
}

/// x·2ᵏ.
fn scaled<A: Arithmetic>(mut x: Own<A>, mut k: i32) -> Own<A> {
    while k != 0 && x.is_finite() && x != Own::small(0.0) {
        let step = k.clamp(-1000, 1000);
        x = x * Own::small(2f64.powi(step));
        k -= step;
    }
    if x.is_finite() {
        x
    } else {
        Own(A::INFINITY).copysign(x)
    }
}

/// (m, k) with x = m·2ᵏ, about 2^(−1/2) ≤ |m| ≤ 2^(1/2), of a finite x ≠ 0.
fn parts<A: Arithmetic>(x: Own<A>) -> (Own<A>, i32) {
    let mut scale = 0;
    let mut near = x;
    while near.hi().is_infinite() {
        scale += 1000;
        near = near * Own::small(2f64.powi(-1000));
    }
    while near.hi().abs() < 1e-290 {
        scale -= 900;
        near = near * Own::small(2f64.powi(900));
    }
    let k = near.hi().abs().log2().round() as i32;
    (scaled(near, -k), scale + k)
}
