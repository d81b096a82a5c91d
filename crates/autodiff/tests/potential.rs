//! External potentials with masses, compared with recorded energies.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::common::{Random, widened};
use equip_autodiff::{BuildError, Hamiltonian};
use equip_scalar::{DoubleDouble, Float};

const MASSES: [f64; 3] = [1.0, 2.5, 0.3];

/// Three masses on a line with springs that stiffen, by other code.
fn external() -> Hamiltonian {
    Hamiltonian::external_potential(
        &MASSES,
        4.0 * f64::EPSILON,
        |q| {
            let bonds = q.windows(2).map(|q| (q[1] - q[0]).powi(4) / 4.0);
            bonds.sum::<f64>() - q.iter().map(|q| q.cos()).sum::<f64>()
        },
        |q, dq| {
            for (c, dq) in dq.iter_mut().enumerate() {
                let bond = |i: usize| (q[i + 1] - q[i]).powi(3);
                let behind = if c > 0 { bond(c - 1) } else { 0.0 };
                *dq = behind - if c + 1 < q.len() { bond(c) } else { 0.0 } + q[c].sin();
            }
        },
    )
    .unwrap()
}

fn recorded() -> Hamiltonian {
    Hamiltonian::new(3, |q, p| {
        let mut h = 0.0 * q[0];
        for c in 0..3 {
            h += 0.5 / MASSES[c] * p[c] * p[c] - q[c].cos();
        }
        for c in 0..2 {
            h += 0.25 * (q[c + 1] - q[c]).powi(4);
        }
        h
    })
    .unwrap()
}

fn states() -> Vec<Vec<f64>> {
    let mut random = Random(0x5eed_0071);
    let state = |_| (0..6).map(|_| random.within(-2.0, 2.0)).collect();
    (0..64).map(state).collect()
}

fn close(found: &[f64], expected: &[f64], part: f64) {
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= part * largest, "{found:?} {expected:?}");
    }
}

#[test]
fn values_and_derivatives() {
    let (mut own, mut of_trace) = (external().evaluator::<f64>(), recorded().evaluator::<f64>());
    let (external, recorded) = (external(), recorded());
    let pattern = &external.structure().hessian;
    let full = &recorded.structure().hessian;
    for y in states() {
        let (mut found, mut expected) = ([0.0; 6], [0.0; 6]);
        let values = [
            own.gradient(&y, &mut found),
            of_trace.gradient(&y, &mut expected),
        ];
        assert!((values[0] - values[1]).abs() < 1e-14 * (1.0 + values[1].abs()));
        close(&found, &expected, 1e-14);
        let (mut forces, rows) = (
            [0.0; 6],
            y[..3].iter().flat_map(|&q| [1.0, q]).collect::<Vec<_>>(),
        );
        own.forces_by_component(&rows, &mut forces, 2, 2);
        assert_eq!([forces[1], forces[3], forces[5]], found[..3]);
        // Entries outside the recorded pattern are zero.
        let (mut entries, mut of_pattern) = (vec![7.0; pattern.len()], vec![0.0; full.len()]);
        own.hessian(&y, &mut entries);
        of_trace.hessian(&y, &mut of_pattern);
        let mut dense = [[0.0; 6]; 6];
        (0..6).for_each(|i| full.row(i).for_each(|(e, j)| dense[i][j] = of_pattern[e]));
        for (i, dense) in dense.iter().enumerate() {
            for (e, j) in pattern.row(i) {
                assert!((entries[e] - dense[j]).abs() < 1e-7, "{i} {j} {entries:?}");
            }
        }
        let (h, bound) = own.gradient_with_bound(&y, &mut found);
        let exact = recorded.evaluator().value(&widened(&y));
        let rounding = (DoubleDouble::exact(h) - exact).to_f64().abs();
        assert!(rounding <= f64::EPSILON * bound, "{rounding:e} {bound:e}");
        assert!(external.check_gradient(&y).is_ok());
    }
}

/// The bound on rounding is that of T and U, also where they cancel.
#[test]
fn cancellation_of_kinetic_and_potential_energy() {
    let fall = Hamiltonian::external_potential(
        &[2.0],
        f64::EPSILON,
        |q| -1e8 * q[0],
        |_, dq| dq[0] = -1e8,
    )
    .unwrap();
    let y = [1.0, 2e4];
    let (h, bound) = fall
        .evaluator::<f64>()
        .gradient_with_bound(&y, &mut [0.0; 2]);
    assert_eq!(h, 0.0);
    assert!(bound >= 2e8, "{bound:e}");
}

#[test]
fn what_is_known_of_it() {
    let h = external();
    let structure = h.structure();
    assert!(structure.separable && structure.degree_in_p == Some(2));
    assert_eq!((structure.degree, structure.hessian.len()), (None, 12));
    let mut evaluator = h.evaluator::<f64>();
    assert_eq!(evaluator.gradients_of_hessian(), 6);
    let kinetic = evaluator.kinetic().unwrap();
    assert_eq!(kinetic.diagonal(), Some(&MASSES.map(|mass| 1.0 / mass)[..]));
    assert_eq!(kinetic.offset(), [0.0; 3]);
    // U may be infinite at the origin.
    let kepler = Hamiltonian::external_potential(
        &[1.0],
        f64::EPSILON,
        |q| 1.0 / q[0].abs(),
        |q, dq| dq[0] = -q[0].signum() / (q[0] * q[0]),
    );
    assert!(kepler.unwrap().evaluator::<f64>().kinetic().is_some());
}

#[test]
fn what_is_refused() {
    let built = |masses: &[f64], accuracy| {
        let h = Hamiltonian::external_potential(masses, accuracy, |_| 0.0, |_, _| ());
        h.map(|_| ()).unwrap_err()
    };
    assert_eq!(built(&[], f64::EPSILON), BuildError::NoDegreesOfFreedom);
    assert_eq!(built(&[1.0], 0.0), BuildError::Accuracy { accuracy: 0.0 });
    for mass in [0.0, f64::INFINITY, f64::MIN_POSITIVE / 4.0, f64::MAX] {
        let error = built(&[1.0, mass], f64::EPSILON);
        assert_eq!(error, BuildError::Mass { component: 1, mass });
        assert!(error.to_string().starts_with("mass 1 is "), "{error}");
    }
    assert!(matches!(
        built(&[f64::NAN], 0.1),
        BuildError::Mass { component: 0, .. }
    ));
}
