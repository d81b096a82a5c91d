//! External energies beside recorded ones.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::allocations::peak;
use crate::common::{Energy, Kepler, Pendulum, Random, same_bits, widened};
use equip_autodiff::{BuildError, BytesError, Hamiltonian};
use equip_scalar::{DoubleDouble, Float, Scalar};

/// The formulas of [`Pendulum`], with a factor at each derivative.
fn pendulum(sign: [f64; 2]) -> Hamiltonian {
    Hamiltonian::external(
        1,
        f64::EPSILON,
        |q, p| Pendulum.direct(&[q[0], p[0]]),
        move |q, p, dq, dp| (dq[0], dp[0]) = (sign[0] * Scalar::sin(q[0]), sign[1] * p[0]),
    )
    .unwrap()
}

fn kepler(sign: [f64; 4]) -> Hamiltonian {
    Hamiltonian::external(
        2,
        f64::EPSILON,
        |q, p| Kepler.direct(&[q[0], q[1], p[0], p[1]]),
        move |q, p, dq, dp| {
            let r2 = q[0] * q[0] + q[1] * q[1];
            let force = 1.0 / (r2 * r2.sqrt());
            dq.copy_from_slice(&[sign[0] * (q[0] * force), sign[1] * (q[1] * force)]);
            dp.copy_from_slice(&[sign[2] * p[0], sign[3] * p[1]]);
        },
    )
    .unwrap()
}

/// The external one and the recorded one.
fn pairs() -> [(Hamiltonian, Hamiltonian); 2] {
    [
        (pendulum([1.0; 2]), Pendulum.hamiltonian()),
        (kepler([1.0; 4]), Kepler.hamiltonian()),
    ]
}

fn states(n: usize, size: f64) -> Vec<Vec<f64>> {
    let mut random = Random(0x5eed_0051);
    let state = |_| (0..n).map(|_| random.within(-size, size)).collect();
    (0..64).map(state).collect()
}

/// Entries of ∇²H, those too that the pattern leaves out.
fn dense(h: &Hamiltonian, y: &[f64]) -> Vec<f64> {
    let (n, pattern) = (y.len(), &h.structure().hessian);
    let (mut entries, mut dense) = (vec![0.0; pattern.len()], vec![0.0; n * n]);
    h.evaluator().hessian(y, &mut entries);
    for i in 0..n {
        pattern
            .row(i)
            .for_each(|(entry, j)| dense[i * n + j] = entries[entry]);
    }
    dense
}

/// To a part of the largest.
fn close(found: &[f64], expected: &[f64], part: f64) {
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= part * largest, "{found:?} {expected:?}");
    }
}

#[test]
fn values_and_gradients_are_those_that_are_given() {
    for (external, recorded) in pairs() {
        let n = 2 * recorded.degrees_of_freedom();
        let (mut own, mut of_trace) = (external.evaluator::<f64>(), recorded.evaluator::<f64>());
        for y in states(n, 2.0) {
            let mut found = vec![vec![0.0; n]; 4];
            let mut expected = vec![0.0; n];
            let value = of_trace.gradient(&y, &mut expected);
            let values = [
                own.value(&y),
                own.compensated_value(&y),
                own.gradient(&y, &mut found[0]),
                own.gradient_with_compensated_value(&y, &mut found[1]),
                own.gradient_with_bound(&y, &mut found[2]).0,
            ];
            assert!(values.iter().all(|&h| same_bits(h, value)), "{y:?}");
            own.gradients(&y, &mut found[3], n);
            // Kepler's recorded force is another formula.
            close(&found[0], &expected, if n == 2 { 0.0 } else { 1e-15 });
            assert!(found.iter().all(|gradient| *gradient == found[0]));
            let rows: Vec<f64> = y.iter().flat_map(|&x| [x, 1.0, x, 1.0]).collect();
            let mut gradients = rows.clone();
            own.gradients_by_component(&rows, &mut gradients, 4, 3);
            let third: Vec<f64> = gradients.chunks(4).map(|row| row[2]).collect();
            assert_eq!(third, found[0]);
        }
    }
}

