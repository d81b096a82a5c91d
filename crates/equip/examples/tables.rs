//! A potential given at points: the cubic spline of −cos x, compared with the pendulum itself.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let x: Vec<f64> = (0..=64).map(|i| -4.0 + 0.125 * f64::from(i)).collect();
    let y: Vec<f64> = x.iter().map(|x| -x.cos()).collect();
    let v = Table::not_a_knot(&x, &y)?;
    let swing = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0]))?;
    let pendulum = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 - q[0].cos())?;

    let method = Equip::stages(4).step(0.1);
    let run = method.integrate(&swing, &[0.0], &[1.5], 0.0..=100.0)?;
    let true_run = method.integrate(&pendulum, &[0.0], &[1.5], 0.0..=100.0)?;
    let (q, true_q) = (run.last().1[0], true_run.last().1[0]);
    println!("{}", run.certificate());
    println!("q(100) = {q:.6} by the table, {true_q:.6} by the cosine");
    assert!((q - true_q).abs() < 1e-3);
    Ok(())
}
