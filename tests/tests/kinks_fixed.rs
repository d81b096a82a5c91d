//! Fixed steps over kinks, values of H that jump, and starts where the force jumps.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::kinks::{apart, end, kinked, wedge};
use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss, IntegrateError};
use equip_tests::{Misses, Seeded};

/// Steps of one size that are over a switch are made in two: the energy is that of a smooth H, the order is
/// kept, and the grid is as it was.
#[test]
fn fixed_steps_meet_switches_too() {
    let mut misses = Misses::default();
    // Knots are passed over.
    for case in kinked().into_iter().filter(|case| case.name != "spline") {
        let (q, p) = case.start.split_at(case.start.len() / 2);
        // Steps that resolve the motion, and how far off they may be.
        let (steps, most) = match case.name {
            "Lennard-Jones, cut off" => (3000, 1e-7),
            _ => (1000, 1e-9),
        };
        let h = case.time / f64::from(steps);
        let options = Equip::stages(6).step(h).dense();
        let run = options.integrate(&case.energy, q, p, 0.0..=case.time);
        let run = run.unwrap();
        let certificate = run.certificate();
        assert_eq!(run.len(), steps as usize + 1, "{}", case.name);
        assert!(certificate.discontinuities_crossed > 5, "{}", case.name);
        let defect = certificate.energy.as_ref().unwrap().max;
        let error = apart(&end(&run), &case.right);
        println!("{}: {error:.1e}, energy {defect:.1e}", case.name);
        misses.most(&format!("{}, error", case.name), error / most, 1.0);
        misses.most(&format!("{}, energy", case.name), defect, 1e-13);
        // Dense output knows the parts of a step.
        let trajectory = run.trajectory().unwrap();
        for i in [run.len() / 3, run.len() / 2] {
            let (time, before) = (run.times()[i], run.times()[i - 1]);
            let (q, p) = trajectory.at(time).unwrap();
            let off = apart(&[q, p].concat(), &[run.q(i), run.p(i)].concat());
            misses.most(&format!("{}, dense", case.name), off, 1e-13);
            let (q, p) = trajectory.at(0.5 * (time + before)).unwrap();
            let between = [q, p].concat();
            let ends = [run.q(i), run.p(i)].concat();
            misses.most(
                &format!("{}, between", case.name),
                apart(&between, &ends),
                4.0 * h,
            );
        }
    }
    misses.end();
}

/// Order 2s where the second derivative of the force jumps: half the step, 1/64 of the error with three
/// stages.
#[test]
fn fixed_steps_over_kinks_keep_their_order() {
    let cubic = kinked().into_iter().find(|case| case.name == "cubic");
    let cubic = cubic.unwrap();
    for method in [Equip::stages(3), Gauss::stages(3)] {
        let errors = [200, 400, 800].map(|steps| {
            let options = method.step(cubic.time / f64::from(steps));
            let run = options.integrate(&cubic.energy, &[1.0], &[0.0], 0.0..=cubic.time);
            apart(&end(&run.unwrap()), &cubic.right)
        });
        let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
        println!("{method}: {errors:?}, orders {orders:.2?}");
        assert!(orders.iter().all(|order| (order - 6.0).abs() < 0.4));
    }
}

/// A ball on a wedge moves by parabolas, which two stages follow exactly: whatever the step is, the state is
/// that of the closed form to rounding, forward and back.
#[test]
fn a_wedge_by_fixed_steps_is_exact() {
    let energy = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].abs()).unwrap();
    let (right, passed) = wedge([1.0, 1.0, 0.3], 50.0);
    for (method, steps) in [
        (Equip::stages(3), 100_u32),
        (Gauss::stages(2), 50),
        (Equip::stages(8), 23),
    ] {
        let options = method.step(50.0 / f64::from(steps));
        let mut run = options.start(&energy, &[1.0], &[0.3], 0.0).unwrap();
        let view = run.advance_to(50.0).unwrap();
        let error = apart(&[view.q[0], view.p[0]], &right);
        assert_eq!(
            run.certificate().discontinuities_crossed,
            passed,
            "{method}"
        );
        assert_eq!(run.certificate().counts.steps, u64::from(steps));
        let view = run.advance_to(0.0).unwrap();
        let back = apart(&[view.q[0], view.p[0]], &[1.0, 0.3]);
        println!("{method}: {error:.1e}, back {back:.1e}");
        assert!(error < 1e-12 && back < 1e-12);
    }
}

