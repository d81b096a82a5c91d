//! y' = B(y)∇H(y): systems whose bracket is not canonical.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{BuildError, BytesError, Hamiltonian, Var};
use equip_integrate::{Equip, Gauss, IntegrateError, Integrator, Invariant, Run, TangentMap};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::distance;

type Entries = Vec<(usize, usize, Var)>;

/// ẋ = x × of three components from `first` on.
fn cross(x: &[Var], (row, column): (usize, usize)) -> Entries {
    vec![
        (row, column + 1, -x[2]),
        (row, column + 2, x[1]),
        (row + 1, column + 2, -x[0]),
    ]
}

/// Euler's equations m' = m × ∇H, H quadratic.
fn rigid_body(inertia: [i64; 3]) -> Hamiltonian {
    let body = Hamiltonian::of_state(3, |m| {
        let terms = m.iter().zip(inertia);
        terms.map(|(m, i)| m.powi(2) / (2.0 * i as f64)).sum()
    });
    let entries = |m: &[Var]| cross(m, (0, 0));
    body.and_then(|body| body.with_bracket(entries)).unwrap()
}

/// The heavy top with a quartic term: states (m, γ), H = ½ Σ m²/I + γ_3 + γ_1⁴/4, on se(3)*.
fn heavy_top() -> Hamiltonian {
    let energy = Hamiltonian::of_state(6, |y| {
        let kinetic = 0.5 * (y[0].powi(2) + y[1].powi(2) / 1.5 + y[2].powi(2) / 2.0);
        kinetic + y[5] + 0.2 * y[3] + 0.25 * y[3].powi(4)
    });
    let bracket = |y: &[Var]| {
        let (m, g) = y.split_at(3);
        let mut entries = cross(m, (0, 0));
        // Rows of m, columns of γ: all of γ×.
        entries.extend(cross(g, (0, 3)));
        entries.extend([(1, 3, g[2]), (2, 3, -g[1]), (2, 4, g[0])]);
        entries
    };
    energy
        .and_then(|energy| energy.with_bracket(bracket))
        .unwrap()
}

const TOP: [f64; 6] = [0.4, -0.3, 1.2, 0.6, 0.0, 0.8];

/// A run from `y0` to `end`.
fn run<T: Float>(by: Integrator<T>, of: &Hamiltonian, y0: &[f64], end: f64) -> Run<T> {
    let y0: Vec<T> = y0.iter().map(|&y| T::exact(y)).collect();
    let (q0, p0) = of.halves(&y0);
    by.integrate(of, &q0, &p0, T::int(0)..=T::exact(end))
        .unwrap()
}

/// Where it ends, in doubles.
fn end<T: Float>(run: &Run<T>) -> Vec<f64> {
    let (_, q, p) = run.last();
    [q, p].concat().iter().map(|y| y.to_f64()).collect()
}

fn largest_energy_error<T: Float>(run: &Run<T>) -> f64 {
    let errors = run.energy_errors().iter();
    errors.fold(0.0, |most, e| most.max(e.to_f64().abs()))
}

fn invariant(name: &str, n: usize, of: impl FnOnce(&[Var]) -> Var) -> Invariant {
    Invariant::new(name, Hamiltonian::of_state(n, of).unwrap())
}

/// Complete elliptic integral K of modulus k, by the arithmetic-geometric mean.
fn elliptic_k(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::FRAC_PI_2 / a
}

/// The body returns after the period of Jacobi's solution (Landau & Lifshitz, Mechanics, § 37). |m|² and H
/// are quadratic: every method conserves them, and no α is used.
#[test]
fn a_rigid_body_returns_after_its_period() {
    let (body, y0) = (rigid_body([1, 2, 3]), [0.3, 0.2, 1.0]);
    let [x, y, z] = y0.map(|m: f64| m * m);
    let (twice_energy, square) = (x + y / 2.0 + z / 3.0, x + y + z);
    // About the third axis, since |m|² > 2 E I_2.
    assert!(square > 2.0 * twice_energy);
    let (above, below) = (3.0 * twice_energy - square, square - twice_energy);
    let k = (above / below).sqrt();
    let period = 4.0 * elliptic_k(k) / (below / 6.0).sqrt();
    let casimir = invariant("|m|²", 3, |m| m.iter().map(|m| m.powi(2)).sum());
    let by = Equip::stages(6).step(period / 40.0).invariant(casimir);
    let run = run(by, &body, &y0, period);
    let found = end(&run);
    assert!(distance(&found[..3], &y0) < 1e-13, "{found:?}");
    assert_eq!(found[3], 0.0);
    let certificate = run.certificate();
    assert_eq!(certificate.counts.alpha_updates, 0);
    assert!(certificate.invariants[0].max < 2e-15);
    assert!(largest_energy_error(&run) < 1e-15);
}

