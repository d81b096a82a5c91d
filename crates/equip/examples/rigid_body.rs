//! Rotations by quaternions: a free rigid body, compared with the closed form in Jacobi's elliptic functions.

use equip::prelude::*;
use std::f64::consts::PI;

/// m_k = ½ p·(q e_k), the angular momentum about the axes of the body.
fn about_axes(q: &[Var], p: &[Var]) -> [Var; 3] {
    let (w, x, y, z) = (q[0], q[1], q[2], q[3]);
    [
        0.5 * (-(x * p[0]) + w * p[1] + z * p[2] - y * p[3]),
        0.5 * (-(y * p[0]) - z * p[1] + w * p[2] + x * p[3]),
        0.5 * (-(z * p[0]) + y * p[1] - x * p[2] + w * p[3]),
    ]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // H = Σ m_k²/(2 I_k). Potentials of the orientation are added as functions of q.
    let inertia = [1.0, 2.0, 3.0];
    let body = Hamiltonian::new(4, |q, p| {
        let m = about_axes(q, p);
        (0..3)
            .map(|k| m[k] * m[k] / (2.0 * inertia[k]))
            .sum::<Var>()
    })?;
    let length = Hamiltonian::new(4, |q, _| q.iter().map(|x| x.powi(2)).sum::<Var>())?;
    // ½ p·(e_1 q), about an axis in space.
    let in_space = Hamiltonian::new(4, |q, p| {
        0.5 * (-(q[1] * p[0]) + q[0] * p[1] - q[3] * p[2] + q[2] * p[3])
    })?;
    let axis = Hamiltonian::new(4, |q, p| about_axes(q, p)[1])?;

    // Initially the axes of the body are those of space: q = 1, p = 2 q (0, m) with m_k = I_k ω_k.
    let omega = [1.0, 0.0, 1.0];
    let m = [0, 1, 2].map(|k| inertia[k] * omega[k]);
    let (q, p) = (
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 2.0 * m[0], 2.0 * m[1], 2.0 * m[2]],
    );

    // ω(t) has the period 4 K(k), here with k² = 1/3 (Landau, Lifshitz, Mechanics, § 37).
    let (mut a, mut b) = (1.0, (2.0_f64 / 3.0).sqrt());
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    let period = 4.0 * PI / (2.0 * a);

    let run = Equip::stages(6)
        .step(period / 100.0)
        .invariant(Invariant::new("|q|²", length))
        .invariant(Invariant::new("angular momentum about x", in_space))
        .integrate(&body, &q, &p, 0.0..=10.25 * period)?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_conserved_on_every_step());
    assert!(run.certificate().invariants.iter().all(|i| i.max < 1e-12));

    // After a quarter of a period ω_2 is at its largest, √((2 E I_3 − L²)/(I_2 (I_3 − I_2))) = 1.
    let (_, q, p) = run.last();
    let omega_2 = axis.function::<f64>().value(0.0, q, p) / inertia[1];
    println!("ω_2 = {omega_2:.14}, exactly 1 or −1");
    assert!((omega_2.abs() - 1.0).abs() < 1e-10);
    Ok(())
}