#[test]
fn second_derivatives_by_differences() {
    for (external, recorded) in pairs() {
        let n = 2 * recorded.degrees_of_freedom();
        let mut own = external.evaluator::<f64>();
        for y in states(n, 2.0) {
            // Near a collision the force changes within a part of q.
            if n == 4 && y[0].hypot(y[1]) < 0.1 {
                continue;
            }
            let (found, expected) = (dense(&external, &y), dense(&recorded, &y));
            close(&found, &expected, 1e-6);
            let columns = |i: usize| (0..n).map(move |k| k * n + i);
            let transposed: Vec<f64> = (0..n).flat_map(columns).map(|k| found[k]).collect();
            assert_eq!(transposed, found);
            let v: Vec<f64> = (0..n).map(|i| 1.0 - 0.4 * i as f64).collect();
            let (mut product, mut of_trace) = (y.clone(), y.clone());
            own.hessian_vector(&y, &v, &mut product);
            recorded.evaluator().hessian_vector(&y, &v, &mut of_trace);
            close(&product, &of_trace, 1e-6);
            own.hessian_vector(&y, &vec![0.0; n], &mut product);
            assert_eq!(product, vec![0.0; n]);
            let rows: Vec<f64> = y.iter().flat_map(|&x| [1.0, x, 1.0]).collect();
            let mut hessians = vec![0.0; 3 * n * n];
            own.hessians_by_component(&rows, &mut hessians, 3, 2);
            let second: Vec<f64> = hessians.chunks(3).map(|row| row[1]).collect();
            assert_eq!(second, found);
        }
    }
}

/// Positions and momenta have units of their own, and so have vectors.
#[test]
fn second_derivatives_in_any_units() {
    let (external, recorded) = (kepler([1.0; 4]), Kepler.hamiltonian());
    for [q, p] in [[1e-4, 1e2], [1e6, 1e-3], [1.0, 0.0]] {
        let y = [q, 0.5 * q, -0.3 * p, p];
        let (found, expected) = (dense(&external, &y), dense(&recorded, &y));
        for i in 0..4 {
            close(&found[4 * i..][..4], &expected[4 * i..][..4], 1e-6);
        }
        let v = [q, -q, 0.7 * p, p];
        let (mut product, mut of_trace) = ([0.0; 4], [0.0; 4]);
        external.evaluator().hessian_vector(&y, &v, &mut product);
        recorded.evaluator().hessian_vector(&y, &v, &mut of_trace);
        for half in [0..2, 2..4] {
            close(&product[half.clone()], &of_trace[half], 1e-6);
        }
    }
    // At the origin, and where all rests.
    close(
        &dense(&pendulum([1.0; 2]), &[0.0; 2]),
        &[1.0, 0.0, 0.0, 1.0],
        1e-6,
    );
}

#[test]
fn rounding_is_below_the_bound() {
    let mut largest = 0.0_f64;
    for (external, recorded) in pairs() {
        let n = 2 * recorded.degrees_of_freedom();
        for size in [0.01, 1.0, 30.0] {
            for y in states(n, size) {
                let (h, bound) = external
                    .evaluator()
                    .gradient_with_bound(&y, &mut vec![0.0; n]);
                let exact = recorded.evaluator().value(&widened(&y));
                let rounding = (DoubleDouble::exact(h) - exact).to_f64().abs();
                largest = largest.max(rounding / (f64::EPSILON * bound));
            }
        }
    }
    println!("{largest}");
    assert!((0.05..1.0).contains(&largest), "{largest}");
    // Of values in single precision.
    let single = Hamiltonian::external(
        1,
        f64::from(f32::EPSILON),
        |q, _| f64::from(q[0] as f32),
        |_, _, dq, dp| (dq[0], dp[0]) = (1.0, 0.0),
    );
    let mut evaluator = single.unwrap().evaluator::<f64>();
    let (h, bound) = evaluator.gradient_with_bound(&[0.1, 0.0], &mut [0.0; 2]);
    assert!((h - 0.1).abs() > 1e-10 && (h - 0.1).abs() <= f64::EPSILON * bound);
}

#[test]
fn what_is_known_of_them() {
    let h = pendulum([1.0; 2]);
    let structure = h.structure();
    assert!(!structure.separable && !structure.is_quadratic() && !h.has_time());
    assert_eq!((structure.degree_in_p, structure.hessian.len()), (None, 4));
    assert_eq!(
        [
            h.operations(),
            h.gradient_operations(),
            h.hessian_operations()
        ],
        [0; 3]
    );
    assert!(h.switches().is_empty());
    assert_eq!(h.to_bytes().unwrap_err(), BytesError::External);
    let mut evaluator = h.evaluator::<f64>();
    assert_eq!(evaluator.formula_checksum(), None);
    assert!(evaluator.kinetic().is_none());
    let mut off = [1.0; 2];
    evaluator.gradient_rounding(&[1.0, 1.0], &mut off);
    assert_eq!(off, [f64::EPSILON * 1.0_f64.sin(), f64::EPSILON]);
    let alone = h.function::<f64>().value(5.0, &[0.0], &[2.0]);
    assert_eq!(alone, 1.0);
}

