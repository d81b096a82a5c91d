//! Small inputs from outside, each judged beside Gauss on the same steps: as right, as cheap, and no error exit
//! where Gauss has none. Right values: Gauss with 16 stages and small steps by plain iteration.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_scenes::find;
use equip_tests::{Limits, Misses, Pair, Reference, Seeded, Trial, Who, geometric_mean, rate};

type Start = (Vec<f64>, Vec<f64>);

fn trial<'a>(hamiltonian: &'a Hamiltonian, (q, p): &'a Start, stages: usize) -> Trial<'a, f64> {
    Trial {
        hamiltonian,
        q,
        p,
        stages,
    }
}

fn on_steps(trial: Trial<'_, f64>, h: f64, steps: u64) -> Pair {
    [Who::Equip, Who::Gauss].map(|who| trial.steps(who, (h, steps), |_, _, _| ()))
}

fn by_tolerance(trial: Trial<'_, f64>, tolerance: f64, end: f64) -> Pair {
    [Who::Equip, Who::Gauss].map(|who| trial.tolerance(who, tolerance, end))
}

/// The state at `end`, in doubles: its error is that of rounding.
fn truth(hamiltonian: &Hamiltonian, start: &Start, end: f64) -> Reference {
    let y = start_state(start);
    let wanted = (rate(hamiltonian, &y), 1e-9);
    Reference::solve::<f64>(hamiltonian, &y, &[end], wanted).unwrap()
}

fn start_state((q, p): &Start) -> Vec<f64> {
    [q.as_slice(), p].concat()
}

/// A spring of stiffness 10⁶, resolved: one step that moves the end point by 3e-6 for a defect of round-off costs
/// seven digits of the run.
#[test]
fn a_resolved_stiff_spring() {
    let mut misses = Misses::default();
    let k = 1e6;
    let spring = Hamiltonian::new(2, |q, p| {
        let stretch = (q[0] * q[0] + q[1] * q[1]).sqrt() - 1.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 0.5 * k * stretch * stretch + q[1]
    })
    .unwrap();
    let starts = [
        ("at rest", (vec![1.0, 0.0], vec![0.0, 0.0])),
        ("swinging", (vec![1.001, 0.0], vec![0.2, 0.5])),
    ];
    let end = 10.0;
    for (name, start) in &starts {
        let y = start_state(start);
        let at_end = truth(&spring, start, end);
        for s in [6, 8] {
            let trial = trial(&spring, start, s);
            let what = format!("spring {name}, s = {s}, tolerance 1e-12");
            let pair = by_tolerance(trial, 1e-12, end);
            misses.beside_gauss(&what, &pair, (&y, &at_end), Limits::ORDINARY);
            for angle in [0.42, 0.55] {
                let steps = 4000;
                let h = angle / k.sqrt();
                let at_end = truth(&spring, start, h * steps as f64);
                let what = format!("spring {name}, s = {s}, h omega = {angle}");
                let pair = on_steps(trial, h, steps);
                misses.beside_gauss(&what, &pair, (&y, &at_end), Limits::ORDINARY);
            }
        }
    }
    misses.end();
}

/// Two ways to write one energy: the one that cancels may not cost more.
struct Twins<'a> {
    cancelling: &'a Hamiltonian,
    plain: &'a Hamiltonian,
    start: &'a Start,
}

impl Twins<'_> {
    fn compare(&self, misses: &mut Misses, what: &str, s: usize, h: f64, steps: u64) {
        let run = |hamiltonian| {
            trial(hamiltonian, self.start, s).steps(Who::Equip, (h, steps), |_, _, _| ())
        };
        let runs = [run(self.cancelling), run(self.plain)];
        Self::judge(misses, &format!("{what}, s = {s}, h = {h}"), &runs);
    }

    fn compare_by_tolerance(&self, misses: &mut Misses, what: &str, tolerance: f64, end: f64) {
        let run =
            |hamiltonian| trial(hamiltonian, self.start, 8).tolerance(Who::Equip, tolerance, end);
        let runs = [run(self.cancelling), run(self.plain)];
        let what = format!("{what}, tolerance {tolerance:e}");
        Self::judge(misses, &what, &runs);
        if let [Ok(found), Ok(plain)] = &runs {
            let steps = found.steps as f64 / plain.steps as f64;
            misses.most(&format!("{what}, steps"), steps, 1.1);
        }
    }

    fn judge(misses: &mut Misses, what: &str, runs: &Pair) {
        match runs {
            [Ok(found), Ok(plain)] => {
                let work = found.work() / plain.work();
                misses.most(&format!("{what}, work over the plain form's"), work, 1.5);
                misses.most(&format!("{what}, carried"), found.carried as f64, 0.0);
            }
            [Err(error), _] => misses.most(&format!("{what}: {error}"), f64::NAN, 0.0),
            [_, Err(error)] => misses.most(&format!("{what}, plain: {error}"), f64::NAN, 0.0),
        }
    }
}

