//! Elementary functions of `DoubleDouble` against astro-float at 320 bits and more.
//!
//! All errors are relative, in units of 2⁻¹⁰⁴. The bound asserted is the measured maximum with a margin of
//! half to two thirds; 8 is what the documentation promises.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod error_function;
mod exponentials;
mod trigonometry;

use crate::common::{Random, Worst, big, consts, error};
use astro_float::{BigFloat, Consts};
use equip_scalar::DoubleDouble;

const COUNT: usize = 10_000;

type Generator = Box<dyn Fn(&mut Random) -> DoubleDouble>;

/// Runs `f` against `exact` over the arguments.
fn check(
    name: &'static str,
    bound: f64,
    arguments: impl Iterator<Item = DoubleDouble>,
    f: impl Fn(DoubleDouble) -> DoubleDouble,
    exact: impl Fn(&BigFloat, &mut Consts) -> BigFloat,
) {
    let mut consts = consts();
    let mut worst = Worst::new(name);
    for x in arguments {
        worst.record(
            [x, DoubleDouble::ZERO],
            error(f(x), &exact(&big(x), &mut consts)),
        );
    }
    worst.assert(COUNT, bound);
}

/// A mix of generators, each taken in turn.
fn mix(seed: u64, generators: Vec<Generator>) -> impl Iterator<Item = DoubleDouble> {
    let mut random = Random(seed);
    (0..COUNT).map(move |i| generators[i % generators.len()](&mut random))
}

/// Uniform in [a, b).
fn uniform(a: f64, b: f64) -> Generator {
    Box::new(move |r| r.between(a, b))
}

/// ±2^k, k uniform in [a, b), with a random significand.
fn sizes(a: f64, b: f64) -> Generator {
    Box::new(move |r| {
        let x = r.log_uniform(a, b);
        r.sign(x)
    })
}

/// The same, positive.
fn positive(a: f64, b: f64) -> Generator {
    Box::new(move |r| r.log_uniform(a, b))
}

/// 1 ± 2^k.
fn near_one(a: f64, b: f64) -> Generator {
    Box::new(move |r| {
        let x = r.log_uniform(a, b);
        DoubleDouble::ONE + r.sign(x)
    })
}

/// ±(1 − 2^k).
fn below_one(a: f64, b: f64) -> Generator {
    Box::new(move |r| {
        let x = DoubleDouble::ONE - r.log_uniform(a, b);
        r.sign(x)
    })
}
