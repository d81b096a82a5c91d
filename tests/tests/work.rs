//! The work and the decisions of standard runs, to the last evaluation: a change in either fails here,
//! without any clock.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Alphas, Equip, Gauss, Method, Outcome, Preconditioner};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, double_pendulum, henon_heiles, kepler};

/// [fixed-point iterations, those with a preconditioner, factorisations, ∇H, ∇²H, search directions,
/// updates of α, local errors], and the steps [at round-off, solved, uncorrected, halved].
fn work<T: Float>(
    method: Method,
    h: T,
    steps: u64,
    scene: &(Hamiltonian, Start<T>),
    solver: Preconditioner,
) -> ([u64; 8], [u64; 4]) {
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
    let work = [
        c.fixed_point_iterations,
        c.newton_iterations,
        c.factorisations,
        c.gradients,
        c.hessians,
        c.directions,
        c.alpha_updates,
        c.local_errors,
    ];
    let [floor, solved] = [Outcome::AtRoundOff, Outcome::Solved].map(|o| c.outcome(o));
    (work, [floor, solved, c.uncorrected(), c.halvings])
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
            ([6317, 0, 0, 18951, 0, 0, 0, 0], [0, 0, 0, 0]),
            ([0, 6456, 3490, 19368, 10470, 0, 0, 0], [0, 0, 0, 0]),
            ([8053, 0, 0, 27143, 2715, 905, 1052, 40], [695, 905, 0, 0]),
            (
                [0, 8380, 3490, 28019, 13176, 902, 1046, 40],
                [698, 902, 0, 0]
            ),
            (
                [0, 8458, 3490, 28158, 13113, 881, 1000, 19],
                [719, 863, 18, 0]
            ),
            ([6103, 0, 0, 26502, 1172, 293, 314, 22], [1310, 290, 0, 0])
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
            ([2056, 0, 0, 12336, 0, 0, 0, 0], [0, 0, 0, 0]),
            ([0, 1999, 1200, 11994, 7200, 0, 0, 0], [0, 0, 0, 0]),
            ([1957, 0, 0, 12143, 0, 0, 0, 0], [400, 0, 0, 0]),
            ([0, 1999, 1200, 12395, 7200, 0, 0, 0], [400, 0, 0, 0])
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
            ([4359, 0, 0, 26154, 0, 0, 0, 0], [0, 0, 0, 0]),
            ([5519, 0, 0, 35157, 2400, 400, 1003, 0], [0, 400, 0, 0]),
            ([5519, 0, 0, 35157, 2400, 400, 1003, 0], [0, 400, 0, 0]),
            ([0, 3337, 1200, 21362, 9600, 400, 797, 0], [0, 400, 0, 0])
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
            ([1639, 0, 0, 6556, 0, 0, 0, 0], [0, 0, 0, 0]),
            ([2261, 0, 0, 9435, 488, 122, 182, 0], [78, 122, 0, 0]),
            ([2261, 0, 0, 9435, 488, 122, 182, 0], [78, 122, 0, 0]),
            ([0, 1502, 600, 6391, 2888, 122, 182, 0], [78, 122, 0, 0])
        ]
    );
}

/// Iterations that conserving the energy costs: EQUIP(s) over Gauss(s) on the same steps, in percent of the
/// iterations of Gauss.
#[test]
fn iterations_compared_with_gauss() {
    let percent = |s: usize, h: f64, steps: u64, scene: &(Hamiltonian, Start<f64>)| {
        let iterations = |method| work(method, h, steps, scene, Preconditioner::Identity).0[0];
        100 * iterations(Equip::stages(s)) / iterations(Gauss::stages(s))
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
        [[256, 194, 186, 153], [110, 92, 116, 93], [102, 89, 92, 84]]
    );
}
