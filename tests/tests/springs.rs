//! Stiff springs: few sweeps where the plain ones hardly contract, the same trajectory and energy, and nothing of it elsewhere.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Equip, FixedStep, Gauss, Method, Preconditioner, Record, Run};
use equip_scenes::Instance;
use equip_tests::{decimal_digits, relative_distance};

/// Three springs of ω = 50 in a soft chain, up to `end`.
fn chain(options: &FixedStep<f64>, end: f64) -> Run<f64> {
    let scene = Instance::from_reference("fpu_hlw").unwrap();
    let (q, p) = scene.initial::<f64>();
    let options = options.clone().record(Record::Ends);
    options
        .integrate(scene.hamiltonian(), &q, &p, 0.0..=end)
        .unwrap()
}

fn by_sweeps(method: Method, h: f64) -> FixedStep<f64> {
    method.step(h).preconditioner(Preconditioner::Identity)
}

/// Correct digits at t = 200, and sweeps a step; no step is left to anything else.
fn digits(options: &FixedStep<f64>) -> (f64, f64) {
    let scene = Instance::from_reference("fpu_hlw").unwrap();
    let reference = scene.reference().unwrap();
    let run = chain(options, reference.end::<f64>());
    let (_, q, p) = run.last();
    let (q_end, p_end) = reference.state::<f64>();
    let error = relative_distance(q, &q_end).max(relative_distance(p, &p_end));
    let counts = run.certificate().counts;
    assert_eq!((counts.taken_over, counts.halvings), (0, 0));
    let found = (
        decimal_digits(error),
        counts.sweeps as f64 / counts.steps as f64,
    );
    println!("{} steps: {found:?}", counts.steps);
    found
}

/// Without springs Gauss(16) takes 9.9 sweeps a step at h = 1/16 and 76 at h = 0.16, where half of the steps are halved.
#[test]
fn sweeps_are_few_and_the_trajectory_is_the_same() {
    // Measured: digits 9.4 to 11 at every h up to 0.16, the rest is rounding; 7.3 at h = 0.2, which is the method's error.
    for (s, h, least, most) in [
        (16, 0.0625, 8.9, 5.2),
        (16, 0.1, 8.9, 6.3),
        (16, 0.16, 8.7, 8.0),
        (16, 0.2, 6.9, 9.1),
        (8, 0.04, 9.0, 5.2),
    ] {
        let (digits, sweeps) = digits(&by_sweeps(Gauss::stages(s), h));
        assert!(digits > least && sweeps < most, "s = {s}, h = {h}");
    }
}

/// The α's by responses, as they come: linearised sweeps solve for springs too. Without that 11.4 sweeps a step at h = 0.08, and Newton's steps.
#[test]
fn responses_know_of_springs() {
    // Measured: digits 9.5, 9.9 and 10.2, sweeps 5.3, 6.0 and 4.7; Gauss has 9.6 to 10.2.
    for (s, h, least, most) in [
        (16, 0.08, 8.9, 5.8),
        (16, 0.1, 8.9, 6.6),
        (8, 0.04, 9.3, 5.2),
    ] {
        let options = Equip::stages(s).step(h);
        let (digits, sweeps) = digits(&options);
        assert!(digits > least && sweeps < most, "s = {s}, h = {h}");
        let counts = chain(&options, 20.0).certificate().counts;
        assert_eq!(counts.newton_iterations, 0);
    }
    // Defects that are none of rounding: hω = 2.5, 8 stages.
    let run = chain(&Equip::stages(8).step(0.05), 20.0);
    let counts = run.certificate().counts;
    println!("{counts:?}");
    assert_eq!(counts.newton_iterations, 0);
    assert!(counts.alpha_solves > 0);
    // Of an energy of 2 the largest defect is 2.8e-14 to 9.5e-14 with 380 to 420 steps, never more than 4 floors: the forces of the springs round by some
    // 20 times as much as p does, and where they are largest so is the floor.
    let (energy, floors) = (
        &run.certificate().energy,
        run.certificate().energy_in_floors,
    );
    let most = energy.as_ref().unwrap().max.abs();
    assert!(
        most < 1e-13 && floors.unwrap() <= 4.0,
        "{most:e}, {floors:?}"
    );
    let fine = chain(&Gauss::stages(16).step(0.0625), 20.0);
    let [found, gauss, fine] = [&run, &chain(&Gauss::stages(8).step(0.05), 20.0), &fine]
        .map(|run| [run.last().1, run.last().2].concat());
    let apart = [
        relative_distance(&found, &fine),
        relative_distance(&gauss, &fine),
    ];
    println!("{apart:?}");
    // Measured 7.3e-10 and 4.6e-10.
    assert!(apart[0] < 3.0 * apart[1], "{apart:?}");
}

