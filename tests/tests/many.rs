//! Many components, as they come: trajectories as near as those of Gauss, and preconditioners only where
//! motion is too fast for fixed-point iteration.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Counts, Equip, Gauss, Method, Outcome, Preconditioner, Record, Run};
use equip_scalar::Constant;
use equip_scenes::energies::{FputBeta, Model as _};
use equip_tests::{Seeded, distance};

const MASSES: usize = 64;
const BETA: f64 = 0.3;
const END: f64 = 20.0;

fn start() -> (Vec<f64>, Vec<f64>) {
    start_of(MASSES)
}

/// Rest positions and momenta in [−1, 1): all modes move.
fn start_of(masses: usize) -> (Vec<f64>, Vec<f64>) {
    let mut rng = Seeded::new(1);
    let momenta = (0..masses).map(|_| rng.between(-1.0, 1.0));
    (vec![0.0; masses], momenta.collect())
}

fn chain(unit: f64) -> Hamiltonian {
    chain_of(MASSES, unit)
}

/// The chain in lengths of `unit` and energies of its square.
fn chain_of(masses: usize, unit: f64) -> Hamiltonian {
    let chain = FputBeta {
        n: masses,
        beta: Constant::from(BETA),
        amplitude: Constant::from(1.0),
    };
    let scaled = |x: &[Var]| x.iter().map(|&x| x / unit).collect::<Vec<_>>();
    let energy = |q: &[Var], p: &[Var]| chain.energy(&scaled(q), &scaled(p)) * (unit * unit);
    Hamiltonian::new(masses, energy).unwrap()
}

fn made(
    energy: &Hamiltonian,
    (q, p): &(Vec<f64>, Vec<f64>),
    method: Method,
    (h, end): (f64, f64),
    solver: Preconditioner,
) -> Run<f64> {
    let options = method.step(h).preconditioner(solver).record(Record::Ends);
    options.integrate(energy, q, p, 0.0..=end).unwrap()
}

fn state(run: &Run<f64>) -> Vec<f64> {
    let (_, q, p) = run.last();
    [q, p].concat()
}

fn counts(run: &Run<f64>) -> &Counts {
    &run.certificate().counts
}

/// Suzuki's composition of order 6 (Phys. Lett. A 146 (1990) 319) of leapfrogs, the force by hand.
fn composed(steps: usize) -> Vec<f64> {
    let share = |order: i32| 1.0 / (4.0 - 4f64.powf(1.0 / f64::from(order + 1)));
    let spread = |lengths: &[f64], order: i32| -> Vec<f64> {
        let outer = share(order);
        let parts = [outer, outer, 1.0 - 4.0 * outer, outer, outer];
        let scaled = parts
            .iter()
            .map(|part| lengths.iter().map(move |h| h * part));
        scaled.flatten().collect()
    };
    let lengths = spread(&spread(&[END / steps as f64], 2), 4);
    let (mut q, mut p) = start();
    let kick = |q: &[f64], p: &mut [f64], h: f64| {
        let at = |i: usize| if i == 0 || i > MASSES { 0.0 } else { q[i - 1] };
        let pull = |i: usize| {
            let d = at(i + 1) - at(i);
            d + BETA * d * d * d
        };
        for (i, p) in p.iter_mut().enumerate() {
            *p += h * (pull(i + 1) - pull(i));
        }
    };
    for _ in 0..steps {
        for &h in &lengths {
            kick(&q, &mut p, h / 2.0);
            q.iter_mut().zip(&p).for_each(|(q, p)| *q += h * p);
            kick(&q, &mut p, h / 2.0);
        }
    }
    [q, p].concat()
}