/// The order is 2s, the energy is at round-off and the Casimirs |γ|² and m·γ, which are quadratic, as well.
#[test]
fn a_heavy_top_is_integrated_with_order_2s() {
    let (top, until) = (heavy_top(), 10.0);
    let exact = end(&run(Equip::stages(12).step(0.05), &top, &TOP, until));
    let errors = [40.0, 80.0].map(|steps| {
        let by = Equip::stages(4).step(until / steps);
        let by = by.invariant(invariant("|γ|²", 6, |y| {
            y[3..].iter().map(|g| g.powi(2)).sum()
        }));
        let by = by.invariant(invariant("m·γ", 6, |y| {
            (0..3).map(|i| y[i] * y[3 + i]).sum()
        }));
        let run = run(by, &top, &TOP, until);
        let certificate = run.certificate();
        assert!(certificate.invariants.iter().all(|i| i.max < 3e-15));
        assert!(certificate.counts.alpha_updates > 0);
        assert!(largest_energy_error(&run) < 4e-15);
        distance(&end(&run), &exact)
    });
    let order = (errors[0] / errors[1]).log2();
    assert!((7.4..8.6).contains(&order), "{errors:?}");
    let gauss = run(Gauss::stages(4).step(until / 40.0), &top, &TOP, until);
    assert!(largest_energy_error(&gauss) > 1e-12);
    assert!(
        errors[0] < 2.0 * distance(&end(&gauss), &exact),
        "{errors:?}"
    );
}

/// A charge in a field B_z(x) = 1 + x/2, in (x, v) without a vector potential, and the canonical system
/// with A_y = x + x²/4: by fixed steps and by tolerance, and in double-double.
#[test]
fn a_charge_moves_as_with_a_vector_potential() {
    let potential = |x: Var, y: Var| 0.5 * (x * x + 0.7 * y * y) + 0.3 * x.powi(4);
    let canonical = Hamiltonian::new(2, |q, p| {
        let v = p[1] - q[0] - 0.25 * q[0] * q[0];
        0.5 * (p[0] * p[0] + v * v) + potential(q[0], q[1])
    })
    .unwrap();
    let direct = Hamiltonian::new(2, |x, v| {
        0.5 * (v[0] * v[0] + v[1] * v[1]) + potential(x[0], x[1])
    });
    let direct = direct.and_then(|direct| {
        direct.with_bracket(|y| {
            let one = 0.0 * y[0] + 1.0;
            vec![(0, 2, one), (1, 3, one), (2, 3, 1.0 + 0.5 * y[0])]
        })
    });
    let (direct, until) = (direct.unwrap(), 20.0);
    let (x, y, vx, vy): (f64, f64, f64, f64) = (0.4, -0.2, 0.5, 0.9);
    let with_field = [x, y, vx, vy + x + 0.25 * x * x];
    let expected = end(&run(
        Equip::stages(8).step(0.05),
        &canonical,
        &with_field,
        until,
    ));
    let ends = [
        end(&run(
            Equip::stages(8).step(0.05),
            &direct,
            &[x, y, vx, vy],
            until,
        )),
        end(&run(
            Equip::stages(8).tolerance(1e-13),
            &direct,
            &[x, y, vx, vy],
            until,
        )),
    ];
    for found in ends {
        let as_canonical = found[3] + found[0] + 0.25 * found[0] * found[0];
        let found = [found[0], found[1], found[2], as_canonical];
        assert!(
            distance(&found, &expected) < 3e-12,
            "{found:?} {expected:?}"
        );
    }
    let by = Equip::stages(8).step(DoubleDouble::exact(0.05));
    let wide = run(by, &direct, &[x, y, vx, vy], until);
    assert!(largest_energy_error(&wide) < 1e-30);
}