/// To the last sweep, over 400 steps.
#[test]
fn the_work_is_known() {
    let count = |method, h: f64| {
        let run = chain(&by_sweeps(method, h), 400.0 * h);
        let c = run.certificate().counts;
        [c.steps, c.sweeps, c.gradients, c.taken_over]
    };
    let found = [
        count(Gauss::stages(8), 0.0625),
        count(Gauss::stages(16), 0.125),
        count(Equip::stages(16), 0.0625),
    ];
    assert_eq!(
        found,
        [
            [400, 2273, 18184, 0],
            [400, 2805, 44880, 0],
            [400, 2058, 33359, 0]
        ]
    );
}

/// Energy is at its floor, and grows neither without α's nor with them.
#[test]
fn energy_is_kept() {
    for h in [0.05, 0.1] {
        let run = chain(&by_sweeps(Equip::stages(16), h), 200.0);
        let energy = run.certificate().energy.as_ref().unwrap();
        println!("h = {h}: {:e}", energy.max);
        // Measured 3e-15 and 4.4e-15, of an energy of 2.
        assert!(energy.max.abs() < 1e-14);
    }
    let run = chain(
        &by_sweeps(Gauss::stages(16), 0.1).measure_energy(true),
        200.0,
    );
    let energy = run.certificate().energy.as_ref().unwrap();
    println!("Gauss: {:e}", energy.max);
    // Measured 3e-14 to 7e-14 on different ways of rounding; 1.6e-13 without springs.
    assert!(energy.max.abs() < 2e-13);
}

/// A run stopped and resumed is the run that was not, also before it is known whether the springs pay.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let scene = Instance::from_reference("fpu_hlw").unwrap();
    let (q, p) = scene.initial::<f64>();
    let energy = scene.hamiltonian();
    for options in [
        by_sweeps(Gauss::stages(16), 0.05),
        by_sweeps(Equip::stages(8), 0.05),
        Equip::stages(8).step(0.05),
    ] {
        let mut run = options.start(energy, &q, &p, 0.0).unwrap();
        for stop in [0, 1, 2, 50] {
            while run.view().index < stop {
                run.advance().unwrap();
            }
            let mut again = options.resume(energy, &run.checkpoint()).unwrap();
            let mut other = options.resume(energy, &run.checkpoint()).unwrap();
            for _ in 0..40 {
                let _ = again.advance().unwrap();
            }
            let (view, counts) = (again.view().to_step(), *again.counts());
            for _ in 0..20 {
                let _ = other.advance().unwrap();
            }
            let mut other = options.resume(energy, &other.checkpoint()).unwrap();
            for _ in 0..20 {
                let _ = other.advance().unwrap();
            }
            assert_eq!(other.view().to_step(), view);
            assert_eq!(other.counts().sweeps, counts.sweeps);
        }
    }
}

/// A step beyond what sweeps resolve is named where it is paid for, with the step that is not.
#[test]
fn the_certificate_names_springs_left_to_newton() {
    let run = |h: f64| chain(&Equip::stages(16).step(h), 20.0 * h);
    let (coarse, fine) = (run(0.14), run(0.125));
    let [coarse, fine] = [coarse.certificate(), fine.certificate()];
    assert!(coarse.counts.taken_over > 0);
    let angle = coarse.unresolved_spring.unwrap();
    // The stiff components of the chain have ω² = 50² and the soft springs besides.
    assert!((angle / (0.14 * 50.0) - 1.0).abs() < 2e-3, "{angle}");
    let text = coarse.to_string();
    assert!(
        text.contains("sweeps, which are faster, go up to 6.400"),
        "{text}"
    );
    let named = text.split("(steps of ").nth(1).unwrap();
    let named: f64 = named.split(')').next().unwrap().parse().unwrap();
    assert_eq!(run(named).certificate().counts.taken_over, 0);
    assert_eq!((fine.counts.taken_over, fine.unresolved_spring), (0, None));
    assert!(!fine.to_string().contains("stiff springs"));
}
