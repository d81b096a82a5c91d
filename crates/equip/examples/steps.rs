//! One step at a time, with a user-defined invariant. An uncorrected step ends the run with an error.

use equip::integrate::AlphaPolicy;
use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let henon_heiles = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0].powi(2) + p[1].powi(2) + q[0].powi(2) + q[1].powi(2)) + q[0].powi(2) * q[1]
            - ratio(1, 3) * q[1].powi(3)
    })?;
    let momentum = Hamiltonian::new(2, |q, p| q[0] * p[1] - q[1] * p[0])?;
    let method = Equip::stages(3)
        .step(0.25)
        .invariant(Invariant::new("angular momentum", momentum)) // not kept by this H: the certificate shows it
        .alpha_policy(AlphaPolicy::Refuse);
    let mut steps = method.start(&henon_heiles, &[0.0, 0.3], &[0.42, 0.0], 0.0)?;
    for step in steps.by_ref().take(10) {
        let step = step?;
        println!(
            "{:6.2} {:+.15} {:+.15} {}",
            step.time,
            step.q[0],
            step.q[1],
            step.outcome.label()
        );
    }
    println!("{}", steps.certificate());
    Ok(())
}
