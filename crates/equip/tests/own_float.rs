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

/// Some steps of 1/16 of Kepler's problem, e = 0.6: the last state, and the energy error there.
fn steps<T: Float>(stages: usize, count: i64) -> (Vec<T>, f64) {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - (q[0] * q[0] + q[1] * q[1]).sqrt().recip()
    })
    .unwrap();
    let start = [T::ratio(2, 5), T::int(0), T::int(0), T::int(2)];
    let interval = T::int(0)..=T::ratio(count, 16);
    let run = Equip::stages(stages)
        .step(T::ratio(1, 16))
        .integrate(&kepler, &start[..2], &start[2..], interval)
        .unwrap();
    assert!(run.certificate().energy_conserved_on_every_step());
    let (_, q, p) = run.last();
    let last = [q, p].concat();
    let mut energy = kepler.evaluator();
    let error = energy.value(&last) - energy.value(&start);
    (last, error.to_f64().abs())
}

/// With two stages α is one number. More of them may differ by as much as they leave the energy alone.
#[test]
fn steps_in_71_digits_agree_with_double_double() {
    let (long, error) = steps::<Long>(2, 3);
    // Without optimisation the frames of double-double in lanes take megabytes.
    let thread = std::thread::Builder::new().stack_size(1 << 26);
    let short = thread.spawn(|| steps::<DoubleDouble>(2, 3).0);
    let short = short.unwrap().join().unwrap();
    let distances = long.iter().zip(short).map(|(&long, short)| {
        let [hi, lo, ..] = short.expansion();
        let distance = long - Long::exact(hi) - Long::exact(lo);
        (distance / long).to_f64().abs()
    });
    let worst = distances.fold(0.0, f64::max);
    println!("distance from double-double {worst:.1e}, energy error {error:.1e}");
    // Measured: 2.5e-32 and 1.0e-69.
    assert!(0.0 < worst && worst < 1e-31, "{worst:e}");
    assert!(error < 1e-68);
    // Measured: 2.5e-70; 12 moves of α to so many digits.
    let (_, error) = steps::<Long>(3, 1);
    assert!(error < 1e-68);
}
