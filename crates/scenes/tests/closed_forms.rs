//! Closed forms satisfy the equations of motion, keep H, start at the start and have the stated period.
#![allow(clippy::unwrap_used)]

use crate::common::{gradient, start, value};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::{Instance, find};

type Values = &'static [(&'static str, &'static str)];

/// Scenes with a closed form, and the part of their period over which they look like a polynomial.
const CASES: &[(&str, Values, f64)] = &[
    ("harmonic", &[], 0.1),
    (
        "harmonic",
        &[("m", "5"), ("ratio", "0.7"), ("omega", "1/3")],
        0.1,
    ),
    ("kepler", &[("e", "0")], 0.1),
    ("kepler", &[("mu", "3")], 0.02),
    ("kepler", &[("e", "0.9")], 1e-3),
    ("kepler", &[("e", "0.99")], 5e-5),
    ("kepler", &[("e", "0.999999")], 5e-11),
    ("pendulum", &[], 0.1),
    ("pendulum", &[("q", "3"), ("p", "0")], 0.02),
    ("pendulum", &[("q", "-1"), ("p", "-1.5")], 0.02),
    ("pendulum", &[("q", "1e-10"), ("p", "0")], 0.1),
    ("pendulum", &[("p", "1.9999999999")], 0.01),
    ("pendulum", &[("p", "2.0000000001")], 0.01),
    ("pendulum", &[("p", "2")], 0.05),
    ("pendulum", &[("p", "-2")], 0.05),
    ("pendulum", &[("q", "2.5"), ("p", "-3")], 0.05),
    ("pendulum", &[("p", "100")], 0.1),
    ("quartic", &[], 0.05),
    ("quartic", &[("q", "0"), ("p", "2")], 0.05),
    ("quartic", &[("q", "-2"), ("p", "-1.5")], 0.05),
    ("fput-beta", &[("beta", "0"), ("n", "7")], 0.1),
    ("dnls", &[("modulation", "0"), ("n", "5")], 0.1),
    ("n-body", &[("disorder", "0"), ("n", "5")], 0.1),
];

fn instances() -> impl Iterator<Item = (String, Instance, f64)> {
    CASES.iter().map(|&(name, values, part)| {
        let instance = find(name).unwrap().instance(values).unwrap();
        (format!("{name} {values:?}"), instance, part)
    })
}

fn at<T: Float>(instance: &Instance, t: T) -> Vec<T> {
    let (mut q, p) = instance.exact(t).unwrap();
    q.extend(p);
    q
}

/// 2π.
fn turn<T: Float>() -> T {
    T::two_pi()
}

/// max |a − b| / max |b|.
fn relative<T: Float>(a: &[T], b: &[T]) -> f64 {
    let largest = |v: &mut dyn Iterator<Item = T>| v.fold(T::int(0), |m, x| m.max(x.abs()));
    let difference = largest(&mut a.iter().zip(b).map(|(&a, &b)| a - b));
    (difference / largest(&mut b.iter().copied())).to_f64()
}

/// ẏ at t by central differences of order 16, h apart.
fn derivative<T: Float>(instance: &Instance, t: T, h: T) -> Vec<T> {
    const N: i64 = 8;
    let mut sum = vec![T::int(0); at(instance, t).len()];
    let mut weight = T::int(-2);
    for k in 1..=N {
        // 2 (−1)^{k+1} (N!)² / (k (N−k)! (N+k)!) from that of k − 1, without the 1/k.
        weight = -weight * T::ratio(N - k + 1, N + k);
        let step = h * T::int(k);
        let (after, before) = (at(instance, t + step), at(instance, t - step));
        for (s, (&a, &b)) in sum.iter_mut().zip(after.iter().zip(&before)) {
            *s += weight / T::int(k) * (a - b) / (h + h);
        }
    }
    sum
}

#[test]
fn they_satisfy_the_equations_of_motion() {
    type T = DoubleDouble;
    for (name, instance, part) in instances() {
        let period = instance.period::<T>();
        for eighths in [0, 1, 3, 6, 11] {
            let t = period * T::ratio(eighths, 8);
            let y = at(&instance, t);
            let mut h = period * T::exact(part / 64.0);
            if name.starts_with("kepler") {
                // `part` is that of the pericentre; time scales with r^{3/2} along the orbit.
                let r = |y: &[T]| y[0].hypot(y[1]);
                let growth = r(&y) / r(&start(&instance));
                h *= growth * growth.sqrt();
            }
            let m = y.len() / 2;
            let (_, dh) = gradient(instance.hamiltonian(), &y);
            let field: Vec<T> = dh[m..]
                .iter()
                .copied()
                .chain(dh[..m].iter().map(|&g| -g))
                .collect();
            let error = relative(&derivative(&instance, t, h), &field);
            // Measured 6.8e-26 (the order of the differences, not round-off).
            assert!(error < 1e-24, "{name} at {eighths}/8: {error:e}");
        }
    }
}

fn energy_is_kept<T: Float>(bound: f64) {
    for (name, instance, _) in instances() {
        let h = instance.hamiltonian();
        let y0 = start::<T>(&instance);
        let h0 = value(h, &y0);
        let period = instance.period::<T>();
        for k in 0..40 {
            let y = at(&instance, period * T::ratio(k, 16));
            let (h1, dh) = gradient(h, &y);
            let floor = y
                .iter()
                .zip(&dh)
                .fold(h1.abs(), |s, (&y, &g)| s + (y * g).abs());
            let defect = ((h1 - h0).abs() / floor / T::EPSILON).to_f64();
            assert!(defect < bound, "{name} in {} at {k}/16: {defect}", T::NAME);
        }
    }
}