/// Three species of Lotka and Volterra (Cohen & Hairer, BIT 51, 2011): H alone, and with the logarithmic
/// Casimir as a second constraint.
#[test]
fn a_casimir_that_is_not_quadratic_is_one_more_constraint() {
    let energy = Hamiltonian::of_state(3, |y| {
        2.0 * y[0] + y[1] + 2.0 * y[2] - y[1].ln() - y[2].ln()
    });
    let system = energy.and_then(|energy| {
        energy.with_bracket(|y| {
            vec![
                (0, 1, -0.5 * y[0] * y[1]),
                (0, 2, 0.5 * y[0] * y[2]),
                (1, 2, -y[1] * y[2]),
            ]
        })
    });
    let (system, y0) = (system.unwrap(), [1.0, 1.9, 0.5]);
    // y1' = y1 (−y2/2 + y3), y2' = y2 (y1 − 2 y3 + 1), y3' = y3 (−y1 + y2 − 1).
    let mut w = [0.0; 4];
    system
        .evaluator::<f64>()
        .flow_gradient(&[1.0, 1.9, 0.5, 0.0], &mut w);
    for (found, wanted) in [w[2], w[3], -w[0], -w[1]]
        .iter()
        .zip([-0.45, 1.9, -0.05, 0.0])
    {
        assert!((found - wanted).abs() < 1e-15, "{w:?}");
    }
    let casimir = || invariant("Casimir", 3, |y| 2.0 * y[0].ln() + y[1].ln() + y[2].ln());
    let errors = [false, true].map(|is_kept| {
        let by = Equip::stages(4).step(0.2);
        let by = if is_kept {
            by.preserve(casimir())
        } else {
            by.invariant(casimir())
        };
        let run = run(by, &system, &y0, 20.0);
        assert!(largest_energy_error(&run) < 1e-14);
        run.certificate().invariants[0].max
    });
    assert!(errors[0] > 1e-11 && errors[1] < 1e-14, "{errors:?}");
    let wide = run(
        Equip::stages(4).step(DoubleDouble::exact(0.1)),
        &system,
        &y0,
        2.0,
    );
    assert!(largest_energy_error(&wide) < 1e-29);
}

/// w' is compared with differences of w, products with its entries, and many states with one.
#[test]
fn the_jacobian_is_that_of_w() {
    let (top, zero) = (heavy_top(), DoubleDouble::exact(0.0));
    let y = TOP.map(DoubleDouble::exact);
    let pattern = top.structure().hessian.to_pattern();
    let mut evaluator = top.evaluator::<DoubleDouble>();
    let mut entries = vec![zero; pattern.len()];
    evaluator.hessian(&y, &mut entries);
    let mut by_entries = [[zero; 6]; 6];
    for (row, columns) in by_entries.iter_mut().enumerate() {
        for (e, column) in pattern.row(row) {
            columns[column] = entries[e];
        }
    }
    let delta = DoubleDouble::exact(1e-10);
    for column in 0..6 {
        let ends = [delta, -delta].map(|delta| {
            let (mut moved, mut w) = (y, [zero; 6]);
            moved[column] += delta;
            evaluator.flow_gradient(&moved, &mut w);
            w
        });
        let (mut unit, mut product) = ([zero; 6], [zero; 6]);
        unit[column] = DoubleDouble::exact(1.0);
        evaluator.hessian_vector(&y, &unit, &mut product);
        for row in 0..6 {
            let derivative = (ends[0][row] - ends[1][row]) / (delta + delta);
            let entry = by_entries[row][column];
            assert!(
                (derivative - entry).to_f64().abs() < 1e-17,
                "{row} {column}"
            );
            assert!(
                (product[row] - entry).to_f64().abs() < 1e-30,
                "{row} {column}"
            );
        }
    }
    let (mut evaluator, stride, count) = (top.evaluator::<f64>(), 4, 3);
    let state = |i: usize| TOP.map(|y| y + 0.1 * i as f64);
    let (mut states, mut all) = (vec![1.0; 24], vec![0.0; 24]);
    for i in 0..count {
        let rows = states.chunks_exact_mut(stride).zip(state(i));
        rows.for_each(|(row, y)| row[i] = y);
    }
    evaluator.gradients_by_component(&states, &mut all, stride, count);
    let mut hessians = vec![0.0; pattern.len() * stride];
    evaluator.hessians_by_component(&states, &mut hessians, stride, count);
    for i in 0..count {
        let (mut w, mut entries) = ([0.0; 6], vec![0.0; pattern.len()]);
        evaluator.flow_gradient(&state(i), &mut w);
        evaluator.hessian(&state(i), &mut entries);
        assert!((0..6).all(|c| w[c] == all[c * stride + i]));
        assert!((0..entries.len()).all(|e| (entries[e] - hessians[e * stride + i]).abs() < 1e-15));
    }
}

