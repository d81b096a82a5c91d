//! An energy that depends on time, q'' = −q + cos(t/2), in the extended phase space; against the closed form.

use equip::prelude::*;
use equip::solver::Extended;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let driven = Extended::time_dependent(1, |t, q, p| {
        0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * (0.5 * t).cos()
    })?;
    let (q, p) = driven.start(&[0.0], &[0.0], 0.0);
    let run =
        Equip::stages(4)
            .tolerance(1e-12)
            .integrate(driven.hamiltonian(), &q, &p, 0.0..=10.0)?;
    let (_, q, p) = run.last();
    let exact = 4.0 / 3.0 * (5f64.cos() - 10f64.cos());
    println!("q(10) = {:.12}, exactly {exact:.12}", q[0]);
    println!("energy put in since t = 0: {:.12}", -p[1]);
    assert!((q[0] - exact).abs() < 1e-10);
    Ok(())
}