/// The n² entries of ∇²H take no memory before they are asked for.
#[test]
fn large_ones_are_made_at_once() {
    let m = 1000;
    let (h, bytes) = peak(|| Hamiltonian::external(m, 1e-10, |_, _| 0.0, |_, _, _, _| ()));
    assert!(bytes < 1 << 20, "{bytes}");
    assert_eq!(h.unwrap().structure().hessian.dimension(), 2 * m);
}

#[test]
fn what_is_refused() {
    let built = |m, accuracy| {
        let h = Hamiltonian::external(m, accuracy, |_, _| 0.0, |_, _, _, _| ());
        h.map(|_| ()).unwrap_err()
    };
    assert_eq!(built(0, f64::EPSILON), BuildError::NoDegreesOfFreedom);
    for accuracy in [0.0, f64::EPSILON / 2.0, 1.0, -1e-3, f64::INFINITY] {
        let error = built(1, accuracy);
        assert_eq!(error, BuildError::Accuracy { accuracy });
        let text = format!("the accuracy {accuracy:e} of an external energy");
        assert!(error.to_string().starts_with(&text), "{error}");
    }
    let not_a_number = built(1, f64::NAN);
    assert!(matches!(not_a_number, BuildError::Accuracy { accuracy } if accuracy.is_nan()));
}