/// 1 − cos q near q = 0, where 1 is all that is left of either.
#[test]
fn small_swings_written_with_a_difference() {
    let mut misses = Misses::default();
    let cancelling = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0].cos())).unwrap();
    let plain = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    for q in [1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5] {
        let start = (vec![q], vec![0.0]);
        let twins = Twins {
            cancelling: &cancelling,
            plain: &plain,
            start: &start,
        };
        let what = format!("q = {q:e}");
        twins.compare(&mut misses, &what, 4, 0.25, 400);
        twins.compare_by_tolerance(&mut misses, &what, 1e-10, 100.0);
    }
    misses.end();
}

/// (C + H) − C for large C: the rounding of C is no defect of H.
#[test]
fn a_constant_added_and_taken_away() {
    let mut misses = Misses::default();
    let written = |shift: f64| {
        Hamiltonian::new(2, move |q, p| {
            let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
            let quadratic = 0.5 * (q[0] * q[0] + q[1] * q[1]);
            let h = kinetic + quadratic + q[0] * q[0] * q[1] - q[1].powi(3) / 3.0;
            (shift + h) - shift
        })
        .unwrap()
    };
    let plain = written(0.0);
    let start = (vec![0.0, 0.3], vec![0.35, 0.1]);
    for shift in [100.0, 1e4] {
        let twins = Twins {
            cancelling: &written(shift),
            plain: &plain,
            start: &start,
        };
        let what = format!("shift {shift}");
        twins.compare(&mut misses, &what, 4, 0.25, 400);
        twins.compare(&mut misses, &what, 6, 0.5, 200);
        twins.compare_by_tolerance(&mut misses, &what, 1e-10, 100.0);
    }
    misses.end();
}

/// A ring with the potential e^d − d − 1 of its differences, in small motion.
#[test]
fn a_ring_of_exponentials() {
    let mut misses = Misses::default();
    let n = 8;
    let ring = Hamiltonian::new(n, |q, p| {
        (0..n)
            .map(|i| {
                let d = q[(i + 1) % n] - q[i];
                0.5 * p[i] * p[i] + d.exp() - d - 1.0
            })
            .sum::<Var>()
    })
    .unwrap();
    for amplitude in [0.1, 0.01] {
        let mut rng = Seeded::new(1);
        let mut draw = || (0..n).map(|_| rng.between(-amplitude, amplitude)).collect();
        let start: Start = (draw(), draw());
        let y = start_state(&start);
        for (s, h) in [(4, 0.25), (6, 0.4)] {
            let steps = 400;
            let at_end = truth(&ring, &start, h * steps as f64);
            let pair = on_steps(trial(&ring, &start, s), h, steps);
            let what = format!("ring, amplitude {amplitude}, s = {s}");
            misses.beside_gauss(&what, &pair, (&y, &at_end), Limits::ORDINARY);
        }
    }
    misses.end();
}

/// Kepler's problem with c√(c² + p²) − c², which cancels, and with p²/(1 + √(1 + p²/c²)), which does not.
#[test]
fn a_rest_energy_taken_away() {
    let mut misses = Misses::default();
    for c in [3.0, 10.0, 137.0] {
        let square = |p: &[Var]| p[0] * p[0] + p[1] * p[1];
        let potential = |q: &[Var]| 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt();
        let cancelling = Hamiltonian::new(2, |q, p| {
            c * (c * c + square(p)).sqrt() - c * c - potential(q)
        })
        .unwrap();
        let plain = Hamiltonian::new(2, |q, p| {
            square(p) / (1.0 + (1.0 + square(p) / (c * c)).sqrt()) - potential(q)
        })
        .unwrap();
        let start = (vec![0.5, 0.0], vec![0.0, 3.0_f64.sqrt()]);
        let twins = Twins {
            cancelling: &cancelling,
            plain: &plain,
            start: &start,
        };
        let what = format!("c = {c}");
        twins.compare(&mut misses, &what, 8, 0.02, 5000);
        let run = trial(&cancelling, &start, 8).steps(Who::Equip, (0.02, 5000), |_, _, _| ());
        let hessians = run.map_or(f64::NAN, |made| made.hessians as f64);
        misses.most(&format!("{what}, Hessians"), hessians, 0.0);
        for tolerance in [1e-10, 1e-13] {
            twins.compare_by_tolerance(&mut misses, &what, tolerance, 100.0);
        }
    }
    misses.end();
}

