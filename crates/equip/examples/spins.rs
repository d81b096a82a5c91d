//! Spins by a bracket: two coupled spins, compared with the closed form.

use equip::prelude::*;
use std::f64::consts::PI;

/// The entries of S' = ∂H/∂S × S for the spin whose components begin at `first`.
fn spin(s: &[Var], first: usize) -> [(usize, usize, Var); 3] {
    let [x, y, z] = [first, first + 1, first + 2];
    [(x, y, s[z]), (x, z, -s[y]), (y, z, s[x])]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // H = J S_1·S_2. A field adds −γ B·S, an easy axis D S_z².
    let j = 0.7;
    let pair = Hamiltonian::new(3, |a, b| j * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]))?
        .with_bracket(|s| [spin(s, 0), spin(s, 3)].concat())?;
    let length = Hamiltonian::new(3, |a, _| a.iter().map(|x| x.powi(2)).sum::<Var>())?;

    // S_1 and S_2, both of length 1, are the halves of the state.
    let (a, b) = ([1.0, 0.0, 0.0], [0.6, 0.8, 0.0]);
    // Both rotate about M = S_1 + S_2 at the rate J |M|: after half a turn they are exchanged.
    let half = PI / (j * 3.2_f64.sqrt());
    let run = Equip::stages(6)
        .step(half / 20.0)
        .invariant(Invariant::new("|S_1|²", length))
        .integrate(&pair, &a, &b, 0.0..=101.0 * half)?;
    println!("{}", run.certificate());
    assert!(run.certificate().energy_conserved_on_every_step());
    assert!(run.certificate().invariants[0].max < 1e-13);

    let (_, a, b) = run.last();
    println!("S_1 = {a:.12?}, S_2 = {b:.12?}");
    let exact = [0.6, 0.8, 0.0, 1.0, 0.0, 0.0];
    let pairs = a.iter().chain(b).zip(&exact);
    assert!(pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) < 1e-10);
    Ok(())
}
