//! The running error bound of H: above what rounding makes of H, also where large parts cancel, and not far
//! above it where none do.
#![allow(clippy::unwrap_used)]

use crate::common::{
    Chain, ChargedParticle, DoublePendulum, Energy, HenonHeiles, Kepler, Pendulum, Program,
    Pythagorean, Random, same_bits, widened,
};
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float};

const POINTS: usize = 400;

/// Rounding of H in `f64`, as a part of ε times the bound.
fn part(energy: &Hamiltonian, y: &[f64]) -> f64 {
    let exact = energy.evaluator::<DoubleDouble>().value(&widened(y));
    let mut gradient = vec![0.0; y.len()];
    let (h, bound) = (energy.evaluator::<f64>()).gradient_with_bound(y, &mut gradient);
    let rounding = (DoubleDouble::exact(h) - exact).to_f64().abs();
    if rounding == 0.0 {
        return 0.0;
    }
    rounding / (f64::EPSILON * bound)
}

/// The largest part at random states of this size.
fn largest_part(energy: &Hamiltonian, size: f64) -> f64 {
    let mut random = Random(0x5eed_0011);
    let n = 2 * energy.degrees_of_freedom();
    let parts = (0..POINTS).map(|_| {
        let y: Vec<f64> = (0..n).map(|_| random.within(-size, size)).collect();
        part(energy, &y)
    });
    parts.fold(0.0, f64::max)
}

/// Rounding of ∇H, and of the state to its last place, as parts of their bound: the largest of all components
/// at random states of this size.
fn largest_part_of_gradient(energy: &Hamiltonian, size: f64) -> f64 {
    let mut random = Random(0x5eed_0012);
    let n = 2 * energy.degrees_of_freedom();
    let (mut doubles, mut wide) = (
        energy.evaluator::<f64>(),
        energy.evaluator::<DoubleDouble>(),
    );
    let (mut gradient, mut off) = (vec![0.0; n], vec![0.0; n]);
    let mut exact = vec![DoubleDouble::exact(0.0); n];
    let mut most = 0.0_f64;
    for _ in 0..POINTS {
        // A state between doubles, to half a place.
        let state: Vec<DoubleDouble> = (0..n)
            .map(|_| {
                let x = random.within(-size, size);
                DoubleDouble::exact(x) + DoubleDouble::exact(x * random.within(-5e-17, 5e-17))
            })
            .collect();
        let y: Vec<f64> = state.iter().map(|x| x.to_f64()).collect();
        doubles.gradient(&y, &mut gradient);
        doubles.gradient_rounding(&y, &mut off);
        wide.gradient(&state, &mut exact);
        for ((&found, &exact), &off) in gradient.iter().zip(&exact).zip(&off) {
            let rounding = (DoubleDouble::exact(found) - exact).to_f64().abs();
            if rounding > 0.0 {
                most = most.max(rounding / off);
            }
        }
    }
    most
}

/// Near its length the force of a stiff spring has few digits, and so have forces along a smooth chain of
/// exponentials; the bound says how many.
#[test]
fn rounding_of_slopes_is_below_their_bound_and_near_it() {
    let spring = |q: &[Var], p: &[Var]| {
        let stretch = (q[0].powi(2) + q[1].powi(2)).sqrt() - 1.0;
        0.5 * (p[0].powi(2) + p[1].powi(2)) + 5e5 * stretch.powi(2)
    };
    let toda = |q: &[Var], p: &[Var]| {
        let springs = q.windows(2).map(|q| (q[1] - q[0]).exp() - (q[1] - q[0]));
        springs.sum::<Var>() + p.iter().map(|p| p.powi(2)).sum::<Var>() / 2.0
    };
    let found = [
        (
            "Kepler",
            largest_part_of_gradient(&Kepler.hamiltonian(), 1.0),
        ),
        (
            "double pendulum",
            largest_part_of_gradient(&DoublePendulum.hamiltonian(), 3.0),
        ),
        (
            "charged particle",
            largest_part_of_gradient(&ChargedParticle.hamiltonian(), 3.0),
        ),
        (
            "spring",
            largest_part_of_gradient(&by_closure(2, spring), 1.0),
        ),
        ("Toda", largest_part_of_gradient(&by_closure(8, toda), 1e-3)),
    ];
    for (name, part) in found {
        assert!((0.05..1.0).contains(&part), "{name}: {part}");
    }
    let mut off = [0.0; 4];
    let mut evaluator = by_closure(2, spring).evaluator::<f64>();
    evaluator.gradient_rounding(&[1.0, 0.0, 0.0, 0.0], &mut off);
    // The radius is rounded to ε or two.
    let expected = 1e6 * f64::EPSILON;
    assert!((expected..4.0 * expected).contains(&off[0]), "{off:?}");
}

fn by_closure(m: usize, energy: impl FnOnce(&[Var], &[Var]) -> Var) -> Hamiltonian {
    Hamiltonian::new(m, energy).unwrap()
}

