//! Potentials known at points: as right as splines are, as quick as formulas, however many points there are.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use cpu_time::ThreadTime;
use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Event, Gauss, IntegrateError, Run};
use equip_scalar::{DoubleDouble, Float};
use equip_tables::{Custom, Table, Table2};
use std::ops::ControlFlow::Continue;

/// −cos x at the ends of uniform intervals on [−4, 4], with a natural spline.
fn cosine(intervals: u32) -> Hamiltonian {
    let x: Vec<f64> = (0..=intervals)
        .map(|i| 8.0 * f64::from(i) / f64::from(intervals) - 4.0)
        .collect();
    let y: Vec<f64> = x.iter().map(|x| -x.cos()).collect();
    let v = Table::natural(&x, &y).unwrap();
    Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap()
}

/// To t = 100 from (0, 1.5) in 1000 steps.
fn swing(h: &Hamiltonian, stages: usize) -> Run<f64> {
    let method = Equip::stages(stages).step(0.1);
    method.integrate(h, &[0.0], &[1.5], 0.0..=100.0).unwrap()
}

fn end<T: Float>(run: &Run<T>) -> T {
    run.last().1[0]
}

/// DOP853 of SciPy 1.17.1 on the same spline, rtol 1e-12, steps of at most 0.005: 0.88436279. With 64 times
/// as many intervals the spline is the cosine itself, 0.8843816787.
#[test]
fn a_pendulum_of_64_intervals() {
    let h = cosine(64);
    // Measured: 1.7e-6 and 2.8e-7.
    for (stages, most) in [(4, 4e-6), (8, 6e-7)] {
        let q = end(&swing(&h, stages));
        assert!((q - 0.88436279).abs() < most, "s = {stages}: {q}");
    }
    // Measured: 5e-10 and 2e-10.
    for stages in [4, 8] {
        let q = end(&swing(&cosine(4096), stages));
        assert!((q - 0.8843816787).abs() < 1e-9, "4096 intervals: {q}");
    }
}

/// q(100) = 2 arcsin(k sn(100, k)) of the pendulum of the cosine, k = 3/4 (mpmath).
const PENDULUM_AT_100: f64 = 0.884_381_678_716_037_7;

/// The table of docs/potentials-from-data.md: energy defects, and q(100) beside the pendulum of the cosine.
#[test]
fn fixed_steps_over_knots() {
    let mut table = String::from(
        "| intervals | s | \\|ΔH\\| of EQUIP | of Gauss | error of q(100) |\n|---|---|---|---|---|\n",
    );
    for (intervals, stages, most) in [
        (64, 4, 6e-5),
        (512, 4, 1.5e-6),
        (4096, 4, 2e-9),
        (65536, 4, 3e-12),
        (64, 8, 6e-5),
    ] {
        let h = cosine(intervals);
        let runs = [Equip::stages(stages), Gauss::stages(stages)].map(|method| {
            let run = method.step(0.1).integrate(&h, &[0.0], &[1.5], 0.0..=100.0);
            run.unwrap()
        });
        let [equip, gauss] = runs.each_ref().map(|run| {
            let sizes = run.energy_errors().iter().map(|defect| defect.abs());
            sizes.fold(0.0, f64::max)
        });
        let off = (end(&runs[0]) - PENDULUM_AT_100).abs();
        table += &format!("| {intervals} | {stages} | {equip:.1e} | {gauss:.1e} | {off:.0e} |\n");
        assert!(equip <= 1.1 * gauss && off < most, "{intervals}: {off:e}");
    }
    println!("\n{table}");
}

/// With 64 intervals from knot to knot by Taylor's method with 45 digits (mpmath): 0.88436279501953. The
/// other table of docs/potentials-from-data.md.
#[test]
fn by_tolerance_over_knots() {
    let mut table = String::from(
        "| intervals, s | error of q(100) | steps | steps to a knot |\n|---|---|---|---|\n",
    );
    for (intervals, exact) in [(64, 0.884_362_795_019_53), (4096, PENDULUM_AT_100)] {
        for stages in [4, 8] {
            let by_tolerance = Equip::stages(stages).tolerance(1e-9);
            let run = by_tolerance.integrate(&cosine(intervals), &[0.0], &[1.5], 0.0..=100.0);
            let run = run.unwrap();
            let off = (end(&run) - exact).abs();
            let certificate = run.certificate();
            let crossed = certificate.discontinuities_crossed;
            let steps = certificate.counts.steps;
            table += &format!("| {intervals}, {stages} | {off:.0e} | {steps} | {crossed} |\n");
            assert!(off < 1e-8, "{intervals} intervals, s = {stages}: {off:e}");
        }
    }
    println!("\n{table}");
}