/// Where H itself jumps, or is said to where it only bends.
#[test]
fn values_that_jump_are_told() {
    let selected = |low: f64, steep: f64| {
        Hamiltonian::new(1, move |q, p| {
            let beyond = low + 0.5 * q[0] * q[0] + steep * (q[0] - 0.3);
            0.5 * p[0] * p[0] + (q[0] - 0.3).select(beyond, 0.5 * q[0] * q[0])
        })
        .unwrap()
    };
    for (low, steep) in [
        (0.1, 0.0),
        (-1e-3, 0.7),
        (1e-8, 0.0),
        (0.0, 0.7),
        (0.0, 0.0),
    ] {
        for run in [
            Equip::stages(6)
                .tolerance(1e-10)
                .integrate(&selected(low, steep), &[1.0], &[0.2], 0.0..=10.0)
                .unwrap(),
            Equip::stages(6)
                .step(0.1)
                .integrate(&selected(low, steep), &[1.0], &[0.2], 0.0..=10.0)
                .unwrap(),
        ] {
            let certificate = run.certificate();
            let text = certificate.to_string();
            match certificate.energy_jumps {
                Some(jumps) => {
                    assert!(low.abs() > 0.0 && jumps.count == certificate.discontinuities_crossed);
                    assert!(
                        (jumps.largest - low.abs()).abs() < 1e-3 * low.abs(),
                        "{jumps:?}"
                    );
                    assert!(text.contains("a jump exerts no force"), "{text}");
                    assert!(!certificate.energy_conserved_on_every_step());
                }
                None => assert!(!(low.abs() > 0.0), "{low:e} {steep}: {text}"),
            }
            let bends = low.abs() > 0.0 || steep > 0.0;
            assert!(certificate.discontinuities_crossed > 2 || !bends);
        }
    }
}

/// Where only a derivative of H jumps, in q or in p, no jump is told. Jumps by 1e-7 to 0.1 all are.
#[test]
fn small_jumps_are_told_from_bends() {
    let mut rng = Seeded::new(3);
    let (mut told, mut met) = (0, 0);
    for run in 0..60 {
        let jump = [0.0, rng.power_of_ten(-7.0, -1.0)][run % 2];
        let [steep, place] = [rng.between(0.2, 2.0), rng.between(-0.5, 0.5)];
        let energy = Hamiltonian::new(1, |q, p| {
            let (x, free) = (q[0] - place, 0.5 * p[0] * p[0]);
            0.5 * q[0] * q[0]
                + match run / 2 % 3 {
                    0 => free + x.select(steep * x + jump, 0.0 * x),
                    1 => free + x.select(steep * x * x + jump, 0.0 * x),
                    _ => p[0].select(p[0] * p[0] + jump, free),
                }
        })
        .unwrap();
        let stages = 3 + rng.below(6);
        let options = if rng.once_in(2) {
            Equip::stages(stages).step(rng.between(0.02, 0.5))
        } else {
            Equip::stages(stages).tolerance(rng.power_of_ten(-11.0, -6.0))
        };
        let (q, p) = (rng.between(0.6, 1.2), rng.between(-0.3, 0.3));
        let run = options.integrate(&energy, &[q], &[p], 0.0..=50.0).unwrap();
        let certificate = run.certificate();
        let count = certificate.energy_jumps.map_or(0, |jumps| jumps.count);
        if jump > 0.0 {
            told += count;
            met += certificate.discontinuities_crossed;
        } else {
            assert_eq!(count, 0, "{certificate}");
        }
    }
    assert!(met > 400 && told == met, "{told} of {met}");
}

/// All crossings are found, and no others, whatever the number of steps is.
#[test]
fn crossings_of_a_rotating_bar_by_fixed_steps() {
    let mut misses = Misses::default();
    let bar = kinked()
        .into_iter()
        .find(|case| case.name == "rotating bar")
        .unwrap();
    let (q, p) = bar.start.split_at(bar.start.len() / 2);
    for steps in [700, 800, 900, 950, 1000, 1001, 1003, 1050, 1100, 1300, 1500] {
        let options = Equip::stages(6).step(bar.time / f64::from(steps));
        let run = options
            .integrate(&bar.energy, q, p, 0.0..=bar.time)
            .unwrap();
        let certificate = run.certificate();
        let off = certificate.discontinuities_crossed.abs_diff(16) as f64;
        misses.most(&format!("{steps} steps, crossings off"), off, 0.0);
    }
    misses.end();
}

