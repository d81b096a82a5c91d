//! `advance_to`, forward and back: times are met, the start is found again, tangent vectors come along.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Chaos, Equip, Gauss, IntegrateError, NoObserver, TangentMap};

/// Sun and Mars in the rotating frame; positions and momenta p = v + (−y, x, 0).
fn sun_mars() -> Hamiltonian {
    let mu = 3.227154996101724e-7;
    Hamiltonian::new(3, |q, p| {
        let far = (q[0] + mu).powi(2) + q[1].powi(2) + q[2].powi(2);
        let near = (q[0] - (1.0 - mu)).powi(2) + q[1].powi(2) + q[2].powi(2);
        0.5 * (p[0].powi(2) + p[1].powi(2) + p[2].powi(2)) + p[0] * q[1]
            - p[1] * q[0]
            - (1.0 - mu) / far.sqrt()
            - mu / near.sqrt()
    })
    .unwrap()
}

/// A charged particle in a homogeneous magnetic field and a well: H(q, −p) ≠ H(q, p).
fn particle() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let [x, y] = [p[0] + 0.6 * q[1], p[1] - 0.6 * q[0]];
        0.5 * (x * x + y * y) + 0.25 * (q[0] * q[0] + q[1] * q[1]).powi(2) + 0.3 * q[0]
    })
    .unwrap()
}

/// Two coupled rotors in a rotating frame.
fn rotating() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 0.8 * (q[0] * p[1] - q[1] * p[0])
            + 0.9 * (q[0] * q[0] + q[1] * q[1])
            - (q[0] - 0.5 * q[1]).cos()
    })
    .unwrap()
}

/// Not separable, odd in p.
fn skew() -> Hamiltonian {
    Hamiltonian::new(1, |q, p| {
        (0.7 * p[0]).cosh() + 0.5 * q[0] * q[0] + 0.2 * p[0] * q[0].sin()
    })
    .unwrap()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn negative_time_leads_back_to_the_start() {
    let systems = [
        (particle(), vec![0.8, -0.3], vec![0.2, 0.6]),
        (rotating(), vec![0.9, 0.2], vec![-0.3, 0.7]),
        (skew(), vec![0.7], vec![0.4]),
    ];
    for (number, (h, q, p)) in systems.iter().enumerate() {
        let start = [q.as_slice(), p].concat();
        for (s, step) in [(4, 0.05), (6, 0.1), (8, 0.2)] {
            for method in [Equip::stages(s), Gauss::stages(s)] {
                let mut run = method.step(step).start(h, q, p, 1.0).unwrap();
                let there = run.advance_to(1.0 + 300.0 * step).unwrap();
                assert_eq!((there.time, there.index), (1.0 + 300.0 * step, 300));
                let far = distance(&[there.q, there.p].concat(), &start);
                let back = run.advance_to(1.0).unwrap();
                assert_eq!((back.time, back.index), (1.0, 600));
                let off = distance(&[back.q, back.p].concat(), &start) / 600.0;
                println!("{number}, {method}: {off:.1e} a step");
                // Measured at most 2.6e-18 a step.
                assert!(off < 1e-16 && far > 0.1);
            }
        }
        // Whole runs, by a tolerance: the steps back are other ones.
        let options = Equip::stages(8).tolerance(1e-13);
        let there = options.integrate(h, q, p, 0.0..=20.0).unwrap();
        let (t, q1, p1) = there.last();
        let back = options.integrate(h, q1, p1, t..=0.0).unwrap();
        let off = distance(&[back.last().1, back.last().2].concat(), &start);
        println!("{number}, tolerance: {off:.1e} in {} steps", back.len() - 1);
        assert!(off < 1e-13 * (back.len() + there.len()) as f64);
    }
}

#[test]
fn times_are_met_by_every_stepper_in_any_order() {
    let (h, q, p) = (particle(), [0.8, -0.3], [0.2, 0.6]);
    let reference = Equip::stages(10).step(0.05);
    let exact = |t: f64| {
        let run = reference.integrate(&h, &q, &p, 0.0..=t).unwrap();
        [run.last().1, run.last().2].concat()
    };
    let times = [0.3, 0.3, 2.0, 1.234_567, -1.5, -1.5 - 1e-9, 0.7, 0.0];
    macro_rules! meets {
        ($options:expr) => {
            let mut run = $options.start(&h, &q, &p, 0.0).unwrap();
            for t in times {
                let view = run.advance_to(t).unwrap();
                assert_eq!(view.time, t);
                let off = distance(&[view.q, view.p].concat(), &exact(t));
                assert!(off < 1e-10, "t = {t}: {off:.1e}");
            }
            let before = run.view().index;
            assert_eq!(run.advance_to(0.0).unwrap().index, before);
            let error = run.advance_to(f64::NAN).unwrap_err();
            assert!(matches!(error, IntegrateError::Interval { .. }));
            // Goes on from there, the way it went last, and after a checkpoint just so.
            let checkpoint = run.checkpoint();
            let mut again = $options.resume(&h, &checkpoint).unwrap();
            let (step, time) = (run.advance().unwrap().to_step(), run.time());
            assert!(time < 0.0);
            assert_eq!(again.advance().unwrap().to_step(), step);
            assert_eq!(
                run.advance_to(0.25).unwrap().q,
                again.advance_to(0.25).unwrap().q
            );
        };
    }
    meets!(Equip::stages(8).step(0.1));
    meets!(Equip::stages(8).tolerance(1e-13));
}

#[test]
fn a_run_that_has_turned_goes_on_the_way_it_went() {
    let (h, q, p) = (particle(), [0.8, -0.3], [0.2, 0.6]);
    let options = Equip::stages(6).step(0.125);
    let mut run = options.start(&h, &q, &p, 0.0).unwrap();
    run.advance_to(5.0).unwrap();
    run.turn_back();
    run.advance().unwrap();
    let (checkpoint, mut observer) = (run.checkpoint(), NoObserver);
    let options = options.output_at(&[3.0, 2.5]);
    let rest = options
        .integrate_from(&h, &checkpoint, 2.0, &mut observer)
        .unwrap();
    assert_eq!((rest.times()[0], rest.last().0), (4.875, 2.0));
    assert_eq!(rest.outputs().count(), 2);
    assert_eq!(rest.last().1, run.advance_to(2.0).unwrap().q);
    let error = options
        .integrate_from(&h, &checkpoint, 7.0, &mut observer)
        .unwrap_err();
    assert!(matches!(error.error, IntegrateError::StepsLeadAway { .. }));
}

#[test]
fn an_escape_is_told_back_in_time_too() {
    // q'' = q³ from (1, ±2): infinity is reached at ±1.0847.
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0].powi(2) - 0.25 * q[0].powi(4)).unwrap();
    let made = |p: f64, end: f64| {
        let options = Equip::stages(4).step(0.1).max_halvings(0);
        let failure = options.integrate(&h, &[1.0], &[p], 0.0..=end);
        failure.unwrap_err().error
    };
    let (
        IntegrateError::Escape {
            time: t, step: h, ..
        },
        IntegrateError::Escape { time, step, .. },
    ) = (made(2.0, 5.0), made(-2.0, -5.0))
    else {
        panic!("{}, {}", made(2.0, 5.0), made(-2.0, -5.0));
    };
    assert_eq!((t, h), (-time, -step));
}