#[test]
fn a_chain_is_as_near_as_gauss_for_little_more() {
    let (energy, start) = (chain(1.0), start());
    let (exact, rough) = (composed(4000), composed(2000));
    let trusted = distance(&exact, &rough);
    println!("composition: {trusted:.1e}");
    // Measured: 2.2, 1.2 and 1.8 times as far off, 1.69, 1.75 and 1.55 times the gradients.
    for (s, h, off, more) in [(4, 0.2, 2.5, 2.1), (6, 0.4, 2.5, 2.1), (8, 0.8, 2.5, 2.1)] {
        let step = (h, END);
        let ours = made(
            &energy,
            &start,
            Equip::stages(s),
            step,
            Preconditioner::default(),
        );
        let gauss = made(
            &energy,
            &start,
            Gauss::stages(s),
            step,
            Preconditioner::Identity,
        );
        let [error, least] = [&ours, &gauss].map(|run| distance(&state(run), &exact));
        let (c, work) = (counts(&ours), counts(&gauss).gradients);
        let work = c.gradients as f64 / work as f64;
        println!(
            "s = {s}, h = {h}: {error:.1e}, Gauss {least:.1e}, {work:.2} × the gradients, {c:?}"
        );
        assert!(least > 20.0 * trusted && error < off * least, "s = {s}");
        assert!(work < more, "s = {s}: {work}");
        assert!(
            2 * c.outcome(Outcome::Solved) > c.steps,
            "α's are needed here"
        );
        assert_eq!((c.newton_iterations, c.halvings), (0, 0));
        assert!(ours.certificate().energy_in_round_off_levels.unwrap() <= 8.0);
    }
}

/// Twelve masses, with α's on every step.
#[test]
fn twelve_masses_are_as_near_as_gauss() {
    let (energy, start) = (chain_of(12, 1.0), start_of(12));
    let run = |method, h, solver| made(&energy, &start, method, (h, END), solver);
    let exact = state(&run(Gauss::stages(16), 0.25, Preconditioner::Identity));
    let ours = run(Equip::stages(4), 0.2, Preconditioner::default());
    let gauss = run(Gauss::stages(4), 0.2, Preconditioner::Identity);
    let [error, least] = [&ours, &gauss].map(|run| distance(&state(run), &exact));
    let c = counts(&ours);
    println!("{error:.1e}, Gauss {least:.1e}, {c:?}");
    assert!(error < 4.0 * least);
    assert_eq!(c.outcome(Outcome::Solved), c.steps, "α's are needed here");
    assert_eq!((c.preconditioner_changes, c.newton_iterations), (0, 0));
    assert!(ours.certificate().energy_in_round_off_levels.unwrap() <= 8.0);
}

/// A chain in units of 10^±100, whose energies are at 10^±200, and of 1e-20, where positions at rest have no
/// size: the same steps.
#[test]
fn units_do_not_matter() {
    let (q, p) = start();
    let mut plain = None;
    for unit in [1.0, 1e-20, 1e100, 1e-100] {
        let energy = chain(unit);
        let start = (q.clone(), p.iter().map(|p| p * unit).collect());
        for method in [Gauss::stages(4), Equip::stages(4)] {
            let run = made(
                &energy,
                &start,
                method,
                (0.25, 5.0),
                Preconditioner::default(),
            );
            let (c, end) = (counts(&run), state(&run));
            let end: Vec<f64> = end.iter().map(|x| x / unit).collect();
            println!(
                "{unit:e}, {method}: {} iterations, {} halvings",
                c.fixed_point_iterations, c.halvings
            );
            assert_eq!(c.newton_iterations, 0);
            let plain = plain.get_or_insert_with(|| end.clone());
            // Measured: 2.3e-7, errors of the methods; 1e-14 among units.
            assert!(distance(&end, plain) < 1e-6, "{unit:e}, {method}");
        }
    }
}

/// Defects of a few floors that earlier steps have left are not less in halves.
#[test]
fn what_is_left_is_not_halved() {
    let (energy, start) = springs("50");
    let run = made(
        &energy,
        &start,
        Equip::stages(10),
        (0.0625, 10.0),
        Preconditioner::default(),
    );
    let c = counts(&run);
    println!("{c:?}");
    assert_eq!(c.halvings, 0);
    assert!(run.certificate().energy_in_round_off_levels.unwrap() <= 8.0);
}