#[test]
fn rounding_is_below_the_bound_and_near_it() {
    let relativistic = |c: f64| {
        move |q: &[Var], p: &[Var]| {
            let p2 = p[0].powi(2) + p[1].powi(2);
            c * (c * c + p2).sqrt() - c * c - 1.0 / q[0].hypot(q[1])
        }
    };
    let offset = |q: &[Var], p: &[Var]| {
        let h = 0.5 * (p[0].powi(2) + p[1].powi(2)) - 1.0 / (q[0].powi(2) + q[1].powi(2)).sqrt();
        (100.0 + h) - 100.0
    };
    let swing = |q: &[Var], p: &[Var]| 0.5 * p[0].powi(2) + (1.0 - q[0].cos());
    let found = [
        ("Kepler", largest_part(&Kepler.hamiltonian(), 1.0)),
        (
            "Hénon–Heiles",
            largest_part(&HenonHeiles.hamiltonian(), 1.0),
        ),
        ("pendulum", largest_part(&Pendulum.hamiltonian(), 3.0)),
        (
            "double pendulum",
            largest_part(&DoublePendulum.hamiltonian(), 3.0),
        ),
        (
            "charged particle",
            largest_part(&ChargedParticle.hamiltonian(), 1.0),
        ),
        (
            "three bodies",
            largest_part(&Pythagorean.hamiltonian(), 3.0),
        ),
        ("chain of 16", largest_part(&Chain(16).hamiltonian(), 1.0)),
        ("chain of 100", largest_part(&Chain(100).hamiltonian(), 1.0)),
        (
            "chain of 2000",
            largest_part(&Chain(2000).hamiltonian(), 1.0),
        ),
        ("1 − cos q", largest_part(&by_closure(1, swing), 0.01)),
        ("1 − cos q, large", largest_part(&by_closure(1, swing), 3.0)),
        ("(100 + H) − 100", largest_part(&by_closure(2, offset), 1.0)),
        (
            "c = 10",
            largest_part(&by_closure(2, relativistic(10.0)), 1.0),
        ),
        (
            "c = 137",
            largest_part(&by_closure(2, relativistic(137.0)), 1.0),
        ),
        (
            "power 12",
            largest_part(&by_closure(1, |q, p| (q[0] + p[0]).powi(12)), 2.0),
        ),
        (
            "power −7",
            largest_part(&by_closure(1, |q, p| (q[0] + p[0]).powi(-7)), 2.0),
        ),
        (
            "power 1/3",
            largest_part(&by_closure(1, |q, p| (q[0] * q[0]).powf(0.3) + p[0]), 2.0),
        ),
    ];
    for (name, part) in found {
        assert!((0.05..0.7).contains(&part), "{name}: {part}");
    }
}

/// Random straight-line programs of all operations.
#[test]
fn rounding_of_random_energies_is_below_the_bound() {
    let mut random = Random(0x5eed_0012);
    let (mut compared, mut largest) = (0, 0.0_f64);
    for _ in 0..400 {
        let mut program = Program::new(&mut random);
        program.without_rounded_constants();
        let Ok(h) = Hamiltonian::new(3, |q, p| program.energy(q, p)) else {
            continue;
        };
        for _ in 0..8 {
            let y: Vec<f64> = (0..6).map(|_| random.within(-2.0, 2.0)).collect();
            let part = part(&h, &y);
            // The bound is of first order in ε: not where rounding the operations changes their derivatives
            // too.
            let of = |y: &[f64]| h.evaluator().gradient_with_bound(y, &mut [0.0; 6]).1;
            let wide = widened(&y);
            let exact = h
                .evaluator()
                .gradient_with_bound(&wide, &mut wide.clone())
                .1;
            let is_of_first_order = (of(&y) / exact.to_f64() - 1.0).abs() < 1e-6;
            if part.is_finite() && is_of_first_order {
                compared += 1;
                largest = largest.max(part);
            }
        }
    }
    assert!(compared > 1000, "only {compared} compared");
    assert!((0.1..0.7).contains(&largest), "{largest}");
}

/// By the closed forms of the same energies that do not cancel.
#[test]
fn rounding_of_double_doubles_is_below_the_bound() {
    let two = DoubleDouble::int(2);
    let swing = by_closure(1, |q, _| 1.0 - q[0].cos());
    let root = by_closure(1, |q, _| 10.0 * (100.0 + q[0] * q[0]).sqrt() - 100.0);
    let mut random = Random(0x5eed_0013);
    let mut largest = [0.0_f64; 2];
    for _ in 0..POINTS {
        let q = DoubleDouble::exact(random.within(0.0, 0.1)) + DoubleDouble::exact(1e-18);
        let sine = (q / two).sin();
        let hundred = DoubleDouble::int(100);
        let below = (hundred + q * q).sqrt() + DoubleDouble::int(10);
        let exact = [two * sine * sine, DoubleDouble::int(10) * q * q / below];
        for (k, (energy, exact)) in [&swing, &root].into_iter().zip(exact).enumerate() {
            let y = [q, DoubleDouble::int(0)];
            let (h, bound) = energy.evaluator().gradient_with_bound(&y, &mut y.clone());
            let part = (h - exact).abs() / (DoubleDouble::EPSILON * bound);
            largest[k] = largest[k].max(part.to_f64());
            let single = [q.to_f64(), 0.0];
            let (_, near) = energy
                .evaluator()
                .gradient_with_bound(&single, &mut single.clone());
            assert!((bound.to_f64() / near - 1.0).abs() < 1e-12);
        }
    }
    assert!(
        largest.iter().all(|part| (0.01..0.7).contains(part)),
        "{largest:?}"
    );
}

