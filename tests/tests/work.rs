//! The work of standard runs, to the last evaluation: a regression in work fails here, without any clock.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Alphas, Equip, Gauss, Method, Preconditioner};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, double_pendulum, henon_heiles, kepler};

/// [steps, sweeps, Newton iterations, factorisations, ∇H, ∇²H, solves for α, halvings].
fn work<T: Float>(
    method: Method,
    h: T,
    steps: u64,
    scene: &(Hamiltonian, Start<T>),
    solver: Preconditioner,
) -> [u64; 8] {
    let (energy, start) = scene;
    let mut run = method
        .step(h)
        .preconditioner(solver)
        .start(energy, &start.q, &start.p, T::int(0))
        .unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    let c = run.counts();
    [
        c.steps,
        c.sweeps,
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
    let count = |method, solver| work(method, h, 1600, &scene, solver);
    let found = [
        count(Gauss::stages(3), Preconditioner::Automatic),
        count(Gauss::stages(3), Preconditioner::Full),
        count(Equip::stages(3), Preconditioner::Automatic),
        count(Equip::stages(3), Preconditioner::Full),
        count(Equip::stages(3).alphas(Alphas::Last), Preconditioner::Full),
        count(Equip::stages(4), Preconditioner::Identity),
    ];
    assert_eq!(
        found,
        [
            [1600, 5652, 0, 0, 16956, 0, 0, 0],
            [1600, 0, 5567, 2251, 16701, 6753, 0, 0],
            [1600, 7199, 0, 0, 46876, 0, 3192, 0],
            [1600, 0, 6635, 2602, 31698, 11934, 5400, 0],
            [1600, 0, 7415, 2401, 30689, 7203, 3577, 0],
            [1600, 4845, 0, 0, 21389, 0, 0, 0],
        ]
    );
}

/// Hénon–Heiles E = 1/8 at h = 1/4 up to t = 100, s = 6, in both float types.
#[test]
fn henon_heiles_in_both() {
    let scene = henon_heiles::<f64>(0.125, "0.3", "0");
    let count = |method, solver| work(method, 0.25, 400, &scene, solver);
    let found = [
        count(Gauss::stages(6), Preconditioner::Automatic),
        count(Gauss::stages(6), Preconditioner::Full),
        count(Equip::stages(6), Preconditioner::Automatic),
        count(Equip::stages(6), Preconditioner::Full),
    ];
    assert_eq!(
        found,
        [
            [400, 1936, 0, 0, 11616, 0, 0, 0],
            [400, 0, 1767, 694, 10602, 4164, 0, 0],
            [400, 1668, 0, 0, 10409, 0, 0, 0],
            [400, 0, 1767, 694, 12367, 4164, 0, 0]
        ]
    );
    let scene = henon_heiles::<DoubleDouble>(DoubleDouble::ratio(1, 8), "0.3", "0");
    let count = |method, solver| work(method, DoubleDouble::ratio(1, 4), 400, &scene, solver);
    let found = [
        count(Gauss::stages(6), Preconditioner::Automatic),
        count(Equip::stages(6), Preconditioner::Automatic),
        count(Equip::stages(6), Preconditioner::Identity),
        count(Equip::stages(6), Preconditioner::Full),
    ];
    assert_eq!(
        found,
        [
            [400, 4128, 0, 0, 24768, 0, 0, 0],
            [400, 6798, 25, 9, 52969, 15709, 7251, 0],
            [400, 5420, 0, 0, 33357, 0, 0, 0],
            [400, 0, 12073, 4665, 110109, 53190, 40698, 0]
        ]
    );
}

/// The double pendulum, which is not separable, at h = 1/50 up to t = 4, s = 4.
#[test]
fn double_pendulum_in_f64() {
    let scene = double_pendulum::<f64>();
    let count = |method, solver| work(method, 0.02, 200, &scene, solver);
    let found = [
        count(Gauss::stages(4), Preconditioner::Automatic),
        count(Equip::stages(4), Preconditioner::Automatic),
        count(Equip::stages(4), Preconditioner::Identity),
        count(Equip::stages(4), Preconditioner::Full),
    ];
    assert_eq!(
        found,
        [
            [200, 1462, 0, 0, 5848, 0, 0, 0],
            [200, 1828, 0, 0, 13293, 0, 642, 0],
            [200, 1726, 0, 0, 7257, 0, 0, 0],
            [200, 0, 1023, 320, 5894, 1930, 951, 0]
        ]
    );
}

/// Sweeps that the energy costs: EQUIP(s) over Gauss(s) on the same steps, in percent of the sweeps of Gauss.
#[test]
fn sweeps_beside_gauss() {
    let percent = |s: usize, h: f64, steps: u64, scene: &(Hamiltonian, Start<f64>)| {
        let sweeps = |method| work(method, h, steps, scene, Preconditioner::Identity)[1];
        100 * sweeps(Equip::stages(s)) / sweeps(Gauss::stages(s))
    };
    let orbit = kepler::<f64>(6);
    let chaotic = henon_heiles::<f64>(1.0 / 6.0, "0.1", "0");
    let year = std::f64::consts::TAU;
    let found = [4, 6, 8].map(|s| {
        [
            percent(s, year / 24.0, 2400, &orbit),
            percent(s, year / 48.0, 4800, &orbit),
            percent(s, 0.5, 1000, &chaotic),
            percent(s, 0.25, 2000, &chaotic),
        ]
    });
    assert_eq!(
        found,
        [[135, 120, 138, 150], [116, 107, 138, 86], [104, 91, 95, 96]]
    );
}
