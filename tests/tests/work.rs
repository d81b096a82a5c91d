//! The work of standard runs, to the last evaluation: a regression in work fails here, without any clock.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_scalar::{DoubleDouble, Float};
use equip_solver::{Alphas, Equip, Gauss, Method};
use equip_tests::{Start, double_pendulum, henon_heiles, kepler};

/// [steps, Newton iterations, factorisations, ∇H, ∇²H, solves for α, halvings].
fn work<T: Float>(method: Method, h: T, steps: u64, scene: &(Hamiltonian, Start<T>)) -> [u64; 7] {
    let (energy, start) = scene;
    let mut run = method
        .step(h)
        .start(energy, &start.q, &start.p, T::int(0))
        .unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    let c = run.counts();
    [
        c.steps,
        c.newton_iterations,
        c.factorisations,
        c.gradients,
        c.hessians,
        c.alpha_solves,
        c.halvings,
    ]
}

/// Ten periods of Kepler e = 0.6 with 160 steps each, s = 3.
#[test]
fn kepler_in_f64() {
    let scene = kepler::<f64>(6);
    let h = std::f64::consts::TAU / 160.0;
    let count = |method| work(method, h, 1600, &scene);
    let found = [
        count(Gauss::stages(3)),
        count(Equip::stages(3)),
        count(Equip::stages(3).alphas(Alphas::Last)),
    ];
    assert_eq!(
        found,
        [
            [1600, 3931, 2251, 11793, 6753, 0, 0],
            [1600, 4909, 2602, 24779, 11922, 5385, 0],
            [1600, 5724, 2401, 23922, 7203, 3566, 0],
        ]
    );
}

/// Hénon–Heiles E = 1/8 at h = 1/4 up to t = 100, s = 6, in both float types.
#[test]
fn henon_heiles_in_both() {
    let scene = henon_heiles::<f64>(0.125, "0.3", "0");
    let count = |method| work(method, 0.25, 400, &scene);
    let found = [count(Gauss::stages(6)), count(Equip::stages(6))];
    assert_eq!(
        found,
        [
            [400, 1201, 694, 7206, 4164, 0, 0],
            [400, 1201, 694, 8405, 4164, 0, 0]
        ]
    );
    let scene = henon_heiles::<DoubleDouble>(DoubleDouble::ratio(1, 8), "0.3", "0");
    let count = |method| work(method, DoubleDouble::ratio(1, 4), 400, &scene);
    let found = [count(Gauss::stages(6)), count(Equip::stages(6))];
    assert_eq!(
        found,
        [
            [400, 1202, 802, 7212, 4812, 0, 0],
            [400, 2741, 1465, 22385, 11590, 5132, 0]
        ]
    );
}

/// The double pendulum, which is not separable, at h = 1/50 up to t = 4, s = 4.
#[test]
fn double_pendulum_in_f64() {
    let scene = double_pendulum::<f64>();
    let count = |method| work(method, 0.02, 200, &scene);
    let found = [count(Gauss::stages(4)), count(Equip::stages(4))];
    assert_eq!(
        found,
        [
            [200, 572, 288, 2288, 1152, 0, 0],
            [200, 774, 320, 4661, 1940, 964, 0]
        ]
    );
}