/// A Schwarzschild orbit at r = 100, energies with and without the rest mass.
#[test]
fn a_rest_mass_taken_away() {
    let mut misses = Misses::default();
    let written = |rest: f64| {
        Hamiltonian::new(2, move |q, p| {
            let f = 1.0 - 2.0 / q[0];
            (f * (1.0 + f * p[0] * p[0] + (p[1] / q[0]).powi(2))).sqrt() - rest
        })
        .unwrap()
    };
    let (cancelling, plain) = (written(1.0), written(0.0));
    for l in [9.0, 11.0] {
        let start = (vec![100.0, 0.0], vec![0.0, l]);
        let twins = Twins {
            cancelling: &cancelling,
            plain: &plain,
            start: &start,
        };
        let what = format!("L = {l}");
        twins.compare(&mut misses, &what, 4, 60.0, 1000);
        twins.compare(&mut misses, &what, 8, 200.0, 400);
        twins.compare_by_tolerance(&mut misses, &what, 1e-11, 1e5);
    }
    misses.end();
}

/// Two stages have one α: trajectories are not to be the worse for it.
#[test]
fn two_stages() {
    let mut misses = Misses::default();
    let few: [(&str, &[(&str, &str)], f64, u64, f64); 4] = [
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
            (near(&q), near(&p))
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
    let (henon_heiles, _) = equip_tests::henon_heiles(0.125_f64, "0", "0");
    let mut rng = Seeded::new(1);
    let starts = (0..20).map(|_| {
        let (q2, p2) = (rng.between(-0.3, 0.5), rng.between(-0.3, 0.3));
        let kinetic = 0.25 - q2 * q2 + 2.0 * q2.powi(3) / 3.0 - p2 * p2;
        (vec![0.0, q2], vec![kinetic.max(0.0).sqrt(), p2])
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
    starts: Vec<Start>,
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
            let at_end = truth(hamiltonian, start, h * steps as f64);
            let pair = on_steps(trial(hamiltonian, start, s), h, steps);
            misses.beside_gauss(what, &pair, (&start_state(start), &at_end), any)
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

fn rotors_start(n: usize, seed: u64) -> Start {
    let mut rng = Seeded::new(seed);
    let q = (0..n).map(|_| rng.between(0.0, 3.0)).collect();
    (q, (0..n).map(|_| rng.between(-2.0, 2.0)).collect())
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
fn there_and_back() {
    let mut misses = Misses::default();
    let ring = rotors(11);
    let fpu = find("fpu").unwrap().instance(&[]).unwrap();
    let cases = [
        ("11 rotors", &ring, rotors_start(11, 1), 4, 0.3, 100),
        ("fpu", fpu.hamiltonian(), fpu.initial::<f64>(), 6, 0.05, 300),
    ];
    for (what, hamiltonian, start, s, h, steps) in cases {
        let flip = |y: &[f64]| -> Start {
            let (q, p) = y.split_at(y.len() / 2);
            (q.to_vec(), p.iter().map(|p| -p).collect())
        };
        let there = trial(hamiltonian, &start, s).steps(Who::Equip, (h, steps), |_, _, _| ());
        let back = there.and_then(|made| {
            let turned = flip(&made.state);
            trial(hamiltonian, &turned, s).steps(Who::Equip, (h, steps), |_, _, _| ())
        });
        let off = back.map_or(f64::NAN, |made| {
            equip_tests::distance(&start_state(&flip(&made.state)), &start_state(&start))
        });
        misses.most(&format!("{what}, s = {s}, there and back"), off, 1e-11);
    }
    misses.end();
}
