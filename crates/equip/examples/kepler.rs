//! The shortest program: an energy, a method, a certificate.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mu = 1.0;
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - mu / (q[0] * q[0] + q[1] * q[1]).sqrt()
    })?;
    let run = Equip::stages(8).tolerance(1e-12).integrate(
        &kepler,
        &[0.4, 0.0],
        &[0.0, 2.0],
        0.0..=100.0,
    )?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_conserved_on_every_step());
    Ok(())
}