#[test]
fn a_shorter_step_does_not_shorten_those_after_it() {
    let (h, q, p) = (particle(), [0.8, -0.3], [0.2, 0.6]);
    let options = Equip::stages(8).tolerance(1e-10);
    let count = |times: &[f64]| {
        let mut run = options.start(&h, &q, &p, 0.0).unwrap();
        for &t in times {
            run.advance_to(t).unwrap();
        }
        run.counts().steps
    };
    let through = count(&[40.0]);
    // Each time that is met costs a step or two.
    let times: Vec<f64> = (1..=10).map(|k| 4.0 * f64::from(k)).collect();
    let (met, most) = (count(&times), through + 20);
    println!("{through} steps through, {met} with ten times on the way");
    assert!(met <= most);
}

/// In the rotating frame slopes are differences of what is 200 times as large: a tolerance of 1e-14 is below
/// their rounding, which no shorter step has less of. It took 7·10⁶ steps with 8 stages, and came to no end.
#[test]
fn a_tolerance_below_the_rounding_of_slopes_is_passed() {
    let h = sun_mars();
    let (q, p) = (
        [1.0039864458435765, 0.0, 4.335916304728241e-6],
        [0.0, 0.0046152704705937145 + 1.0039864458435765, 0.0],
    );
    for s in [6, 8, 10, 12] {
        let count = |tolerance: f64| {
            let mut run = Equip::stages(s)
                .tolerance(tolerance)
                .max_steps(1000)
                .start(&h, &q, &p, 0.0)
                .unwrap();
            run.advance_to(3.091479153450648).unwrap();
            let refused = run.certificate().variable_steps.unwrap().rejected;
            println!("s = {s}, {tolerance:e}: {refused} refused");
            run.counts().steps + refused
        };
        // Within `max_steps`; and tries that are refused, of which there were two a step.
        for tolerance in [1e-13, 1e-14, 3e-15] {
            assert!(count(tolerance) <= 1000, "{s}, {tolerance:e}");
        }
    }
}