/// Defects of some 5 floors are worth ten local errors, all of them near round-off: 14 of the 90 steps would
/// be halved.
#[test]
fn steps_near_round_off_are_whole() {
    let (energy, start) = (chain(1.0), start());
    let end = 50.0;
    let run = |method, h| made(&energy, &start, method, (h, end), Preconditioner::default());
    let exact = state(&run(Gauss::stages(16), 0.25));
    let [ours, gauss] = [Equip::stages(8), Gauss::stages(8)].map(|method| run(method, end / 90.0));
    let [error, least] = [&ours, &gauss].map(|run| distance(&state(run), &exact));
    let c = counts(&ours);
    println!(
        "{error:.1e}, Gauss {least:.1e}, {} halvings, {c:?}",
        c.halvings
    );
    assert!(c.outcome(Outcome::Solved) > 10, "α's are needed here");
    assert!(10 * c.halvings < c.steps && c.newton_iterations == 0);
    assert!(error < 3.0 * least && least < 1e-11);
    assert!(ours.certificate().energy_in_round_off_levels.unwrap() <= 8.0);
}

/// Fixed-point iterations do not contract at h = 2.5: halves of the step do, and so do iterations with one
/// ∇²H.
#[test]
fn steps_that_are_too_long_for_fixed_point_iteration() {
    let (energy, start) = (chain(1.0), start());
    let exact = composed(2000);
    let run = |h, solver| made(&energy, &start, Equip::stages(8), (h, END), solver);
    let short = run(1.25, Preconditioner::Identity);
    let expected = distance(&state(&short), &exact);
    let [halved, whole] =
        [Preconditioner::Identity, Preconditioner::Automatic].map(|m| run(2.5, m));
    let found = [&halved, &whole].map(|run| distance(&state(run), &exact));
    let [c, other] = [&halved, &whole].map(|run| *counts(run));
    println!("{found:?}, {expected:.1e}\n{c:?}\n{other:?}");
    assert_eq!(
        (c.halvings, c.preconditioner_changes, c.newton_iterations),
        (c.steps, 0, 0)
    );
    assert!(found[0] < 2.0 * expected);
    assert!(other.preconditioner_changes > 0 && other.newton_iterations > 0);
    assert_eq!(other.halvings, 0);
    for run in [&halved, &whole] {
        assert!(run.certificate().energy_in_round_off_levels.unwrap() <= 8.0);
    }
}

fn springs(omega: &str) -> (Hamiltonian, (Vec<f64>, Vec<f64>)) {
    let scene = equip_scenes::find("fpu").unwrap();
    let scene = scene.instance(&[("m", "16"), ("omega", omega)]).unwrap();
    (scene.hamiltonian().clone(), scene.initial())
}

/// 16 springs of ω = 50 among 32 masses: the energy is not bought with the trajectory.
#[test]
fn many_springs_are_as_near_as_gauss() {
    let (energy, start) = springs("50");
    let end = 10.0;
    let run = |method: Method, h: f64, solver| {
        let run = made(&energy, &start, method, (h, end), solver);
        (state(&run), *counts(&run))
    };
    let (exact, _) = run(Gauss::stages(16), 1.0 / 32.0, Preconditioner::Identity);
    for (s, h) in [(12, 0.1), (16, 0.125)] {
        let (gauss, _) = run(Gauss::stages(s), h, Preconditioner::Identity);
        for m in [
            Preconditioner::Automatic,
            Preconditioner::Identity,
            Preconditioner::Diagonal,
        ] {
            let (ours, c) = run(Equip::stages(s), h, m);
            let [gauss, ours] = [&gauss, &ours].map(|end| distance(end, &exact));
            println!("s = {s}, h = {h}, {m:?}: {ours:.1e}, Gauss {gauss:.1e}, {c:?}");
            assert!(ours < 2.0 * gauss);
        }
    }
}

/// hω = 50: fixed-point iterations are tried now and then and do not contract.
#[test]
fn stiff_motion_is_iterated_with_its_springs() {
    let (energy, start) = springs("500");
    let step = (0.1, 6.0);
    let run = made(
        &energy,
        &start,
        Equip::stages(4),
        step,
        Preconditioner::default(),
    );
    let c = counts(&run);
    println!("{c:?}");
    assert!(c.newton_iterations > 10 * c.fixed_point_iterations);
    assert_eq!(c.halvings, 0);
    assert_eq!(c.outcome(Outcome::Unresolved), c.steps);
}
