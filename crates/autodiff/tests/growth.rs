//! Work grows with the system as it must, and not faster. Counts, not clocks, but for a generous limit on
//! the building of the largest systems.
#![allow(clippy::unwrap_used)]

use crate::common::{Chain, Energy};
use equip_autodiff::{Hamiltonian, Var};
use std::time::{Duration, Instant};

#[test]
fn a_chain_is_linear_in_its_length() {
    let counts = |m| {
        let h = Chain(m).hamiltonian();
        let gradient = h.gradient_operations();
        (
            h.operations(),
            h.structure().hessian.len(),
            h.hessian_operations(),
            gradient,
        )
    };
    let (one, two, four) = (counts(1000), counts(2000), counts(4000));
    assert_eq!(four.0 - two.0, 2 * (two.0 - one.0));
    assert_eq!(four.1 - two.1, 2 * (two.1 - one.1));
    assert_eq!(four.3 - two.3, 2 * (two.3 - one.3));
    assert_eq!(four.2 - two.2, 2 * (two.2 - one.2));
    // The second derivative by a spring's length is 1 + d², an entry of its own and a term of two others.
    assert_eq!(two.2 - one.2, 6 * 1000);
    // p², q₊ − q, its square, half of it, its fourth power, a twelfth of it, their sum, and the two sums.
    assert_eq!(two.0 - one.0, 9 * 1000);
    // What a mass adds to one gradient: the forces of the springs are shared by the masses at their ends.
    assert!(two.3 - one.3 <= 5 * 1000, "{}", two.3 - one.3);
}

/// The derivatives of n bodies in terms of their n(n − 1)/2 pairs.
#[test]
fn bodies_are_linear_in_their_pairs() {
    let counts = |n: usize| {
        let h = Hamiltonian::new(3 * n, |q, p| {
            let mut h = p.iter().map(|p| p.powi(2)).sum::<Var>() / 2.0;
            for i in 0..n {
                for j in 0..i {
                    let r2: Var = (0..3).map(|k| (q[3 * i + k] - q[3 * j + k]).powi(2)).sum();
                    h -= 1.0 / r2.sqrt();
                }
            }
            h
        });
        let h = h.unwrap();
        (h.gradient_operations(), h.hessian_operations())
    };
    for n in [10, 20, 40] {
        // 21 a pair; 3 components of the forces on each body are sums of n − 1 terms, not n.
        let pairs = n * (n - 1) / 2;
        let (gradient, hessian) = counts(n);
        assert!(gradient <= 21 * pairs, "n = {n}: {gradient}");
        // 9 entries a pair, each of them in three blocks.
        assert!(hessian <= 66 * pairs, "n = {n}: {hessian}");
    }
}

/// Powers of two cost nothing: d, d², 0.3 d², 1 + 0.3 d², d (1 + 0.3 d²), and the difference of two such.
#[test]
fn constants_take_powers_of_two_up() {
    let counts = |m: usize| {
        let h = Hamiltonian::new(m, |q, p| {
            let springs = q.windows(2).map(|q| {
                let d2 = (q[1] - q[0]).powi(2);
                0.5 * d2 + 0.075 * (d2 * d2)
            });
            0.5 * p.iter().map(|p| p.powi(2)).sum::<Var>() + springs.sum::<Var>()
        });
        h.unwrap().gradient_operations()
    };
    assert_eq!(counts(200) - counts(100), 6 * 100);
}

/// A force that takes a 2 up and one that does not cost the same in either order.
#[test]
fn the_order_of_terms_does_not_matter() {
    let counts = |last: bool| {
        let h = Hamiltonian::new(20, |q, p| {
            let mut h = 0.5 * p.iter().map(|p| p.powi(2)).sum::<Var>();
            let trap = q.iter().map(|q| q.cos()).sum::<Var>();
            if !last {
                h += trap;
            }
            for i in 0..20 {
                for j in 0..i {
                    h += (-(q[i] - q[j]).powi(2)).exp().ln_1p();
                }
            }
            if last { h + trap } else { h }
        });
        h.unwrap().gradient_operations()
    };
    assert_eq!(counts(true), counts(false));
}

/// No more powers of two wait than are far from overflow: x ← x² + ¼ at ½ has the slope 1, however often.
#[test]
fn powers_of_two_do_not_overflow() {
    for depth in [10, 500, 1200] {
        let h = Hamiltonian::new(1, |q, p| {
            let orbit = (0..depth).fold(q[0], |x, _| x * x + 0.25);
            orbit + 0.5 * p[0] * p[0]
        });
        let mut gradient = [0.0; 2];
        h.unwrap().evaluator().gradient(&[0.5, 0.0], &mut gradient);
        assert_eq!(gradient[0], 1.0, "{depth}");
    }
}