/// What is wrong with the gradient at `y`: the component, and what the energy has there.
fn wrong(h: &Hamiltonian, y: &[f64]) -> Option<(usize, f64)> {
    match h.check_gradient(y) {
        Ok(()) => None,
        Err(BuildError::WrongGradient {
            component,
            expected,
            ..
        }) => Some((component, expected)),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn gradients_are_checked_by_differences() {
    for (external, recorded) in pairs() {
        let n = 2 * recorded.degrees_of_freedom();
        for size in [1e-3, 1.0, 30.0] {
            for y in states(n, size) {
                assert_eq!(wrong(&external, &y), None, "{y:?}");
            }
        }
    }
    // At rest, and where nothing moves.
    for y in [[0.0, 0.0], [1e-9, 1.0], [0.0, 1e-9], [3e5, 0.0]] {
        assert_eq!(wrong(&pendulum([1.0; 2]), &y), None, "{y:?}");
    }
    let y = [0.6, -0.5, 0.4, 0.7];
    let mut gradient = [0.0; 4];
    Kepler.hamiltonian().evaluator().gradient(&y, &mut gradient);
    for component in 0..4 {
        for factor in [-1.0, 0.0, 1.01] {
            let mut sign = [1.0; 4];
            sign[component] = factor;
            let (found, expected) = wrong(&kepler(sign), &y).unwrap();
            assert_eq!(found, component, "{factor}");
            assert!((expected / gradient[component] - 1.0).abs() < 1e-5);
        }
    }
    // A gradient given later is the one that is used, and checked.
    let other = pendulum([1.0; 2]).with_gradient(|_, p, dq, dp| (dq[0], dp[0]) = (7.0, p[0]));
    let mut gradient = [0.0; 2];
    other.evaluator().gradient(&[0.3, 0.1], &mut gradient);
    assert_eq!(gradient, [7.0, 0.1]);
    assert_eq!(wrong(&other, &[0.3, 0.1]).unwrap().0, 0);
}

/// What is no number is wrong, where the energy is one.
#[test]
fn gradients_that_are_no_numbers() {
    for slope in [f64::NAN, f64::INFINITY] {
        assert_eq!(wrong(&pendulum([1.0, slope]), &[0.3, 0.1]).unwrap().0, 1);
    }
}

/// Of either side's derivative at a kink none is wrong.
#[test]
fn gradients_at_a_kink() {
    for side in [-1.0, 1.0] {
        let wedge = Hamiltonian::external(
            1,
            f64::EPSILON,
            |q, p| 0.5 * p[0] * p[0] + q[0].abs(),
            move |q, p, dq, dp| {
                let slope = if q[0] == 0.0 { side } else { q[0].signum() };
                (dq[0], dp[0]) = (slope, p[0]);
            },
        );
        assert_eq!(wrong(&wedge.unwrap(), &[0.0, 1.0]), None, "{side}");
    }
}

/// Of values that are noise in the last half of their digits, a right gradient is none the worse.
#[test]
fn the_noise_of_single_precision() {
    let single = |sign: f64| {
        let value = |q: &[f64], p: &[f64]| f64::from(Pendulum.direct(&[q[0], p[0]]) as f32);
        let gradient = move |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
            (dq[0], dp[0]) = (sign * q[0].sin(), p[0]);
        };
        Hamiltonian::external(1, f64::from(f32::EPSILON), value, gradient).unwrap()
    };
    for y in states(2, 2.0) {
        assert_eq!(wrong(&single(1.0), &y), None, "{y:?}");
    }
    assert_eq!(wrong(&single(-1.0), &[0.7, 0.2]).unwrap().0, 0);
}

/// In double-double they answer with doubles, of states rounded to doubles.
#[test]
fn in_other_floats() {
    let h = kepler([1.0; 4]);
    let (mut doubles, mut wide) = (h.evaluator::<f64>(), h.evaluator::<DoubleDouble>());
    for y in states(4, 2.0) {
        let state: Vec<_> = widened(&y)
            .into_iter()
            .map(|x| x + x * DoubleDouble::exact(1e-20))
            .collect();
        let (mut gradient, mut rounded) = (vec![0.0; 4], state.clone());
        let (value, bound) = doubles.gradient_with_bound(&y, &mut gradient);
        let (of_wide, bound_of_wide) = wide.gradient_with_bound(&state, &mut rounded);
        assert_eq!(of_wide, DoubleDouble::exact(value));
        assert_eq!(
            [wide.value(&state), wide.compensated_value(&state)],
            [of_wide; 2]
        );
        assert_eq!(rounded, widened(&gradient));
        // The bound, with ε of either float, is that of doubles.
        let parts = (DoubleDouble::EPSILON * bound_of_wide).to_f64() / (f64::EPSILON * bound);
        assert!((parts - 1.0).abs() < 1e-12, "{parts}");
        assert_eq!(wide.check_gradient(&state), Ok(()));
    }
    let y = widened(&[0.6, -0.5, 0.4, 0.7]);
    let found = kepler([1.0, -1.0, 1.0, 1.0]).evaluator().check_gradient(&y);
    assert_eq!(found.unwrap_err().component, 1);
    let mut product = y.clone();
    wide.hessian_vector(&y, &widened(&[1.0, 0.5, -1.0, 0.0]), &mut product);
    let mut expected = [0.0; 4];
    let of_trace = Kepler.hamiltonian();
    let y: Vec<f64> = y.iter().map(|x| x.to_f64()).collect();
    (of_trace.evaluator()).hessian_vector(&y, &[1.0, 0.5, -1.0, 0.0], &mut expected);
    let product: Vec<f64> = product.iter().map(|x| x.to_f64()).collect();
    close(&product, &expected, 1e-6);
}

/// Shorter states are refused, and not taken for others.
#[test]
fn states_of_another_length() {
    let refused = |call: fn(&Hamiltonian)| {
        let result = std::panic::catch_unwind(|| call(&kepler([1.0; 4])));
        let text = result.unwrap_err();
        let text = text.downcast_ref::<String>().unwrap();
        assert!(text.contains("of this system has 4 components"), "{text}");
    };
    refused(|h| _ = h.evaluator().value(&[1.0; 2]));
    refused(|h| _ = h.evaluator().value(&[1.0; 6]));
    refused(|h| _ = h.evaluator().compensated_value(&[1.0; 2]));
    refused(|h| _ = h.evaluator().gradient(&[1.0; 2], &mut [0.0; 2]));
    refused(|h| _ = h.evaluator().gradient_with_bound(&[1.0; 4], &mut [0.0; 2]));
    refused(|h| h.evaluator().gradient_rounding(&[1.0; 4], &mut [0.0; 2]));
    refused(|h| {
        h.evaluator()
            .hessian_vector(&[1.0; 4], &[1.0; 2], &mut [0.0; 4])
    });
    refused(|h| {
        h.evaluator()
            .hessian_vector(&[1.0; 4], &[1.0; 4], &mut [0.0; 2])
    });
    refused(|h| h.evaluator().hessian(&[1.0; 4], &mut [0.0; 6]));
    refused(|h| {
        let (states, mut gradients) = ([1.0; 4], [0.0; 4]);
        h.evaluator()
            .gradients_by_component(&states, &mut gradients, 2, 2);
    });
}

#[test]
#[should_panic = "only if H = T(p) + U(q)"]
fn they_are_not_separable() {
    let mut evaluator = pendulum([1.0; 2]).evaluator::<f64>();
    evaluator.forces_by_component(&[1.0], &mut [0.0], 1, 1);
}
