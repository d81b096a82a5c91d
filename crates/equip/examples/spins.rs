//! Spins as pairs of oscillators: two coupled spins, against their closed form.

use equip::prelude::*;
use std::f64::consts::{PI, SQRT_2};

/// (S_x, S_y, S_z) of the pair of oscillators that begins at 2i.
fn spin<T>(q: &[T], p: &[T], i: usize) -> [T; 3]
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<Output = T>,
    T: std::ops::Mul<f64, Output = T>,
{
    let (q1, q2, p1, p2) = (q[2 * i], q[2 * i + 1], p[2 * i], p[2 * i + 1]);
    [
        (q1 * q2 + p1 * p2) * 0.5,
        (q1 * p2 - p1 * q2) * 0.5,
        (q1 * q1 + p1 * p1 - q2 * q2 - p2 * p2) * 0.25,
    ]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // H = J S_1·S_2. A field adds −γ B·S, an easy axis D S_z².
    let j = 0.7;
    let pair = Hamiltonian::new(4, |q, p| {
        let (a, b) = (spin(q, p, 0), spin(q, p, 1));
        j * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
    })?;
    // |S_1|, a quarter of the sum of squares.
    let length = Hamiltonian::new(4, |q, p| {
        0.25 * (q[0] * q[0] + q[1] * q[1] + p[0] * p[0] + p[1] * p[1])
    })?;

    // S_1 along x and S_2 along y, both of length 1.
    let (q, p) = ([SQRT_2, SQRT_2, SQRT_2, 0.0], [0.0, 0.0, 0.0, SQRT_2]);
    // Both turn about M = S_1 + S_2 with the rate J |M|: after half a turn they have changed places.
    let half = PI / (j * SQRT_2);
    let run = Equip::stages(6)
        .step(half / 20.0)
        .invariant(Invariant::new("|S_1|", length))
        .integrate(&pair, &q, &p, 0.0..=101.0 * half)?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_kept_on_every_step());
    assert!(run.certificate().invariants[0].max < 1e-13);

    let (_, q, p) = run.last();
    let found = [spin(q, p, 0), spin(q, p, 1)];
    println!("S_1, S_2 = {found:.12?}");
    let exact = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let pairs = found.iter().flatten().zip(exact.iter().flatten());
    assert!(pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) < 1e-10);
    Ok(())
}
