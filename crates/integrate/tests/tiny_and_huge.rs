//! Forces and states at the ends of the floating-point range, and tangent vectors of driven systems.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Equip, Gauss, IntegrateError, TangentMap};
use std::f64::consts::PI;

/// A pulse exp(−(t − 30)²) drives an oscillator at rest: the force is subnormal on the way. In the end the
/// amplitude is |∫ e^{it − (t − 30)²} dt| = √π e^{−1/4}.
#[test]
fn a_force_may_be_subnormal() {
    let driven = Hamiltonian::with_time(1, |t, q, p| {
        let pulse = (-(t - 30.0).powi(2)).exp();
        0.5 * (q[0] * q[0] + p[0] * p[0]) - q[0] * pulse
    })
    .unwrap();
    let exact = PI.sqrt() * (-0.25_f64).exp();
    for options in [
        Equip::stages(8).tolerance(1e-12),
        Gauss::stages(8).step(0.1),
    ] {
        let run = options
            .integrate(&driven, &[0.0], &[0.0], 0.0..=60.0)
            .unwrap();
        let (_, q, p) = run.last();
        let error = q[0].hypot(p[0]) - exact;
        assert!(error.abs() < 1e-11, "{error:e}");
    }
    // q' = −q, down to 1e-347.
    let decay = Hamiltonian::new(1, |q, p| -1.0 * p[0] * q[0]).unwrap();
    let run = Equip::stages(8).tolerance(1e-12);
    let run = run.integrate(&decay, &[1.0], &[0.0], 0.0..=800.0).unwrap();
    assert!(run.last().1[0].abs() < 1e-300);
}

/// A barrier 2 exp(−q²), 13 to 20 widths away: at the start its force is 1e-70 to 1e-170, and turns the
/// particle in a time far beyond the end of the run. It returns with the opposite momentum.
#[test]
fn a_barrier_may_be_far_away() {
    let barrier =
        Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + 2.0 * (-q[0].powi(2)).exp()).unwrap();
    for distance in [11.0, 13.0, 16.0, 20.0] {
        let run = Equip::stages(8)
            .tolerance(1e-12)
            .integrate(&barrier, &[-distance], &[1.0], 0.0..=2.0 * distance)
            .unwrap();
        let (_, _, p) = run.last();
        assert!((p[0] + 1.0).abs() < 1e-10, "{:e}", p[0] + 1.0);
    }
}

/// J_n(x) = ∫₀^π cos(nθ − x sin θ) dθ/π; the sum converges like J_{2·256 − n}(x).
fn bessel(n: usize, x: f64) -> f64 {
    let angles = (0..256).map(|k| (f64::from(k) + 0.5) * PI / 256.0);
    angles
        .map(|a| (n as f64 * a - x * a.sin()).cos())
        .sum::<f64>()
        / 256.0
}

/// One mass of a chain at rest is displaced: q_k(t) = J_{2k}(2t), which begins as t^{2k} (Schrödinger 1914).
#[test]
fn a_wave_may_enter_a_chain_at_rest() {
    let n = 64;
    let chain = Hamiltonian::new(n, |q, p| {
        let kinetic: Var = p.iter().map(|&p| 0.5 * p * p).sum();
        let springs = (0..n).map(|k| 0.5 * (q[(k + 1) % n] - q[k]).powi(2));
        kinetic + springs.sum::<Var>()
    })
    .unwrap();
    let mut q = vec![0.0; n];
    q[n / 2] = 1.0;
    for (stages, start) in [2, 3, 4, 8, 16].into_iter().zip([0.0, -0.3, 1e3, 0.0, 5.0]) {
        for tolerance in [1e-4, 1e-7, 1e-10] {
            let run = Equip::stages(stages)
                .tolerance(tolerance)
                .integrate(&chain, &q, &vec![0.0; n], start..=start + 10.0)
                .unwrap();
            let error = |k: usize| (run.last().1[k] - bessel(2 * k.abs_diff(n / 2), 20.0)).abs();
            let error = (0..n).map(error).fold(0.0, f64::max);
            assert!(error < 30.0 * tolerance, "{stages}: {error:e}");
        }
    }
}

/// q″ = −q + t^k from q = q′ = 0: q begins as t^{k+2}, and no component has a scale.
#[test]
fn a_drive_may_set_in_like_a_power_of_time() {
    let exact = [
        |t: f64| t - t.sin(),
        |t: f64| t * t - 2.0 + 2.0 * t.cos(),
        |t: f64| t.powi(3) - 6.0 * t + 6.0 * t.sin(),
    ];
    for (k, exact) in exact.into_iter().enumerate() {
        for (start, stages) in [(0.0, 2), (0.0, 3), (-4.0, 4), (0.0, 8)] {
            let driven = Hamiltonian::with_time(1, |t, q, p| {
                0.5 * (q[0] * q[0] + p[0] * p[0]) - q[0] * (t - start).powi(k as i32 + 1)
            })
            .unwrap();
            for tolerance in [1e-4, 1e-7, 1e-10] {
                let run = Equip::stages(stages)
                    .tolerance(tolerance)
                    .integrate(&driven, &[0.0], &[0.0], start..=start + 5.0)
                    .unwrap();
                let error = run.last().1[0] - exact(5.0);
                assert!(error.abs() < 300.0 * tolerance, "{k} {stages}: {error:e}");
            }
        }
    }
}

#[test]
fn a_state_that_overflows_ends_the_run() {
    let free = Hamiltonian::new(1, |_, p| 0.5 * p[0] * p[0]).unwrap();
    let run = Equip::stages(8).tolerance(1e-12);
    let run = run.integrate(&free, &[0.0], &[1.0], -f64::MAX..=f64::MAX);
    assert!(run.unwrap_err().error.to_string().contains("its length"));
    for end in [1e209, 1e250] {
        let run = Equip::stages(8).tolerance(1e-12);
        let failure = run
            .integrate(&free, &[0.0], &[1e100], 0.0..=end)
            .unwrap_err();
        let is_told = matches!(failure.error, IntegrateError::NotFinite { .. });
        assert!(is_told, "{}", failure.error);
    }
}

/// Mathieu's equation q″ = −(1 + 0.9 cos 2t) q. It is linear, so its exponent is the logarithm of the
/// spectral radius of the map over one period, divided by π, whatever the orbit.
#[test]
fn lyapunov_exponents_of_driven_systems() {
    let mathieu = Hamiltonian::with_time(1, |t, q, p| {
        0.5 * p[0] * p[0] + 0.5 * (1.0 + 0.9 * (2.0 * t).cos()) * q[0] * q[0]
    })
    .unwrap();
    let mut run = Equip::stages(8)
        .step(PI / 40.0)
        .start(&mathieu, &[0.0], &[0.0], 0.0)
        .unwrap();
    let mut map = TangentMap::new(&mathieu, &mut run);
    let mut columns = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]].concat();
    map.advance_to(&mut run, PI, &mut columns).unwrap();
    let half = (columns[0] + columns[6]) / 2.0;
    let exact = (half.abs() + (half * half - 1.0).sqrt()).ln() / PI;
    for start in [1e-8, 1.0] {
        let run = Equip::stages(8)
            .tolerance(1e-10)
            .chaos()
            .integrate(&mathieu, &[start], &[0.0], 0.0..=800.0)
            .unwrap();
        let found = run.certificate().chaos.unwrap().lyapunov;
        assert!(
            (found - exact).abs() < 0.03 * exact,
            "{found} from {start}, exactly {exact}"
        );
    }
}