/// From a switch on which H is that of the other side: a force that is turned on at the start, by time and by
/// the motion.
#[test]
fn a_run_may_begin_where_the_force_jumps() {
    // 1 from the start on, −1 before; exactly at the start it is that of before.
    let turned_on = |start: f64| {
        Hamiltonian::with_time(1, move |t, q, p| {
            let force = (start - t).select(-1.0, 1.0);
            0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * force
        })
    };
    let fall = Hamiltonian::new(1, |q, p| {
        let (low, high) = (q[0] * 1.0, q[0] * 2.0);
        0.5 * p[0] * p[0] - (-q[0]).select(low, high)
    });
    for s in [2, 8] {
        let options = Equip::stages(s).tolerance(1e-10);
        for start in [0.0, 1.0] {
            let energy = turned_on(start).unwrap();
            let run = options
                .integrate(&energy, &[0.0], &[0.0], start..=start + 3.0)
                .unwrap();
            let right = [1.0 - 3f64.cos(), 3f64.sin()];
            assert!(apart(&end(&run), &right) < 1e-8);
            assert!(run.certificate().counts.steps < 1000);
        }
        let energy = fall.as_ref().unwrap();
        let run = options
            .integrate(energy, &[0.0], &[0.0], 0.0..=3.0)
            .unwrap();
        assert!(apart(&end(&run), &[9.0, 6.0]) < 1e-8);
    }
}

/// At rest in a corner where H is one side's, no step is consistent: an error, and not a run without end.
#[test]
fn a_corner_that_pushes_back_ends_a_run() {
    let corner = Hamiltonian::new(2, |q, p| {
        let side = (-q[1]).select(-q[1] * 2.0, q[1]);
        0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0]) + side
    });
    // A corner that no trace tells.
    let external = Hamiltonian::external(
        2,
        2.0_f64.powi(-50),
        |q, p| {
            let side = if q[1] < 0.0 { -2.0 * q[1] } else { q[1] };
            0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0]) + side
        },
        |q, p, by_q, by_p| {
            by_q.copy_from_slice(&[q[0], if q[1] < 0.0 { -2.0 } else { 1.0 }]);
            by_p.copy_from_slice(p);
        },
    );
    for corner in [corner.unwrap(), external.unwrap()] {
        let run = Equip::stages(8).tolerance(1e-8).max_steps(2000);
        let run = run.integrate(&corner, &[1.0, 0.0], &[0.0, 0.0], 0.0..=10.0);
        let error = run.unwrap_err().error;
        let is_told = matches!(error, IntegrateError::StepBelowMinimum { .. });
        assert!(is_told, "{error}");
    }
}

/// H is linear on each side of a kink: there is no ∇²H for Newton's method. The motion runs along a diamond
/// with speed ±1.
#[test]
fn an_energy_without_curvature_is_integrated() {
    let diamond = Hamiltonian::new(1, |q, p| p[0].abs() + q[0].abs()).unwrap();
    for (q, p, t) in [(1.2, 0.1, 50.0), (-1.0, 0.4, 30.0), (0.3, -0.7, 41.0)] {
        let method = Equip::stages(8).tolerance(1e-10);
        let run = method.integrate(&diamond, &[q], &[p], 0.0..=t).unwrap();
        // The position along the diamond |q| + |p| = r, from (r, 0) towards −p.
        let r = f64::abs(q) + f64::abs(p);
        let along = if q > 0.0 { -p } else { 2.0 * r + p };
        let place = (along + t).rem_euclid(4.0 * r);
        let wave = |x: f64| (x.rem_euclid(4.0 * r) - 2.0 * r).abs() - r;
        assert!(
            apart(&end(&run), &[wave(place), -wave(place - r)]) < 1e-8,
            "{q} {p}"
        );
    }
}

/// An attempt over a kink is rejected. Its error is no bound for the parts of the step, in which H is
/// quadratic and the Gauss step exact: q = −5 + 5.8 cos √0.2 t and its mirror image.
#[test]
fn a_rejected_attempt_bounds_no_later_step() {
    let bowl = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + q[0].abs() + q[0] * q[0] / 10);
    let bowl = bowl.unwrap();
    let exact = |q0: f64, t: f64| {
        let rate = 0.2_f64.sqrt();
        let quarter = (5.0 / (5.0 + q0)).acos() / rate;
        let half = ((t + quarter) / (2.0 * quarter)).floor();
        let sign = if half % 2.0 == 0.0 { 1.0 } else { -1.0 };
        sign * ((5.0 + q0) * (rate * (t - 2.0 * quarter * half)).cos() - 5.0)
    };
    for q0 in [0.1, 0.3, 0.8, 1.3] {
        for step in [0.5, 1.0, 1.25, 1.5] {
            for s in [6, 8, 12] {
                let method = Equip::stages(s).step(step);
                let run = method.integrate(&bowl, &[q0], &[0.0], 0.0..=30.0).unwrap();
                let error = (run.last().1[0] - exact(q0, 30.0)).abs();
                assert!(error < 1e-12, "q0 = {q0}, h = {step}, s = {s}: {error:e}");
            }
        }
    }
}