/// As long steps as the tolerance allows: those over many knots pass them over. Measured: 64 and 43 steps for
/// 2300 knots at 1e-6, where every knot taken for itself would take 2300.
#[test]
fn crowded_knots_are_passed_over() {
    for s in [4, 8] {
        let options = Equip::stages(s).tolerance(1e-6);
        let run = options.integrate(&cosine(1024), &[0.0], &[1.5], 0.0..=20.0);
        let steps = run.unwrap().certificate().counts.steps;
        println!("{s} stages: {steps} steps");
        assert!(steps < 100, "{s} stages: {steps}");
    }
}

/// [iterations, ∇H] of 1000 steps, at most, and less than a millisecond each: measured 5 µs, in either case.
#[test]
fn work_and_time_at_any_number_of_intervals() {
    for (intervals, most) in [(64, [3739, 19754]), (4096, [8427, 36396])] {
        let h = cosine(intervals);
        let started = ThreadTime::now();
        let run = swing(&h, 4);
        let a_step = started.elapsed() / 1000;
        println!("{intervals} intervals: {a_step:?} a step");
        let counts = &run.certificate().counts;
        assert!(
            counts.fixed_point_iterations <= most[0] && counts.gradients <= most[1],
            "{counts:?}"
        );
        assert!(a_step.as_micros() < 1000, "{intervals}: {a_step:?}");
    }
}

/// Hénon and Heiles from values on a grid: a cubic polynomial is its own spline, so the trajectory is that
/// of the formula, with the same work, and in double-double to as many digits more.
#[test]
fn henon_heiles_from_a_grid() {
    fn beside<T: Float>() -> (f64, [u64; 2]) {
        let u = |x: f64, y: f64| (x * x + y * y) / 2.0 + x * x * y - y * y * y / 3.0;
        let third = |x: DoubleDouble, y: DoubleDouble| {
            let exact = (x * x + y * y) / DoubleDouble::from(2.0) + x * x * y;
            exact - y * y * y / DoubleDouble::from(3.0)
        };
        let grid: Vec<f64> = [-1.0, -0.7, -0.2, 0.1, 0.5, 0.9, 1.2].to_vec();
        let wide: Vec<DoubleDouble> = grid.iter().map(|&x| x.into()).collect();
        let values: Vec<DoubleDouble> = (wide.iter())
            .flat_map(|&x| wide.iter().map(move |&y| third(x, y)))
            .collect();
        let v = Table2::not_a_knot(&wide, &wide, &values).unwrap();
        assert!((v.value(0.3, 0.4).unwrap() - u(0.3, 0.4)).abs() < 1e-16);
        let by_grid =
            Hamiltonian::new(2, |q, p| (p[0] * p[0] + p[1] * p[1]) / 2 + v.at(q[0], q[1]));
        let by_formula = Hamiltonian::new(2, |q, p| {
            let squares = p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1];
            squares / 2 + q[0] * q[0] * q[1] - q[1].powi(3) / 3
        });
        let runs = [by_grid.unwrap(), by_formula.unwrap()].map(|h| {
            let [q, p] = [[0.1, 0.2], [0.3, -0.1]].map(|x| x.map(T::exact));
            let method = Equip::stages(4).step(T::exact(0.25));
            let run = method.integrate(&h, &q, &p, T::int(0)..=T::int(20));
            run.unwrap()
        });
        let [x, y] = runs.each_ref().map(end);
        let iterations = runs.map(|run| run.certificate().counts.fixed_point_iterations);
        ((x - y).abs().to_f64(), iterations)
    }
    // Measured: 1.4e-15 and 3.8e-30.
    let (error, iterations) = beside::<f64>();
    println!("{error:e} {iterations:?}");
    assert!(error < 1e-14);
    assert!(
        iterations[0].abs_diff(iterations[1]) * 20 <= iterations[1],
        "{iterations:?}"
    );
    let (error, iterations) = beside::<DoubleDouble>();
    println!("{error:e} {iterations:?}");
    assert!(error < 1e-29);
}

