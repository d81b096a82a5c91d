//! An energy that depends on time, q'' = −q + cos(t/2), forward and backward, compared with the closed form.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let driven = Hamiltonian::with_time(1, |t, q, p| {
        0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * (0.5 * t).cos()
    })?;
    let method = Equip::stages(4).tolerance(1e-12);
    let there = method.integrate(&driven, &[0.0], &[0.0], 0.0..=10.0)?;
    let (t, q, p) = there.last();
    let exact = 4.0 / 3.0 * (5f64.cos() - 10f64.cos());
    println!("q(10) = {:.12}, exactly {exact:.12}", q[0]);
    // H is not conserved and shows the energy supplied; the certificate shows that the energy balance holds.
    let mut energy = driven.function::<f64>();
    println!(
        "H(10) − H(0) = {:.12}",
        energy.value(t, q, p) - energy.value(0.0, &[0.0], &[0.0])
    );
    println!("{}", there.certificate());
    let back = method.integrate(&driven, q, p, t..=0.0)?;
    println!("back at 0: q = {:.1e}", back.last().1[0]);
    assert!((q[0] - exact).abs() < 1e-10 && back.last().1[0].abs() < 1e-10);
    Ok(())
}