/// Tangent vectors are compared with differences of two runs.
#[test]
fn tangent_vectors_follow_the_motion() {
    let top = heavy_top();
    let by = || Equip::stages(8).step(0.1);
    let (q0, p0) = top.halves(&TOP);
    let mut stepper = by().start(&top, &q0, &p0, 0.0).unwrap();
    let mut tangent = TangentMap::new(&top, &mut stepper);
    let mut tangent_vector = vec![0.3, -0.2, 0.5, 0.1, 0.7, -0.4];
    let ends = [1e-5, -1e-5].map(|by_much| {
        let moved = TOP
            .iter()
            .zip(&tangent_vector)
            .map(|(y, d)| y + by_much * d);
        end(&run(by(), &top, &moved.collect::<Vec<_>>(), 3.0))
    });
    tangent
        .advance_to(&mut stepper, 3.0, &mut tangent_vector)
        .unwrap();
    for (found, (a, b)) in tangent_vector.iter().zip(ends[0].iter().zip(&ends[1])) {
        let derivative = (a - b) / 2e-5;
        assert!((found - derivative).abs() < 1e-8, "{found} {derivative}");
    }
}

#[test]
fn what_is_no_bracket_is_refused() {
    let energy = || Hamiltonian::of_state(3, |y| y[0] * y[0] + y[1] * y[2]).unwrap();
    let refused = |entries: &[(usize, usize)]| {
        let all = entries.to_vec();
        energy().with_bracket(|y| all.iter().map(|&(i, j)| (i, j, y[0])).collect())
    };
    for (entries, at) in [
        (vec![(1, 1)], (1, 1)),
        (vec![(0, 1), (2, 3)], (2, 3)),
        (vec![(0, 1), (1, 0)], (1, 0)),
    ] {
        let found = refused(&entries);
        let Err(BuildError::BracketEntry {
            row,
            column,
            components: 3,
        }) = found
        else {
            panic!("{entries:?}: {found:?}");
        };
        assert_eq!((row, column), at);
    }
    let with_time = Hamiltonian::with_time(1, |t, q, p| p[0] * p[0] + q[0] * t).unwrap();
    let found = with_time.with_bracket(|y| vec![(0, 1, y[0])]);
    assert!(matches!(found, Err(BuildError::BracketWithTime)));
    let by = Equip::stages(4).step(0.1);
    let found = by.integrate(&energy(), &[1.0, 0.0], &[0.5, 0.0], 0.0..=1.0);
    let error = found.unwrap_err().error;
    assert_eq!(error, IntegrateError::NoBracket { components: 3 });
}

/// Written and read, a system has the same bits, and another checksum than its energy alone.
#[test]
fn a_bracket_is_written_and_read() {
    let body = rigid_body([1, 2, 3]);
    let bytes = body.to_bytes().unwrap();
    let again = Hamiltonian::from_bytes(&bytes).unwrap();
    assert_eq!((again.components(), again.is_canonical()), (3, false));
    let by = || Equip::stages(4).step(0.1);
    let y0 = [0.3, 0.2, 1.0];
    assert_eq!(
        end(&run(by(), &body, &y0, 2.0)),
        end(&run(by(), &again, &y0, 2.0))
    );
    let sums = [&body, &again, &body.alone()].map(|h| h.evaluator::<f64>().formula_checksum());
    assert!(sums[0] == sums[1] && sums[0] != sums[2]);
    // After mark, format and checksum stands which recordings there are.
    let at = 8 + 4 + 8;
    assert_eq!(bytes[at], 1 + 4 + 8);
    let shorter = Hamiltonian::from_bytes(&bytes[..bytes.len() - 1]);
    assert!(matches!(shorter, Err(BytesError::Damaged { .. })));
}

/// B without the Jacobi identity may have an attracting equilibrium. There B∇H is a difference of numbers of
/// order one, and its rounding is no motion.
#[test]
fn an_attracting_equilibrium() {
    let h = Hamiltonian::of_state(3, |y| (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) / 2).unwrap();
    let h = h
        .with_bracket(|y| vec![(0, 1, 1.0 + y[0]), (0, 2, 1.0.into())])
        .unwrap();
    let (q, p) = h.halves(&[0.3, -1.0, 0.9]);
    for (stages, tolerance) in [(8, 1e-10), (8, 1e-12), (12, 1e-14)] {
        let method = Equip::stages(stages).tolerance(tolerance).max_steps(500);
        let run = method.integrate(&h, &q, &p, 0.0..=100.0).unwrap();
        let (_, q, p) = run.last();
        let found = [q[0], q[1].abs(), p[0].abs()];
        let side = 0.95_f64.sqrt();
        for (found, expected) in found.iter().zip([0.0, side, side]) {
            assert!((found - expected).abs() < 1e-8, "{q:?} {p:?}");
        }
    }
}