/// A Lennard-Jones table with knots crowded at the wall, on a bound orbit: near to the formula. Every step
/// crosses knots, where y‴ jumps; the energy is off by what that makes of a step.
#[test]
fn lennard_jones_with_crowded_knots() {
    let x: Vec<f64> = (0..=600)
        .map(|i| 0.9 + 3.1 * (f64::from(i) / 600.0).powi(3))
        .collect();
    let y: Vec<f64> = x.iter().map(|r| 4.0 * (r.powi(-12) - r.powi(-6))).collect();
    let slopes = [x[0], x[600]].map(|r| -24.0 * (2.0 * r.powi(-13) - r.powi(-7)));
    let v = Table::clamped(&x, &y, slopes).unwrap();
    let by_table = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap();
    let by_formula = Hamiltonian::new(1, |q, p| {
        p[0] * p[0] / 2 + 4 * (q[0].powi(-12) - q[0].powi(-6))
    });
    let by_formula = by_formula.unwrap();
    let runs = [&by_table, &by_formula].map(|h| {
        let method = Equip::stages(4).step(0.01);
        method.integrate(h, &[1.05], &[0.5], 0.0..=20.0).unwrap()
    });
    let defects = runs.each_ref().map(|run| {
        let sizes = run.energy_errors().iter().map(|defect| defect.abs());
        sizes.fold(0.0, f64::max)
    });
    let [q, exact] = runs.each_ref().map(end);
    println!("{:e} {defects:?}", q - exact);
    // Measured: 3e-7 off; defects 1.1e-7 and, of the formula, 9e-15.
    assert!((q - exact).abs() < 1e-6);
    assert!(defects[0] < 4e-7 && defects[1] < 4e-14);
}

/// Closures in place of the cosine.
#[test]
fn closures_are_the_function() {
    let v = Custom::new(|x| -x.cos(), |x| x.sin(), |x| x.cos());
    v.check(0.3).unwrap();
    let by_closures = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap();
    let by_formula = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 - q[0].cos()).unwrap();
    assert!(by_closures.structure().separable);
    let runs = [&by_closures, &by_formula].map(|h| swing(h, 4));
    // Measured: 4e-14; the floors of the energy differ, and with them moves of the α's.
    let [q, exact] = runs.each_ref().map(end);
    println!("{:e}", q - exact);
    assert!((q - exact).abs() < 1e-12);
}

fn flight(v: &Table) -> Hamiltonian {
    Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap()
}

/// A table ends a run where it ends, also if only a stage of the step is beyond.
#[test]
fn the_motion_leaves_a_table() {
    let v = Table::natural(&[-1.0, 0.0, 1.0], &[0.0, -0.1, 0.0]).unwrap();
    let h = flight(&v);
    for method in [Equip::stages(4), Gauss::stages(4)] {
        let fixed = method.step(0.25).integrate(&h, &[0.0], &[1.0], 0.0..=5.0);
        let chosen = method
            .tolerance(1e-9)
            .integrate(&h, &[0.0], &[1.0], 0.0..=5.0);
        let back = method
            .tolerance(1e-9)
            .integrate(&h, &[0.0], &[1.0], 0.0..=-5.0);
        for (made, side) in [(fixed, 1.0), (chosen, 1.0), (back, -1.0)] {
            let failure = made.unwrap_err();
            let text = failure.to_string();
            let IntegrateError::OutsideOfTable {
                time,
                argument,
                first,
                last,
            } = failure.error
            else {
                panic!("{text}");
            };
            assert!(text.contains("argument of a table in H"), "{text}");
            assert!(
                first == -1.0 && last == 1.0 && argument * side > 1.0,
                "{text}"
            );
            // At about the speed 1, a step later at most.
            assert!(time * side > 1.0 && time * side < 2.0, "{text}");
            let (_, q, _) = failure.partial.as_ref().unwrap().last();
            assert!(q[0].abs() <= 1.0 && q[0] * side > 0.3, "{q:?}");
        }
        let start = method.step(0.25).integrate(&h, &[2.0], &[1.0], 0.0..=5.0);
        let error = start.unwrap_err().error;
        assert!(
            matches!(error, IntegrateError::OutsideOfTable { argument: 2.0, .. }),
            "{error}"
        );
        let further = v.extrapolated();
        let h = flight(&further);
        assert!(
            method
                .step(0.25)
                .integrate(&h, &[0.0], &[1.0], 0.0..=5.0)
                .is_ok()
        );
    }
    // Between two steps: up to 1.01 and back, with the middle stage beyond.
    let ball = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + q[0] + 1e-30 * v.at(q[0])).unwrap();
    let over = Equip::stages(5).step(2.0 * 2.02_f64.sqrt());
    let made = over.integrate(
        &ball,
        &[0.0],
        &[2.02_f64.sqrt()],
        0.0..=2.0 * 2.02_f64.sqrt(),
    );
    let error = made.unwrap_err().error;
    assert!(
        matches!(error, IntegrateError::OutsideOfTable { .. }),
        "{error}"
    );
}

