//! Parameters as positions: the tangent map gives the derivative of the period of a pendulum with respect to
//! gravity.

use equip::prelude::*;
use std::f64::consts::PI;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Gravity is q[1]. H does not depend on p[1], so q[1] is constant.
    let pendulum = Hamiltonian::new(2, |q, p| p[0].powi(2) / 2.0 - q[1] * q[0].cos())?;
    let (angle, gravity): (f64, f64) = (2.0, 9.81);

    // T = 4 K(sin(angle/2))/√g = 2π/(√g agm(1, cos(angle/2))), and dT/dg = −T/(2 g).
    let (mut a, mut b) = (1.0, (angle / 2.0).cos());
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    let period = 2.0 * PI / (gravity.sqrt() * a);

    let mut run =
        Equip::stages(8)
            .tolerance(1e-13)
            .start(&pendulum, &[angle, gravity], &[0.0, 0.0], 0.0)?;
    let mut tangent = TangentMap::new(&pendulum, &mut run);
    // The initial value of ∂(q, p)/∂g is the unit vector of q[1].
    let mut by_gravity = [0.0, 1.0, 0.0, 0.0];
    tangent.advance_to(&mut run, period, &mut by_gravity)?;
    println!("{}", run.certificate());

    // At the end of a period p = 0, and p' = −g sin(angle): dT/dg = −(∂p/∂g)/p'.
    let found = by_gravity[2] / (gravity * angle.sin());
    let exact = -period / (2.0 * gravity);
    println!("dT/dg = {found:.14}, exactly {exact:.14}");
    assert!((found - exact).abs() < 1e-10);
    Ok(())
}
