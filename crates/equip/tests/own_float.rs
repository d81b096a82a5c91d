//! A float of the user's, with 71 digits: steps in it against steps in double-double.
#![allow(clippy::unwrap_used)]

use equip::prelude::*;
use equip::scalar::{Arithmetic, Own};
use f256::f256;

struct Octuple;

impl Arithmetic for Octuple {
    type Number = f256;
    const NAME: &'static str = "f256";
    const MANTISSA_BITS: u32 = 237;
    const EPSILON: f256 = f256::EPSILON;
    const MAX: f256 = f256::MAX;
    const MIN_POSITIVE: f256 = f256::MIN_POSITIVE;
    const INFINITY: f256 = f256::INFINITY;
    const NAN: f256 = f256::NAN;

    fn from_f64(x: f64) -> f256 {
        x.into()
    }
    fn to_f64(x: f256) -> f64 {
        let (upper, lower) = x.to_bits();
        let exponent = (upper >> 108) as i32 & 0x7ffff;
        let fraction = upper & ((1 << 108) - 1);
        let size = match exponent {
            0 => 0.0,
            0x7ffff if fraction != 0 || lower != 0 => f64::NAN,
            _ => {
                let significand = 1 << 108 | fraction | u128::from(lower != 0);
                significand as f64 * 2f64.powi(exponent - 0x3ffff - 108)
            }
        };
        if x.is_sign_negative() { -size } else { size }
    }
    fn sqrt(x: f256) -> f256 {
        x.sqrt()
    }
}

type Long = Own<Octuple>;

/// Three steps of Kepler's problem.
fn states<T: Float>() -> (Vec<T>, T) {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - (q[0] * q[0] + q[1] * q[1]).sqrt().recip()
    })
    .unwrap();
    let start = [T::ratio(2, 5), T::int(0), T::int(0), T::int(2)];
    let run = Equip::stages(3)
        .step(T::ratio(1, 100))
        .integrate(
            &kepler,
            &start[..2],
            &start[2..],
            T::int(0)..=T::ratio(3, 100),
        )
        .unwrap();
    let (_, q, p) = run.last();
    let last = [q, p].concat();
    let mut energy = kepler.evaluator();
    let error = energy.value(&last) - energy.value(&start);
    assert!(run.certificate().energy_kept_on_every_step());
    (last, error)
}

#[test]
fn steps_in_71_digits_agree_with_double_double() {
    let (long, error) = states::<Long>();
    println!("energy error {error:.1e}");
    assert!(error.to_f64().abs() < 1e-69);
    let (short, _) = states::<DoubleDouble>();
    let mut worst = 0.0_f64;
    for (long, short) in long.iter().zip(short) {
        let [hi, lo, ..] = short.expansion();
        let distance = *long - Long::exact(hi) - Long::exact(lo);
        worst = worst.max((distance / *long).to_f64().abs());
    }
    println!("distance from double-double {worst:.1e}");
    assert!(0.0 < worst && worst < 1e-31, "{worst:e}");
}
