//! Random energies of min, max, |x|, clamp, selections and tables: no run by tolerance hangs, panics or ends
//! where fixed steps go on. Random crossings: all are found.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::kinks::{apart, end, wedge};
use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Equip, Method};
use equip_tables::Table;
use equip_tests::{Misses, Seeded};

/// c₀ + Σ c_i x_i.
fn linear(rng: &mut Seeded, x: &[Var]) -> Var {
    let constant = rng.between(-0.7, 0.7);
    let terms = x.iter().map(|&x| rng.between(-1.0, 1.0) * x);
    terms.sum::<Var>() + constant
}

/// Twelve random values between −4 and 4.
fn table(rng: &mut Seeded) -> Table {
    let x: Vec<f64> = (0..12).map(|i| -4.0 + 8.0 / 11.0 * f64::from(i)).collect();
    let y: Vec<f64> = x.iter().map(|_| rng.between(-0.5, 0.5)).collect();
    Table::natural(&x, &y).unwrap()
}

/// A term that bends, or jumps; once in twelve times its value jumps.
fn term(rng: &mut Seeded, q: &[Var], p: &[Var]) -> Var {
    let (x, y) = (linear(rng, q), linear(rng, q));
    match rng.below(12) {
        0 => x.abs(),
        1 => x.max(y),
        2 => x.min(y),
        3 => x.clamp(-0.4, 0.3),
        4 => x.max(0).powi(2),
        5 => x.abs().powi(3),
        6 => x.select(x * x * y, x * y),
        7 => table(rng).at(x),
        8 => 0.3 * x.clamp(-1, 1) * p[rng.below(p.len())],
        9 => (x.abs() - 0.5).abs(),
        10 => x.max(y).min(0.2) + x.min(y.abs()),
        _ => {
            let jump = rng.between(-0.2, 0.2);
            y.select(x * 0.0 + jump, x * 0.0)
        }
    }
}

/// H with its start.
fn draw(rng: &mut Seeded) -> (Hamiltonian, Vec<f64>) {
    let m = 1 + rng.below(3);
    let energy = Hamiltonian::new(m, |q, p| {
        let mut h: Var = p.iter().map(|&p| 0.5 * p * p).sum();
        // Bounded from below.
        let wells = q
            .iter()
            .map(|&q| rng.between(0.2, 1.0) * q * q + 0.2 * q.powi(4));
        h += wells.sum::<Var>();
        for _ in 0..1 + rng.below(4) {
            h += rng.between(-1.0, 1.0) * term(rng, q, p);
        }
        h
    });
    let zeros = rng.once_in(4);
    let mut number = || {
        let x = rng.between(-1.5, 1.5);
        if zeros && rng.once_in(2) { 0.0 } else { x }
    };
    let start = (0..2 * m).map(|_| number()).collect();
    (energy.unwrap(), start)
}

