//! A user-defined floating-point type: a run in the arithmetic of the crate twofloat (31 digits).

use equip::prelude::*;
use equip::scalar::{Arithmetic, Own};
use twofloat::TwoFloat;

struct Pairs;

impl Arithmetic for Pairs {
    type Number = TwoFloat;
    const NAME: &'static str = "twofloat";
    const MANTISSA_BITS: u32 = 106;
    // 2⁻¹⁰², a true bound; `TwoFloat::EPSILON` is the smallest normal number.
    const EPSILON: TwoFloat = TwoFloat::from_f64(1.9721522630525295e-31);
    const MAX: TwoFloat = TwoFloat::MAX;
    const MIN_POSITIVE: TwoFloat = TwoFloat::from_f64(1e-290);
    const INFINITY: TwoFloat = TwoFloat::INFINITY;
    const NAN: TwoFloat = TwoFloat::NAN;

    fn from_f64(x: f64) -> TwoFloat {
        x.into()
    }
    fn to_f64(x: TwoFloat) -> f64 {
        x.hi()
    }
    fn sqrt(x: TwoFloat) -> TwoFloat {
        x.sqrt()
    }
    // The quotient of the crate has only 16 digits: one correction step.
    fn over(x: TwoFloat, y: TwoFloat) -> TwoFloat {
        let quotient = x / y;
        quotient + (x - quotient * y) / y
    }
}

type Number = Own<Pairs>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - (q[0] * q[0] + q[1] * q[1]).sqrt().recip()
    })?;
    let (q, p) = ([2, 0].map(|n| Number::ratio(n, 5)), [0, 2].map(Number::int));
    let run = Equip::stages(8).step(Number::ratio(1, 40)).integrate(
        &kepler,
        &q,
        &p,
        Number::int(0)..=Number::int(2),
    )?;
    println!("{}", run.certificate());

    let mut energy = kepler.evaluator();
    let mut at = |q: &[Number], p: &[Number]| energy.value(&[q, p].concat());
    let (_, last_q, last_p) = run.last();
    let error = at(last_q, last_p) - at(&q, &p);
    println!("energy error {error:.1e}");
    assert!(error.to_f64().abs() < 1e-29);
    Ok(())
}