#[test]
fn ten_thousand_masses() {
    let start = Instant::now();
    let h = Chain(10_000).hamiltonian();
    // Measured: 0.06 s on an idle core.
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
    assert_eq!(
        (h.hessian_operations(), h.structure().degree),
        (60_001, Some(4))
    );
    assert!(h.structure().separable);
    assert_eq!(h.structure().hessian.len(), 10_000 + 2 * 9_999 + 10_000);

    let y: Vec<f64> = (0..20_000).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let (q, p) = y.split_at(10_000);
    let mut gradient = vec![0.0; 20_000];
    let mut evaluator = h.evaluator::<f64>();
    evaluator.gradient(&y, &mut gradient);
    let force = |x: f64| x + x.powi(3) / 3.0;
    let left = |i: usize| if i == 0 { q[0] } else { q[i] - q[i - 1] };
    let right = |i: usize| if i == 9_999 { -q[i] } else { q[i + 1] - q[i] };
    for i in 0..10_000 {
        let expected = force(left(i)) - force(right(i));
        assert!(
            (gradient[i] - expected).abs() < 1e-14,
            "{i}: {} {expected}",
            gradient[i]
        );
        assert_eq!(gradient[10_000 + i], p[i]);
    }
    let pattern = &h.structure().hessian;
    let mut entries = vec![0.0; pattern.len()];
    evaluator.hessian(&y, &mut entries);
    let stiffness = |x: f64| 1.0 + x * x;
    for (entry, j) in pattern.row(5_000) {
        let expected = match j {
            4_999 => -stiffness(left(5_000)),
            5_000 => stiffness(left(5_000)) + stiffness(right(5_000)),
            _ => -stiffness(right(5_000)),
        };
        assert!((entries[entry] - expected).abs() < 1e-14);
    }
}

#[test]
fn every_particle_with_every_other() {
    // The square of a sum: every entry is non-zero.
    let start = Instant::now();
    let m = 300;
    let h = Hamiltonian::new(m, |q, p| {
        let centre: Var = q.iter().copied().sum();
        p.iter().map(|p| p.powi(2)).sum::<Var>() / 2.0 + centre * centre * centre
    })
    .unwrap();
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
    assert_eq!(h.structure().hessian.len(), m * m + m);
    // The sum, and six of it.
    assert_eq!(h.hessian_operations(), m);
    assert_eq!(h.structure().degree, Some(3));
    let y: Vec<f64> = (0..2 * m).map(|i| i as f64 / 1000.0).collect();
    let mut entries = vec![0.0; h.structure().hessian.len()];
    h.evaluator::<f64>().hessian(&y, &mut entries);
    let expected = 6.0 * y[..m].iter().sum::<f64>();
    assert!(
        entries[..m * m]
            .iter()
            .all(|x| (x / expected - 1.0).abs() < 1e-14)
    );
    assert!(entries[m * m..].iter().all(|&x| x == 1.0));
}

/// `rounds` rounds in which every one of 2m variables is replaced by a function of all.
fn composition(m: usize, rounds: usize) -> Hamiltonian {
    let h = Hamiltonian::new(m, |q, p| {
        let mut x: Vec<Var> = q.iter().chain(p).copied().collect();
        for _ in 0..rounds {
            let mean = x.iter().copied().sum::<Var>() / x.len() as f64;
            x.iter_mut().for_each(|x| *x = (*x * mean).sin());
        }
        x.into_iter().sum()
    });
    h.unwrap()
}

/// 12 000 curved operations on all of 200 variables: ∇²H, which would be a recording of 3 million operations,
/// is made column by column. In 10 rounds over 40 it is recorded.
#[test]
fn a_deep_dense_composition() {
    let start = Instant::now();
    for (m, rounds) in [(100, 20), (20, 10)] {
        let n = 2 * m;
        let h = composition(m, rounds);
        assert_eq!(h.structure().hessian.len(), n * n);
        let mut evaluator = h.evaluator::<f64>();
        let (stride, count) = (4, 3);
        let states: Vec<f64> = (0..n * stride).map(|k| 2.0 + (k as f64).sin()).collect();
        let mut hessians = vec![0.0; n * n * stride];
        evaluator.hessians_by_component(&states, &mut hessians, stride, count);
        for point in 0..count {
            let y: Vec<f64> = (0..n).map(|c| states[c * stride + point]).collect();
            let mut entries = vec![0.0; n * n];
            evaluator.hessian(&y, &mut entries);
            let of_all = hessians.iter().skip(point).step_by(stride);
            assert!(entries.iter().eq(of_all), "n = {n}");
            let row = 7 * point;
            let difference = |sign: f64| {
                let (mut moved, mut gradient) = (y.clone(), vec![0.0; n]);
                moved[row] += sign * 1e-5;
                evaluator.gradient(&moved, &mut gradient);
                gradient
            };
            let [more, less] = [1.0, -1.0].map(difference);
            for (entry, (more, less)) in entries[row * n..].iter().zip(more.iter().zip(&less)) {
                assert!((entry - (more - less) / 2e-5).abs() < 1e-7, "n = {n}");
            }
        }
    }
    assert!(
        start.elapsed() < Duration::from_secs(60),
        "{:?}",
        start.elapsed()
    );
}

#[test]
fn repeated_work_is_done_once() {
    let operations = |h: Result<Hamiltonian, _>| h.map(|h: Hamiltonian| h.operations()).unwrap();
    let twice = Hamiltonian::new(2, |q, _| {
        let r = || (q[0] * q[0] + q[1] * q[1]).sqrt();
        let swapped = (q[1] * q[1] + q[0] * q[0]).sqrt();
        r() * swapped
    });
    assert_eq!(operations(twice), 5);
    let exact = Hamiltonian::new(1, |q, _| {
        let unused = q[0].exp();
        let _ = unused;
        (1.0 * q[0] - 0.0).powi(1) / 1.0 + -(-q[0].powi(2)) * 1.0
    });
    assert_eq!(operations(exact), 2);
    let folded = Hamiltonian::new(1, |q, _| (Var::from(2.0).sqrt() * 3.0).sin() * q[0]);
    assert_eq!(operations(folded), 1);
}