#[test]
fn the_tangent_map_comes_along_in_one_call() {
    let h = sun_mars();
    let (q, v) = (
        [1.0039864458435765, 0.0, 4.335916304728241e-6],
        [0.0, 0.0046152704705937145, 0.0],
    );
    let p = [v[0] - q[1], v[1] + q[0], v[2]];
    let t = 3.091479153450648;
    // ∂(q, p)/∂q_1: the first two are listed with the case, all by DOP853 at rtol 3e-14.
    let first = [
        1_044.865_399_8,
        -910.798_342_4,
        0.535_999_095,
        4_074.436_513_6,
        -857.915_177_4,
        3.833_387_518,
    ];
    let identity = || -> Vec<f64> { (0..36).map(|i| f64::from(i % 7 == 0)).collect() };
    macro_rules! carries {
        ($options:expr) => {
            let mut run = $options.start(&h, &q, &p, 0.0).unwrap();
            let mut tangent = TangentMap::new(&h, &mut run);
            let mut columns = identity();
            tangent.advance_to(&mut run, t, &mut columns).unwrap();
            assert_eq!(run.time(), t);
            for (&found, wanted) in columns[..6].iter().zip(first) {
                assert!((found - wanted).abs() < 2e-9 * 4e3, "{found} {wanted}");
            }
            // Back: the inverse map.
            tangent.advance_to(&mut run, 0.0, &mut columns).unwrap();
            let off = distance(&columns, &identity());
            println!("back: {off:.1e}");
            assert!(off < 1e-5);
        };
    }
    carries!(Equip::stages(8).step(0.01));
    carries!(Equip::stages(8).tolerance(1e-14));
}

#[test]
fn steps_that_tangent_vectors_missed_are_said() {
    let (h, q, p) = (particle(), [0.8, -0.3], [0.2, 0.6]);
    let mut run = Equip::stages(4).step(0.1).start(&h, &q, &p, 0.0).unwrap();
    let mut tangent = TangentMap::new(&h, &mut run);
    let mut tangent_vector = [1.0, 0.0, 0.0, 0.0];
    run.advance().unwrap();
    tangent.propagate(&run, &mut tangent_vector).unwrap();
    run.advance_to(1.0).unwrap();
    let error = tangent.propagate(&run, &mut tangent_vector).unwrap_err();
    assert_eq!(error, IntegrateError::StepsNotFollowed { steps: 9 });
    let error = tangent
        .advance_to(&mut run, 2.0, &mut tangent_vector)
        .unwrap_err();
    assert_eq!(error, IntegrateError::StepsNotFollowed { steps: 9 });
    // Begun anew the run has none that were missed.
    run.restart(&q, &p, 0.0).unwrap();
    run.advance().unwrap();
    tangent.propagate(&run, &mut tangent_vector).unwrap();
}

#[test]
fn lyapunov_exponents_back_in_time_are_positive_as_well() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * (p[0] * p[0] - q[0] * q[0])).unwrap();
    let mut run = Equip::stages(6)
        .step(0.1)
        .start(&h, &[0.1], &[0.0], 0.0)
        .unwrap();
    let mut chaos = Chaos::new(&h, &mut run, &[1.0, 0.3]);
    chaos.advance_to(&mut run, -20.0).unwrap();
    // δ = a e^{t} + b e^{−t}: ln growth over 20 is 20 less ln of what is along the other direction.
    assert!((chaos.lyapunov() - 1.0).abs() < 0.1, "{}", chaos.lyapunov());
}

/// Three steps of 0.1 end at 0.30000000000000004, which is 0.3 within the rounding of the grid: the run is
/// there, and has not turned back.
#[test]
fn a_time_met_but_for_rounding_turns_nothing() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let options = Equip::stages(4).step(0.1);
    let mut run = options.start(&h, &[1.0], &[0.0], 0.0).unwrap();
    for _ in 0..3 {
        run.advance().unwrap();
    }
    assert!(run.time() > 0.3);
    assert_eq!(run.advance_to(0.3).unwrap().index, 3);
    let view = run.advance().unwrap();
    assert!((view.time - 0.4).abs() < 1e-15 && view.index == 4);
}

/// λ and MEGNO are of the time covered, which a run back at its start has none less of.
#[test]
fn indicators_of_a_run_led_back_to_its_start_are_numbers() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let options = Equip::stages(6).step(0.1);
    let mut run = options.start(&h, &[1.0], &[0.0], 0.0).unwrap();
    let mut chaos = Chaos::new(&h, &mut run, &[1.0, 0.5]);
    chaos.advance_to(&mut run, 20.0).unwrap();
    chaos.advance_to(&mut run, 0.0).unwrap();
    chaos.advance_to(&mut run, 5.0).unwrap();
    assert!(chaos.lyapunov().abs() < 0.1 && chaos.megno().abs() < 10.0);
}

/// A whole number of steps ends at the end of the interval, to the last bit.
#[test]
fn fixed_steps_end_at_the_end() {
    let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 - q[0].cos()).unwrap();
    for n in 1..200 {
        for end in [15.0, 1.0 / 3.0, -7.1] {
            let method = Gauss::stages(2).step(f64::abs(end) / f64::from(n));
            let run = method.integrate(&h, &[1.0], &[0.5], 0.0..=end).unwrap();
            assert_eq!(run.last().0, end, "{n} steps");
        }
    }
}