/// Each of `count` by a tolerance, and by fixed steps where that ends early.
fn random_energies(count: u64) {
    let mut wrong = Vec::new();
    let (mut steps, mut crossed, mut most) = (0, 0, 0);
    for seed in 0..count {
        let mut rng = Seeded::new(seed);
        let (energy, start) = draw(&mut rng);
        let (q, p) = start.split_at(start.len() / 2);
        let method: Method = Equip::stages(3 + rng.below(4));
        let tolerance = rng.power_of_ten(-11.0, -5.0);
        let options = method.tolerance(tolerance).max_steps(20_000);
        match options.integrate(&energy, q, p, 0.0..=10.0) {
            Ok(run) => {
                let certificate = run.certificate();
                steps += certificate.counts.steps;
                most = most.max(certificate.counts.steps);
                crossed += certificate.discontinuities_crossed;
            }
            Err(failure) => {
                let fixed = method.step(0.01).integrate(&energy, q, p, 0.0..=10.0);
                let line = format!("seed {seed}, {tolerance:e}: {}", failure.error);
                println!("{line}; fixed steps: {}", fixed.is_ok());
                if fixed.is_ok() {
                    wrong.push(line);
                }
            }
        }
    }
    println!("{count} energies: {steps} steps, {most} at most, {crossed} switches crossed");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// Runs at 1e-7 and at 1e-11 end in the same state, to tolerances of its size. Measured: 13 at most.
#[test]
fn two_tolerances_agree() {
    let mut misses = Misses::default();
    for seed in 0..200 {
        let mut rng = Seeded::new(seed);
        let (energy, start) = draw(&mut rng);
        let (q, p) = start.split_at(start.len() / 2);
        let method = Equip::stages(3 + rng.below(6));
        let [coarse, fine] = [1e-7, 1e-11].map(|tolerance| {
            let run = method
                .tolerance(tolerance)
                .integrate(&energy, q, p, 0.0..=10.0);
            end(&run.unwrap())
        });
        let size = fine.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        let error = apart(&coarse, &fine) / (1e-7 * size);
        misses.most(&format!("seed {seed}"), error, 100.0);
    }
    misses.end();
}

#[test]
fn three_hundred_random_energies() {
    random_energies(300);
}

#[test]
#[ignore = "long: run with cargo test -p equip-tests --release --test all kinks_random:: -- --ignored"]
fn two_thousand_random_energies() {
    random_energies(2000);
}

/// Balls on wedges of random slopes, in `m` degrees of freedom: how many switches they cross is known.
/// Measured: all of 10⁵, errors up to 0.11 tolerances.
fn random_crossings(crossings: u64, m: usize) {
    let (mut rng, mut misses) = (Seeded::new(5), Misses::default());
    let mut passed = 0;
    while passed < crossings {
        let balls: Vec<[f64; 3]> = (0..m)
            .map(|_| {
                [
                    rng.power_of_ten(-1.0, 1.0),
                    rng.power_of_ten(-2.0, 0.5),
                    rng.between(-1.0, 1.0),
                ]
            })
            .collect();
        let slopes: Vec<f64> = balls.iter().map(|ball| ball[0]).collect();
        let energy = Hamiltonian::new(m, |q, p| {
            let kinetic: Var = p.iter().map(|&p| 0.5 * p * p).sum();
            let wedges = q.iter().zip(&slopes).map(|(q, &w)| w * q.abs());
            kinetic + wedges.sum::<Var>()
        })
        .unwrap();
        let [q, p] = [1, 2].map(|i| balls.iter().map(|ball| ball[i]).collect::<Vec<_>>());
        let time = 40.0;
        let options = Equip::stages(4).tolerance(1e-10);
        let run = options.integrate(&energy, &q, &p, 0.0..=time).unwrap();
        let (found, right) = (end(&run), balls.iter().map(|&ball| wedge(ball, time)));
        let expected: u64 = right.clone().map(|(_, count)| count).sum();
        let what = format!("{expected} crossings");
        assert_eq!(
            run.certificate().discontinuities_crossed,
            expected,
            "{balls:?}"
        );
        for (i, (state, _)) in right.enumerate() {
            let error = apart(&[found[i], found[m + i]], &state) / 1e-10;
            misses.most(&what, error, 1.0);
        }
        passed += expected;
    }
    misses.end();
}

#[test]
fn a_thousand_random_crossings_are_all_found() {
    random_crossings(1000, 3);
}

#[test]
#[ignore = "long: run with cargo test -p equip-tests --release --test all kinks_random:: -- --ignored"]
fn a_hundred_thousand_random_crossings_are_all_found() {
    random_crossings(100_000, 3);
}

/// Two oscillators whose force jumps or bends, or whose formula changes, on a random line, by fixed steps of
/// random size: on which side of the line each step ends says how often it crosses, but for pairs.
fn crossings_by_fixed_steps(runs: usize) {
    let mut rng = Seeded::new(7);
    let mut all = 0;
    for kind in (0..4).cycle().take(runs) {
        let [stiff, soft] = [rng.between(0.1, 2.0), rng.between(0.5, 1.5)];
        let [slope, place] = [rng.between(-1.0, 1.0), rng.between(-0.3, 0.3)];
        let energy = Hamiltonian::new(2, |q, p| {
            let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
            let smooth = 0.5 * (soft * q[0] * q[0] + q[1] * q[1]);
            let side = q[0] + slope * q[1] - place;
            kinetic
                + smooth
                + stiff
                    * match kind {
                        0 => side.abs(),
                        1 => side.max(0) * side,
                        2 => side.max(0).powi(3),
                        _ => side.select(side * (1.0 + 0.3 * q[1]), 0.2 * side * q[0]),
                    }
        })
        .unwrap();
        let [q, p] = [0, 1].map(|_| [rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)]);
        let method: Method = Equip::stages(3 + rng.below(6));
        let step = rng.between(0.02, 0.3);
        let is_beyond = |q: &[f64]| q[0] + slope * q[1] > place;
        let mut run = method.step(step).start(&energy, &q, &p, 0.0).unwrap();
        let (mut was_beyond, mut count) = (is_beyond(&q), 0);
        while run.time() < 300.0 {
            let now = is_beyond(run.advance().unwrap().q);
            let crossed = run.certificate().discontinuities_crossed;
            let is_odd = (crossed - count) % 2 == 1;
            assert_eq!(is_odd, now != was_beyond, "{kind}, {method}, {step}");
            (was_beyond, count) = (now, crossed);
        }
        all += count;
    }
    println!("{all} crossings");
    assert!(all > 100 * runs as u64);
}

#[test]
fn two_thousand_crossings_by_fixed_steps() {
    crossings_by_fixed_steps(20);
}

#[test]
#[ignore = "long: run with cargo test -p equip-tests --release --test all kinks_random:: -- --ignored"]
fn a_hundred_thousand_crossings_by_fixed_steps() {
    crossings_by_fixed_steps(700);
}
