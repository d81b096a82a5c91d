//! Trajectories of EQUIP beside those of Gauss on the same steps, in the mean over random starts, and
//! reversed.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_scenes::find;
use equip_tests::{
    Limits, Misses, Reference, Seeded, Start, Trial, Who, distance, geometric_mean, henon_heiles,
};

type Parameters<'a> = &'a [(&'a str, &'a str)];

/// Two stages have one α: trajectories are not to be the worse for it.
#[test]
#[ignore = "known deficit: error 4.3 times that of Gauss (double pendulum, s = 2), 2 allowed"]
fn two_stages() {
    let mut misses = Misses::default();
    let few: [(&str, Parameters<'_>, f64, u64, f64); 4] = [
        ("pendulum", &[], 0.1, 500, 0.3),
        ("kepler", &[("e", "0.3")], 0.05, 400, 0.02),
        ("double-pendulum", &[], 0.01, 400, 0.3),
        (
            "fput-beta",
            &[("n", "4"), ("amplitude", "2")],
            0.1,
            300,
            0.5,
        ),
    ];
    for (name, parameters, h, steps, spread) in few {
        let instance = find(name).unwrap().instance(parameters).unwrap();
        let scene = instance.hamiltonian();
        let (q, p) = instance.initial::<f64>();
        let mut rng = Seeded::new(2);
        let starts = (0..16).map(|_| {
            let mut near = |x: &[f64]| -> Vec<f64> {
                x.iter()
                    .map(|x| x + spread * rng.between(-1.0, 1.0))
                    .collect()
            };
            Start {
                q: near(&q),
                p: near(&p),
            }
        });
        mean_over(
            &mut misses,
            name,
            (scene, 2),
            (h, steps),
            starts.collect(),
            2.0,
        );
    }
    let (henon_heiles, _) = henon_heiles(0.125_f64, "0", "0");
    let mut rng = Seeded::new(1);
    let starts = (0..20).map(|_| {
        let (q2, p2) = (rng.between(-0.3, 0.5), rng.between(-0.3, 0.3));
        let kinetic = 0.25 - q2 * q2 + 2.0 * q2.powi(3) / 3.0 - p2 * p2;
        Start {
            q: vec![0.0, q2],
            p: vec![kinetic.max(0.0).sqrt(), p2],
        }
    });
    let case = (&henon_heiles, 2);
    mean_over(
        &mut misses,
        "henon-heiles",
        case,
        (0.125, 800),
        starts.collect(),
        2.0,
    );
    misses.end();
}

/// Wants the geometric mean of error over Gauss's to be `most` at most.
fn mean_over(
    misses: &mut Misses,
    what: &str,
    (hamiltonian, s): (&Hamiltonian, usize),
    (h, steps): (f64, u64),
    starts: Vec<Start<f64>>,
    most: f64,
) {
    let any = Limits {
        error: f64::INFINITY,
        work: f64::INFINITY,
        round_off: 1e-12,
    };
    let ratios: Vec<f64> = starts
        .iter()
        .map(|start| {
            let y = start.state();
            let at_end = Reference::at(hamiltonian, &y, h * steps as f64);
            let pair = Trial::new(hamiltonian, start, s).both(h, steps);
            misses.beside_gauss(what, &pair, (&y, &at_end), any)
        })
        .collect();
    let worst = ratios.iter().fold(0.0_f64, |a, &b| a.max(b));
    println!("{what}, s = {s}, h = {h}: worst {worst:.2}");
    let what = format!(
        "{what}, s = {s}, {steps} steps, mean over {} starts",
        ratios.len()
    );
    misses.most(&what, geometric_mean(&ratios), most);
}

fn rotors(n: usize) -> Hamiltonian {
    Hamiltonian::new(n, |q, p| {
        (0..n)
            .map(|i| 0.5 * p[i] * p[i] + 1.0 - (q[(i + 1) % n] - q[i]).cos())
            .sum::<Var>()
    })
    .unwrap()
}

fn rotors_start(n: usize, seed: u64) -> Start<f64> {
    let mut rng = Seeded::new(seed);
    let q = (0..n).map(|_| rng.between(0.0, 3.0)).collect();
    let p = (0..n).map(|_| rng.between(-2.0, 2.0)).collect();
    Start { q, p }
}

/// Three α's span three directions of 32.
#[test]
fn sixteen_rotors() {
    let mut misses = Misses::default();
    let ring = rotors(16);
    for (s, steps) in [(4, 60), (4, 120), (6, 40)] {
        let starts = (1..=12).map(|seed| rotors_start(16, seed)).collect();
        let h = 10.0 / steps as f64;
        mean_over(
            &mut misses,
            "16 rotors",
            (&ring, s),
            (h, steps),
            starts,
            3.0,
        );
    }
    misses.end();
}

/// A run with its momenta reversed comes back to its start.
#[test]
#[ignore = "known deficit: 1.5e-7 (fpu, s = 6) and 5.7e-10 (rotors) there and back, 1e-11 allowed"]
fn there_and_back() {
    let mut misses = Misses::default();
    let ring = rotors(11);
    let fpu = find("fpu").unwrap().instance(&[]).unwrap();
    let (q, p) = fpu.initial::<f64>();
    let cases = [
        ("11 rotors", &ring, rotors_start(11, 1), 4, 0.3, 100),
        ("fpu", fpu.hamiltonian(), Start { q, p }, 6, 0.05, 300),
    ];
    for (what, hamiltonian, start, s, h, steps) in cases {
        let run = |start: &Start<f64>| {
            Trial::new(hamiltonian, start, s).steps(Who::Equip, (h, steps), |_, _, _| ())
        };
        let turned = |y: &[f64]| {
            let (q, p) = y.split_at(y.len() / 2);
            Start {
                q: q.to_vec(),
                p: p.iter().map(|p| -p).collect(),
            }
        };
        let back = run(&start).and_then(|made| run(&turned(&made.state)));
        let off = back.map_or(f64::NAN, |made| {
            distance(&turned(&made.state).state(), &start.state())
        });
        misses.most(&format!("{what}, s = {s}, there and back"), off, 1e-11);
    }
    misses.end();
}
