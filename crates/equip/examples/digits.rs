//! Thirty digits: with initial values in double-double the entire run uses double-double. The constant 1/3
//! in H has as many digits.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quartic = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + ratio(1, 3) * q[0].powi(4))?;
    let (q, p) = ([DoubleDouble::ratio(1, 2)], [DoubleDouble::int(1)]);
    let interval = DoubleDouble::int(0)..=DoubleDouble::int(2);
    let run = Equip::stages(8)
        .step(DoubleDouble::ratio(1, 20))
        .integrate(&quartic, &q, &p, interval)?;
    println!("{}", run.certificate());
    let (_, q, p) = run.last();
    let energy =
        p[0] * p[0] / DoubleDouble::int(2) + q[0] * q[0] * q[0] * q[0] / DoubleDouble::int(3);
    let start = DoubleDouble::ratio(1, 2) + DoubleDouble::ratio(1, 48);
    assert!((energy - start).to_f64().abs() < 1e-29);
    Ok(())
}
