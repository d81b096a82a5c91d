//! Friction and forces by an energy that depends on time: a damped oscillator, compared with the closed form.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // H = e^{−γt} p²/2 + e^{γt} (U(q) − F(t) q) has q'' = −γ q' − U'(q) + F(t); p = e^{γt} q'.
    let gamma = 0.2;
    let damped = Hamiltonian::with_time(1, |t, q, p| {
        (-gamma * t).exp() * p[0].powi(2) / 2.0 + (gamma * t).exp() * q[0].powi(2) / 2.0
    })?;
    let run = Equip::stages(6)
        .tolerance(1e-12)
        .integrate(&damped, &[1.0], &[0.0], 0.0..=20.0)?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_conserved_on_every_step());

    let (t, q, _) = run.last();
    let rate = (1.0 - gamma * gamma / 4.0_f64).sqrt();
    let exact =
        (-gamma * t / 2.0).exp() * ((rate * t).cos() + gamma / (2.0 * rate) * (rate * t).sin());
    println!("q(20) = {:.14}, exactly {exact:.14}", q[0]);
    assert!((q[0] - exact).abs() < 1e-10);
    Ok(())
}
