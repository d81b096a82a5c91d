//! Events and dense output: the times at which a pendulum passes the bottom, and its position between them.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    let run = Equip::stages(6)
        .tolerance(1e-12)
        .dense()
        .event(Event::new("hangs straight", |_, q: &[f64], _: &[f64]| q[0]).rising())
        .integrate(&pendulum, &[0.0], &[1.0], 0.0..=30.0)?;
    let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
    for time in &times {
        println!("hangs straight, moving to the right, at t = {time:.12}");
    }
    // The period is 4 K(1/2), K being the complete elliptic integral with modulus k = p/2.
    let period = times[1] - times[0];
    assert!((period - 6.743001419250385).abs() < 1e-10, "{period}");
    let quarter = times[0] + 0.25 * period;
    if let Some((q, p)) = run.trajectory().and_then(|curve| curve.at(quarter)) {
        println!(
            "a quarter of a period later: q = {:.12}, p = {:.1e}",
            q[0], p[0]
        );
        assert!(p[0].abs() < 1e-9);
    }
    Ok(())
}
