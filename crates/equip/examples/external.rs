//! An external potential: other code computes value and gradient, here of a Morse potential. Prefer a closure
//! if possible: the library then differentiates H automatically. If other code computes the whole of H, use
//! `Hamiltonian::external`.

use equip::prelude::*;

const DEPTH: f64 = 4.5;
const WIDTH: f64 = 1.9;
const LENGTH: f64 = 0.74;

/// U(r) and U'(r).
fn morse(r: f64) -> (f64, f64) {
    let e = (-WIDTH * (r - LENGTH)).exp();
    (
        DEPTH * (1.0 - e).powi(2),
        2.0 * DEPTH * WIDTH * (1.0 - e) * e,
    )
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let radius = |q: &[f64]| q[0].hypot(q[1]);
    let molecule = Hamiltonian::external_potential(
        &[1.0, 1.0],
        4.0 * f64::EPSILON,
        move |q| morse(radius(q)).0,
        move |q, dq| {
            let pull = morse(radius(q)).1 / radius(q);
            (dq[0], dq[1]) = (pull * q[0], pull * q[1]);
        },
    )?;
    let angular_momentum = Hamiltonian::new(2, |q, p| q[0] * p[1] - q[1] * p[0])?;
    let run = Equip::stages(6)
        .tolerance(1e-10)
        .invariant(Invariant::new("angular momentum", angular_momentum))
        .integrate(&molecule, &[0.9, 0.0], &[0.3, 1.2], 0.0..=50.0)?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_conserved_on_every_step());
    Ok(())
}
