//! Steps that are too long for their stages: whether one is halved is told from its energy, whatever the
//! preconditioner, of Gauss as of EQUIP.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss, Method, Preconditioner, Record, Run};
use equip_tests::{distance, double_pendulum};

fn run(
    method: Method,
    preconditioner: Preconditioner,
    (energy, start): (&Hamiltonian, (&[f64], &[f64])),
    (h, end): (f64, f64),
) -> Run<f64> {
    let options = method.step(h).record(Record::Ends);
    let options = options.preconditioner(preconditioner);
    options
        .integrate(energy, start.0, start.1, 0.0..=end)
        .unwrap()
}

fn error(run: &Run<f64>, right: &[f64]) -> f64 {
    let (_, q, p) = run.last();
    distance(&[q, p].concat(), right)
}

/// Eight steps of 1 with 32 stages, that have to be halved twice: errors were 2e-3 with three of the
/// preconditioners and 2e-4 with the fourth. Measured: 3e-12 to 3e-11, with 16 or 17 halvings.
#[test]
fn no_preconditioner_decides_what_a_step_is() {
    let (energy, start) = double_pendulum::<f64>();
    let at = (&energy, (&start.q[..], &start.p[..]));
    let right = run(
        Gauss::stages(16),
        Preconditioner::Identity,
        at,
        (1.0 / 64.0, 8.0),
    );
    let (_, q, p) = right.last();
    let right = [q, p].concat();
    for method in [Gauss::stages(32), Equip::stages(32)] {
        for preconditioner in [
            Preconditioner::Automatic,
            Preconditioner::Identity,
            Preconditioner::Frozen,
            Preconditioner::Full,
        ] {
            let run = run(method, preconditioner, at, (1.0, 8.0));
            let halvings = run.certificate().counts.halvings;
            let error = error(&run, &right);
            println!("{method}, {preconditioner:?}: {error:.1e}, {halvings} halvings");
            assert!(error < 1e-10, "{method}, {preconditioner:?}: {error:e}");
            assert!((14..=20).contains(&halvings), "{halvings}");
        }
    }
}

/// Three bodies that fall together (Burrau 1913): in one of 180 000 steps two of them are so near that
/// Newton's method finds them on the wrong sides of each other, and 4e4 more in H = -12.8.
#[test]
fn bodies_do_not_pass_through_each_other() {
    let scene = equip_scenes::find("pythagorean").unwrap();
    let scene = scene.instance(&[]).unwrap();
    let (q, p) = scene.initial::<f64>();
    let at = (scene.hamiltonian(), (&q[..], &p[..]));
    let steps = (16.0 / 180_000.0, 16.0);
    let plain = run(Equip::stages(8), Preconditioner::Identity, at, steps);
    let (_, q, p) = plain.last();
    let right = [q, p].concat();
    let found = run(Equip::stages(8), Preconditioner::Automatic, at, steps);
    let error = error(&found, &right);
    let energy = found.certificate().energy.as_ref().unwrap().max;
    println!("{error:.1e}, energy {energy:.1e}");
    assert!(error < 1e-3 && energy < 1e-7, "{error:e}, {energy:e}");
    let gauss = run(Gauss::stages(8), Preconditioner::Automatic, at, steps);
    let energy = gauss.certificate().energy.as_ref().unwrap().max;
    // What plain iteration has.
    assert!(energy < 60.0, "{energy}");
}

/// A step over which H changes by rounding alone is no such step, however little it exchanges: a free body,
/// one at rest, and one whose energy is a difference of large numbers.
#[test]
fn rounding_is_no_reason_to_halve() {
    let free = Hamiltonian::new(1, |_, p| (1.0 + p[0] * p[0] * p[0] * p[0]).sqrt()).unwrap();
    let rest = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let large = Hamiltonian::new(1, |q, p| (1e12 + 0.5 * p[0] * p[0] - q[0].cos()) - 1e12).unwrap();
    for (energy, q, p) in [(&free, 0.3, 0.7), (&rest, 0.0, 0.0), (&large, 0.1, 0.01)] {
        for method in [Gauss::stages(1), Gauss::stages(6), Equip::stages(6)] {
            let at = (energy, (&[q][..], &[p][..]));
            let run = run(method, Preconditioner::Automatic, at, (0.1, 50.0));
            assert_eq!(run.certificate().counts.halvings, 0, "{method}");
        }
    }
}

/// H with a force that jumps, which no trace of H tells: the steps over the jump are as short as they may
/// be, and the run continues.
#[test]
fn a_force_that_jumps_is_stepped_over() {
    let energy = |q: &[f64], p: &[f64]| 0.5 * p[0] * p[0] + q[0].abs();
    let gradient = |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
        (dq[0], dp[0]) = (q[0].signum(), p[0]);
    };
    let tent = Hamiltonian::external(1, f64::EPSILON, energy, gradient).unwrap();
    for method in [Gauss::stages(8), Equip::stages(8)] {
        let at = (&tent, (&[1.0][..], &[0.0][..]));
        let run = run(method, Preconditioner::Automatic, at, (0.1, 20.0));
        let worst = run.certificate().energy.as_ref().unwrap().max;
        println!("{method}: {worst:.1e}");
        assert!(worst < 1e-3, "{method}: {worst}");
        let options = method.tolerance(1e-6).record(Record::Ends);
        assert!(options.integrate(&tent, &[1.0], &[0.0], 0.0..=20.0).is_ok());
    }
}
