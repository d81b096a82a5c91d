//! ∇²H at all stages far from contraction: few iterations, and hardly more of them for twice the digits.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Gauss, Method, Preconditioner};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, double_pendulum};

/// Iterations a step of 40 steps, none of which is halved.
fn iterations<T: Float>(method: Method, (energy, start): &(Hamiltonian, Start<T>), h: T) -> f64 {
    let options = method.step(h).max_halvings(0);
    let options = options.preconditioner(Preconditioner::Full);
    let mut run = options
        .start(energy, &start.q, &start.p, T::int(0))
        .unwrap();
    for _ in 0..40 {
        run.advance().unwrap();
    }
    let c = run.counts();
    assert_eq!(
        (
            c.fixed_point_iterations,
            c.preconditioner_changes,
            c.halvings
        ),
        (0, 0, 0)
    );
    let found = c.newton_iterations as f64 / c.steps as f64;
    println!("{method}, {}, h = {h:.2}: {found:.2}", T::NAME);
    found
}

/// A pendulum on a spring of stiffness 10⁶.
fn spring_pendulum<T: Float>() -> (Hamiltonian, Start<T>) {
    let scene = equip_scenes::find("spring-pendulum").unwrap();
    let scene = scene.instance(&[("k", "1e6")]).unwrap();
    let (q, p) = scene.initial();
    (scene.hamiltonian().clone(), Start { q, p })
}

/// What plain iterations do with the first step.
fn fixed_point_iteration_fails((energy, start): &(Hamiltonian, Start<f64>), h: f64) {
    let options = Gauss::stages(4).step(h).max_halvings(0);
    let options = options.preconditioner(Preconditioner::Identity);
    let mut run = options.start(energy, &start.q, &start.p, 0.0).unwrap();
    assert!(run.advance().is_err());
}

#[test]
fn on_a_stiff_spring() {
    // hω = 10 and 50: measured 4.90 and 5.83, in double-double 5.17 and 6.17.
    for (n, d) in [(1, 100), (1, 20)] {
        let h = f64::ratio(n, d);
        fixed_point_iteration_fails(&spring_pendulum(), h);
        let double = iterations(Gauss::stages(4), &spring_pendulum(), h);
        let h = DoubleDouble::ratio(n, d);
        let wide = iterations(Gauss::stages(4), &spring_pendulum(), h);
        assert!(double <= 8.0 && wide <= double + 3.0);
    }
}

#[test]
fn on_the_double_pendulum() {
    let double = iterations(Gauss::stages(4), &double_pendulum(), 0.2);
    let h = DoubleDouble::ratio(1, 5);
    let wide = iterations(Gauss::stages(4), &double_pendulum(), h);
    assert!(double <= 8.0 && wide <= double + 3.0);
}