/// A table far from the origin: its argument has few digits, and no step must be shorter for that. The motion
/// is that at the origin, up to rounding of the positions.
#[test]
fn a_table_may_be_far_from_the_origin() {
    let at = |offset: f64| {
        let x: Vec<f64> = (0..41)
            .map(|i| offset - 6.0 + 0.25 * f64::from(i))
            .collect();
        let y: Vec<f64> = x
            .iter()
            .map(|x| ((x - offset) / 2.0).cosh() + 0.2 * (3.0 * (x - offset)).sin())
            .collect();
        let v = Table::natural(&x, &y).unwrap();
        Hamiltonian::new(1, move |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap()
    };
    for tolerance in [1e-11, 1e-12, 1e-13] {
        let ends = [0.0, 1024.0, 16384.0, 131072.0].map(|offset| {
            let method = Equip::stages(8).tolerance(tolerance).max_steps(200);
            let run = method.integrate(&at(offset), &[offset + 1.0], &[0.5], 0.0..=10.0);
            let run = run.unwrap_or_else(|failure| panic!("{offset}: {failure}"));
            (offset, end(&run) - offset)
        });
        for (offset, q) in &ends[1..] {
            let error = (q - ends[0].1).abs();
            let most = 1e3 * (tolerance + f64::EPSILON * offset);
            assert!(error < most, "{offset}, {tolerance:e}: {error:e}");
        }
    }
}

/// A fall from y0 with U = 2 q on [0, 40] meets the end of the table at √y0 and, bounced there, again after
/// 2 √y0. The step that contains the end reaches beyond it.
#[test]
fn an_event_at_the_end_of_a_table() {
    let x: Vec<f64> = (0..=20).map(|i| f64::from(2 * i)).collect();
    let y: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
    let v = Table::natural(&x, &y).unwrap();
    let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0])).unwrap();
    for start in [10.0_f64, 33.3] {
        let meets = start.sqrt();
        for method in [Equip::stages(4), Equip::stages(8), Gauss::stages(6)] {
            for method in [method.step(1.0), method.tolerance(1e-10)] {
                let end = || Event::new("end", |_, q: &[f64], _: &[f64]| q[0]).falling();
                let falls = |event, until| {
                    let run = method.clone().event(event).dense();
                    run.integrate(&h, &[start], &[0.0], 0.0..=until)
                };
                let run = falls(end().terminal(), 20.0).unwrap();
                assert!((run.last().0 - meets).abs() < 1e-12, "{:?}", run.last());
                let bounces = end().then(|_, _, p| {
                    p[0] = -p[0];
                    Continue(())
                });
                let run = falls(bounces, 6.5 * meets).unwrap();
                let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
                assert_eq!(times.len(), 3);
                for (time, k) in times.iter().zip([1.0, 3.0, 5.0]) {
                    assert!((time - k * meets).abs() < 1e-11, "{times:?}");
                }
                // An event beyond the table comes too late, one that only watches ends nothing.
                let beyond = Event::new("beyond", |_, q: &[f64], _: &[f64]| q[0] + 0.01).falling();
                for event in [beyond.terminal(), end()] {
                    let failure = falls(event, 20.0).unwrap_err();
                    let outside = matches!(failure.error, IntegrateError::OutsideOfTable { .. });
                    let partial = failure.partial.unwrap();
                    assert!(
                        outside && partial.last().1[0] >= 0.0,
                        "{:?}",
                        partial.last()
                    );
                    assert!(partial.events().is_empty());
                }
            }
        }
    }
}
