//! Variable steps by a tolerance: one revolution of Kepler's problem, e = 0.9, compared with the closed form.

use equip::prelude::*;
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0].powi(2) + p[1].powi(2)) - 1.0 / (q[0].powi(2) + q[1].powi(2)).sqrt()
    })?;
    let run = Equip::stages(8).tolerance(1e-12).integrate(
        &kepler,
        &[0.1, 0.0],
        &[0.0, 19f64.sqrt()],
        0.0..=TAU,
    )?;
    println!("{}", run.certificate());
    let (_, q, _) = run.last();
    println!(
        "after one revolution {:.1e} from the start",
        (q[0] - 0.1).hypot(q[1])
    );
    assert!((q[0] - 0.1).abs() < 1e-9 && q[1].abs() < 1e-9);
    Ok(())
}