#[test]
fn they_keep_h_to_round_off() {
    // Measured 15.5 and 15.2, both at the top of a swing of 172 degrees.
    energy_is_kept::<f64>(60.0);
    energy_is_kept::<DoubleDouble>(60.0);
}

fn returns<T: Float>(bound: f64) {
    for (name, instance, _) in instances() {
        let y0 = start::<T>(&instance);
        let now = relative(&at(&instance, T::int(0)), &y0);
        assert!(
            now < 4.0 * T::EPSILON.to_f64(),
            "{name} in {} at 0: {now:e}",
            T::NAME
        );
        let is_periodic = !name.contains("\"ratio\"")
            && !name.contains("(\"p\", \"2\")")
            && !name.contains("(\"p\", \"-2\")");
        if !is_periodic {
            continue;
        }
        let mut y = at(&instance, instance.period::<T>());
        let rotates = name.starts_with("pendulum") && (y[0] - y0[0]).abs() > T::int(6);
        if rotates {
            let turn = if y0[1] > T::int(0) {
                T::two_pi()
            } else {
                -T::two_pi()
            };
            y[0] -= turn;
        }
        let speed = {
            let (_, dh) = gradient(instance.hamiltonian(), &y0);
            dh.iter().fold(T::int(0), |m, g| m.max(g.abs()))
        };
        // An error of ε in the phase moves the state by ε·period·speed.
        let size = y0.iter().fold(T::int(0), |m, y| m.max(y.abs()));
        let condition = T::int(1) + instance.period::<T>() * speed / size;
        let error = relative(&y, &y0) / (condition * T::EPSILON).to_f64();
        assert!(
            error < bound,
            "{name} in {} after a period: {error}",
            T::NAME
        );
    }
}

#[test]
fn they_start_at_the_start_and_return_after_a_period() {
    // Measured 0.58 and 0.36.
    returns::<f64>(4.0);
    returns::<DoubleDouble>(4.0);
}

#[test]
fn a_rotating_pendulum_counts_its_turns() {
    for p in ["3", "-3", "2.001"] {
        let pendulum = find("pendulum")
            .unwrap()
            .instance(&[("q", "2"), ("p", p)])
            .unwrap();
        let period = pendulum.period::<f64>();
        let mut last = 2.0;
        for k in 1..400 {
            let (q, p) = pendulum.exact(f64::from(k) * period / 40.0).unwrap();
            // It never turns back, and never jumps.
            let step = (q[0] - last) * p[0].signum();
            assert!(step > 0.0 && step < 2.0, "{k}: {last} to {}", q[0]);
            last = q[0];
        }
    }
}

#[test]
fn kepler_at_every_anomaly_of_a_needle() {
    // Started at the apocentre side as well: the same ellipse, reached from another state.
    type T = DoubleDouble;
    let needle = find("kepler").unwrap().instance(&[("e", "0.99")]).unwrap();
    let period = needle.period::<T>();
    assert!((period - turn::<T>()).abs().to_f64() < 1e-28);
    let momentum = |y: &[T]| y[0] * y[3] - y[1] * y[2];
    let l0 = momentum(&start::<T>(&needle));
    for k in -50..50 {
        let y = at(&needle, period * T::ratio(k * k * k, 50 * 50 * 50));
        let defect = ((momentum(&y) - l0) / l0).abs().to_f64();
        // Measured 4e-30.
        assert!(defect < 1e-28, "{k}: {defect:e}");
    }
    let half = at(&needle, period * T::ratio(1, 2));
    assert!((half[0] + T::ratio(199, 100)).abs().to_f64() < 1e-29);
}

#[test]
fn the_flow_from_anywhere_is_a_flow() {
    // Φ(s + t) = Φ(t) ∘ Φ(s), from states that are no scene's start.
    type T = DoubleDouble;
    for (name, q, p) in [
        ("kepler", vec![-1.5, 0.3], vec![0.2, -0.6]),
        ("kepler", vec![0.1, 0.2], vec![2.0, 1.5]),
        ("harmonic", vec![0.3, -2.0], vec![1.0, 0.25]),
        ("pendulum", vec![-2.0], vec![0.5]),
        ("pendulum", vec![3.0], vec![-4.0]),
        ("quartic", vec![0.2], vec![-0.7]),
    ] {
        let instance = find(name).unwrap().instance(&[]).unwrap();
        let exact = |v: Vec<f64>| v.into_iter().map(T::exact).collect::<Vec<_>>();
        let start = (exact(q), exact(p));
        let (s, t) = (T::ratio(17, 10), T::ratio(-53, 10));
        let at_once = instance.flow(&start, s + t).unwrap();
        let in_two = instance
            .flow(&instance.flow(&start, s).unwrap(), t)
            .unwrap();
        let error = relative(
            &[in_two.0, in_two.1].concat(),
            &[at_once.0, at_once.1].concat(),
        );
        // Measured 5e-31.
        assert!(error < 4e-30, "{name}: {error:e}");
    }
    let kepler = find("kepler").unwrap().instance(&[]).unwrap();
    assert!(
        kepler
            .flow(&(vec![1.0, 0.0], vec![0.0, 1.5]), 1.0)
            .is_none(),
        "hyperbolic"
    );
}

#[test]
fn scenes_without_a_closed_form_say_so() {
    for (name, values) in [
        ("henon-heiles", &[][..]),
        ("fput-beta", &[]),
        ("dnls", &[]),
        ("n-body", &[]),
        ("arenstorf", &[]),
    ] {
        let instance = find(name).unwrap().instance(values).unwrap();
        assert!(instance.exact(1.0).is_none(), "{name}");
    }
}
