//! Forces that are known to few digits, as of stiff springs near their length and far from the origin.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Equip, Gauss, Run};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Three bodies in a plane, `far` from the origin.
fn three_bodies(far: f64) -> (Hamiltonian, [f64; 6], [f64; 6]) {
    let energy = Hamiltonian::new(6, |q, p| {
        let inverse = |i: usize, j: usize| {
            let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
            1.0 / (x * x + y * y).sqrt()
        };
        let potential = inverse(0, 1) + inverse(0, 2) + inverse(1, 2);
        0.5 * p.iter().map(|&p| p * p).sum::<Var>() - potential
    });
    let q = [0.0, 0.0, 1.0, 0.125, 0.375, 5.0].map(|x| far + x);
    (energy.unwrap(), q, [0.0, 0.7, 0.0, -0.7, 0.3, 0.0])
}

fn apart(a: &Run<f64>, b: &Run<f64>) -> f64 {
    let ((_, q, p), (_, r, s)) = (a.last(), b.last());
    let pairs = q.iter().chain(p).zip(r.iter().chain(s));
    pairs.fold(0.0, |most, (x, y)| most.max((x - y).abs()))
}

/// Where the last place of the state moves a force by more than the tolerance of the motion, nothing is
/// resolved by shorter steps: bodies 10⁸ from the origin take no more of them than at it, but for 20, and a
/// stiff spring that hangs at its length at most two for each radian of its swings.
#[test]
fn forces_that_are_rounding_shorten_no_steps() {
    let spring = Hamiltonian::new(2, |q, p| {
        let stretch = (q[0] * q[0] + q[1] * q[1]).sqrt() - 1.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 5e5 * stretch * stretch + q[1]
    });
    let spring = spring.unwrap();
    let equal =
        Gauss::stages(12)
            .step(5e-4)
            .integrate(&spring, &[1.0, 0.0], &[0.0, 0.0], 0.0..=2.0);
    let by_equal_steps = equal.unwrap();
    for (s, tolerance) in [(4, 1e-9), (4, 1e-12), (8, 1e-9), (8, 1e-12), (8, 1e-14)] {
        let method = Equip::stages(s).tolerance(tolerance).max_steps(5000);
        let [near, far] = [0.0, 1e8].map(|far| {
            let (energy, q, p) = three_bodies(far);
            let run = method.integrate(&energy, &q, &p, 0.0..=10.0).unwrap();
            let (_, q, _) = run.last();
            let places: Vec<f64> = q.iter().map(|x| x - far).collect();
            (run.certificate().counts.steps, places)
        });
        assert!(
            far.0 <= near.0 + 20,
            "s = {s}, {tolerance:e}: {} steps, {}",
            far.0,
            near.0
        );
        for (far, near) in far.1.iter().zip(&near.1) {
            assert!(
                (far - near).abs() < 1e-5,
                "s = {s}, {tolerance:e}: {far}, {near}"
            );
        }
        let run = method.integrate(&spring, &[1.0, 0.0], &[0.0, 0.0], 0.0..=2.0);
        let run = run.unwrap();
        let (steps, off) = (run.certificate().counts.steps, apart(&run, &by_equal_steps));
        assert!(steps <= 4000, "s = {s}, {tolerance:e}: {steps} steps");
        assert!(off < 1e-9, "s = {s}, {tolerance:e}: {off:e}");
    }
}

/// The nonlinear Schrödinger equation on 256 points, its Laplace operator by sums of Fourier: in the tails of
/// a wave the gradient is rounding of that at its crest.
#[test]
fn gradients_from_outside_round_as_their_largest_component() {
    const N: usize = 256;
    let length = 40.0;
    let table: Vec<(f64, f64)> = (0..N)
        .map(|j| (TAU * j as f64 / N as f64).sin_cos())
        .collect();
    let table = Arc::new(table);
    let laplace = move |u: &[f64], out: &mut [f64]| {
        out.fill(0.0);
        for k in 1..=N / 2 {
            let at = |j: usize| table[(j * k) % N];
            let (mut c, mut s) = (0.0, 0.0);
            for (j, &u) in u.iter().enumerate() {
                let (sin, cos) = at(j);
                (c, s) = (c + u * cos, s + u * sin);
            }
            let twice = if k == N / 2 { 1.0 } else { 2.0 };
            let square = (TAU * k as f64 / length).powi(2) * twice / N as f64;
            for (j, out) in out.iter_mut().enumerate() {
                let (sin, cos) = at(j);
                *out += square * (c * cos + s * sin);
            }
        }
    };
    let of_gradient = laplace.clone();
    let value = move |q: &[f64], p: &[f64]| {
        let (mut lq, mut lp) = ([0.0; N], [0.0; N]);
        laplace(q, &mut lq);
        laplace(p, &mut lp);
        (0..N)
            .map(|j| {
                let density = q[j] * q[j] + p[j] * p[j];
                (q[j] * lq[j] + p[j] * lp[j] - density * density) / 4.0
            })
            .sum()
    };
    let gradient = move |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
        of_gradient(q, dq);
        of_gradient(p, dp);
        for j in 0..N {
            let density = q[j] * q[j] + p[j] * p[j];
            (dq[j], dp[j]) = (dq[j] / 2.0 - density * q[j], dp[j] / 2.0 - density * p[j]);
        }
    };
    let h = Hamiltonian::external(N, 2.0_f64.powi(-50), value, gradient).unwrap();
    let wave = |j: usize| {
        let x = (j as f64 - N as f64 / 2.0) * length / N as f64;
        let (sin, cos) = (0.5 * x).sin_cos();
        (cos / x.cosh(), sin / x.cosh())
    };
    let (q, p): (Vec<f64>, Vec<f64>) = (0..N).map(wave).unzip();
    let run = |options: equip_integrate::Integrator<f64>| {
        options.integrate(&h, &q, &p, 0.0..=0.001).unwrap()
    };
    let by_tolerance = run(Gauss::stages(4).tolerance(1e-12).max_steps(20));
    let by_equal_steps = run(Gauss::stages(8).step(0.0005));
    assert!(apart(&by_tolerance, &by_equal_steps) < 1e-12);
}

/// A component near rest whose force is a difference of numbers of order one: its momentum carries the
/// rounding of the force, and the steps are those of the uncoupled oscillator.
#[test]
fn a_quiet_component_shortens_no_steps() {
    let energy = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0]) + (-q[1]).exp() + q[1]
    });
    let energy = energy.unwrap();
    for tolerance in [1e-8, 1e-12] {
        for quiet in [1e-6, 1e-10, 1e-12, 1e-14] {
            let options = Equip::stages(8).tolerance(tolerance).max_steps(300);
            let run = options
                .integrate(&energy, &[1.0, quiet], &[0.0, 0.0], 0.0..=10.0)
                .unwrap();
            let (_, q, _) = run.last();
            println!(
                "{tolerance:e}, {quiet:e}: {}",
                run.certificate().counts.steps
            );
            assert!((q[0] - 10f64.cos()).abs() < 1e-9);
            assert!((q[1] - quiet * 10f64.cos()).abs() < 1e-3 * quiet + 1e-14);
        }
    }
}
