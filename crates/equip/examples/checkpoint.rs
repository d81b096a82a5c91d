//! Stop and resume: the second half of a run from a checkpoint of the first half, with the bits of an
//! uninterrupted run.

use equip::integrate::NoObserver;
use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0].powi(2) + p[1].powi(2)) - 1.0 / (q[0].powi(2) + q[1].powi(2)).sqrt()
    })?;
    let (q, p) = ([0.4, 0.0], [0.0, 2.0]);
    let method = Equip::stages(4).step(0.0625);

    let mut first = method.start(&kepler, &q, &p, 0.0)?;
    for _ in 0..800 {
        first.advance()?;
    }
    let checkpoint = first.checkpoint();
    let second = method.integrate_from(&kepler, &checkpoint, 100.0, &mut NoObserver)?;

    let whole = method.integrate(&kepler, &q, &p, 0.0..=100.0)?;
    println!("at t = 100: {:?}", second.last());
    assert_eq!(second.last(), whole.last());
    assert_eq!(second.certificate().counts.steps, 1600);
    Ok(())
}
