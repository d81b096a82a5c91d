//! Any y' = f(y) by K = P·f(Q): predator and prey, with the gradient with respect to the initial state.

use equip::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Q' = ∂K/∂P = f(Q), P' = −f'(Q)ᵀ P.
    let system = Hamiltonian::new(2, |q, p| {
        p[0] * (q[0] * (1.0 - q[1])) + p[1] * (q[1] * (q[0] - 1.0))
    })?;
    // The invariant of Lotka and Volterra, on which K does not depend.
    let volterra = Hamiltonian::new(2, |q, _| q[0] - q[0].ln() + q[1] - q[1].ln())?;

    // P = 0 and K = 0 in every step: the verdict says nothing, and the steps are those of Gauss.
    let start = [1.5, 0.5];
    let method = Equip::stages(6).tolerance(1e-12);
    let there = method
        .clone()
        .invariant(Invariant::new("Volterra's", volterra))
        .integrate(&system, &start, &[0.0, 0.0], 0.0..=30.0)?;
    println!("{}\n", there.certificate());
    assert!(there.certificate().invariants[0].max < 1e-10);

    // Backward from P = (1, 0): P(0) = ∂Q_1(30)/∂Q(0), and the conserved K = P·f(Q) is Q_1'(30).
    let (t, end, _) = there.last();
    let back = method.integrate(&system, end, &[1.0, 0.0], t..=0.0)?;
    println!("{}", back.certificate());
    assert!(back.certificate().energy_conserved_on_every_step());
    let (_, q, gradient) = back.last();
    println!("∂Q_1(30)/∂Q(0) = {gradient:.10?}");
    let f = [q[0] * (1.0 - q[1]), q[1] * (q[0] - 1.0)];
    let rate = end[0] * (1.0 - end[1]);
    assert!((gradient[0] * f[0] + gradient[1] * f[1] - rate).abs() < 1e-10);
    assert!((q[0] - start[0]).abs() < 1e-9 && (q[1] - start[1]).abs() < 1e-9);
    Ok(())
}