/// ½p² + (1 − cos q): p², cos q, 1 − cos q and H, then p and q. The product with ½ is exact.
#[test]
fn every_operation_counts() {
    let h = by_closure(1, |q, p| 0.5 * p[0].powi(2) + (1.0 - q[0].cos()));
    let (q, p) = (0.7_f64, -1.3_f64);
    let mut gradient = [0.0; 2];
    let (value, bound) = h.evaluator().gradient_with_bound(&[q, p], &mut gradient);
    let parts = [
        0.5 * p * p,
        q.cos(),
        1.0 - q.cos(),
        value,
        p * p,
        q * q.sin(),
    ];
    let expected = parts.into_iter().sum::<f64>();
    assert!((bound / expected - 1.0).abs() < 1e-14, "{bound} {expected}");
    assert_eq!(gradient, [q.sin(), p]);
}

/// Of Σq², each term counts, H once, and each component twice; each partial sum only where the sum is not
/// compensated.
#[test]
fn partial_sums_of_compensated_sums_do_not_count() {
    let bound = |m: usize| {
        let h = by_closure(m, |q, _| q.iter().map(|q| q.powi(2)).sum());
        let y = [vec![1.0; m], vec![0.0; m]].concat();
        let (h, bound) = h.evaluator().gradient_with_bound(&y, &mut y.clone());
        assert_eq!(h, m as f64);
        bound
    };
    let terms = |m: usize| 3.0 * m as f64;
    assert_eq!(bound(4000), terms(4000) + 4000.0);
    assert_eq!(bound(64), terms(64) + 64.0);
    let partial: f64 = (2..=63).map(f64::from).sum();
    assert_eq!(bound(63), terms(63) + partial);
    assert_eq!(bound(1), terms(1));
}

/// The value and the gradient beside the bound have every bit of those without it.
fn bound_beside_value<T: Float>(energy: &impl Energy) {
    let h = energy.hamiltonian();
    let n = 2 * energy.degrees_of_freedom();
    let mut random = Random(0x5eed_0014);
    let mut evaluator = h.evaluator::<T>();
    for _ in 0..16 {
        let y: Vec<T> = (0..n).map(|_| T::exact(random.within(-1.0, 1.0))).collect();
        let (mut gradient, mut expected) = (y.clone(), y.clone());
        let (value, bound) = evaluator.gradient_with_bound(&y, &mut gradient);
        let alone = evaluator.gradient_with_compensated_value(&y, &mut expected);
        assert!(same_bits(value, alone) && bound > value.abs());
        assert!(
            gradient
                .iter()
                .zip(&expected)
                .all(|(&a, &b)| same_bits(a, b))
        );
        // Compensated sums are not those that are written.
        let direct = energy.direct(&y);
        assert!(n > 20 || same_bits(value, direct), "{value} {direct}");
    }
}

#[test]
fn the_bound_comes_with_the_value() {
    fn in_both_floats(energy: &impl Energy) {
        bound_beside_value::<f64>(energy);
        bound_beside_value::<DoubleDouble>(energy);
    }
    for m in [3, 5, 300] {
        in_both_floats(&Chain(m));
    }
    in_both_floats(&Kepler);
    in_both_floats(&DoublePendulum);
    let constant = by_closure(1, |_, _| 3.0.into());
    let (h, bound) = (constant.evaluator::<f64>()).gradient_with_bound(&[1.0, 2.0], &mut [0.0; 2]);
    assert_eq!((h, bound), (3.0, 0.0));
}

/// The gradient is that by hand, the value and the bound are those of the recording.
#[test]
fn the_bound_beside_a_gradient_by_hand() {
    let swing = by_closure(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0].cos()));
    let by_hand = (swing.clone()).with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (q[0], -p[0]));
    let y = [0.7, -1.3];
    let (mut gradient, mut expected) = ([0.0; 2], [0.0; 2]);
    let found = by_hand.evaluator().gradient_with_bound(&y, &mut gradient);
    assert_eq!(
        found,
        swing.evaluator().gradient_with_bound(&y, &mut expected)
    );
    assert_eq!((gradient, expected), ([0.7, 1.3], [0.7_f64.sin(), -1.3]));
}
