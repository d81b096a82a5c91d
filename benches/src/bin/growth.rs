//! How the cost of a step grows: with the size of the system, with the stages, with the precision, and with
//! the way H is given.
//!
//! `cargo run --release -p equip-benches --bin growth`, with `-- --counts` for the counts of work alone,
//! which are equal on every machine and can be compared line by line.
//!
//! Times are medians of rounds in which all rows of a table run in turn. They are wall-clock times of the
//! steps, set-up not counted.

use equip_autodiff::{BuildError, Hamiltonian};
use equip_integrate::{Equip, Gauss, IntegrateError, Method, Preconditioner};
use equip_scalar::{Constant, DoubleDouble, Float};
use equip_scenes::energies::{FputBeta, HenonHeiles, Kepler, Model as _, Ring};
use equip_scenes::find;
use std::collections::BTreeSet;
use std::error::Error;
use std::time::Instant;

/// Rounds of every table.
const ROUNDS: usize = 3;

/// What a run came to.
struct Measured {
    seconds: f64,
    steps: u64,
    gradients: u64,
    iterations: u64,
}

/// A row of a table: its name and the run that makes it.
struct Row<'a> {
    name: String,
    /// Unknowns 2m of the state; what the time is divided by.
    unknowns: usize,
    run: Box<dyn Fn() -> Result<Measured, Box<dyn Error>> + 'a>,
}

/// A method, and how its stages are solved.
type Way = (Method, Preconditioner);

/// EQUIP by fixed-point iteration.
fn equip(stages: usize) -> Way {
    (Equip::stages(stages), Preconditioner::Identity)
}

/// EQUIP with its stages solved as it comes.
fn automatic(stages: usize) -> Way {
    (Equip::stages(stages), Preconditioner::Automatic)
}

/// Gauss by fixed-point iteration.
fn gauss(stages: usize) -> Way {
    (Gauss::stages(stages), Preconditioner::Identity)
}

/// `steps` steps of size h from the start.
fn run<T: Float>(
    system: &Hamiltonian,
    (method, solver): Way,
    h: T,
    steps: u64,
    start: (&[T], &[T]),
) -> Result<Measured, IntegrateError<T>> {
    let options = method.step(h).preconditioner(solver);
    let mut stepper = options.start(system, start.0, start.1, T::int(0))?;
    let begun = Instant::now();
    for _ in 0..steps {
        stepper.advance()?;
    }
    let seconds = begun.elapsed().as_secs_f64();
    let counts = stepper.counts();
    Ok(Measured {
        seconds,
        steps: counts.steps,
        gradients: counts.gradients,
        iterations: counts.newton_iterations + counts.fixed_point_iterations,
    })
}

fn row<'a, T: Float>(
    name: String,
    system: &'a Hamiltonian,
    method: Way,
    h: T,
    steps: u64,
    start: (Vec<T>, Vec<T>),
) -> Row<'a> {
    Row {
        name,
        unknowns: 2 * system.degrees_of_freedom(),
        run: Box::new(move || Ok(run(system, method, h, steps, (&start.0, &start.1))?)),
    }
}

/// Prints a table and returns nanoseconds a step and unknown of its rows.
fn table(
    title: &str,
    rows: &[Row<'_>],
    counts_only: bool,
) -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let rounds = if counts_only { 1 } else { ROUNDS };
    let mut seconds = vec![Vec::new(); rows.len()];
    let mut last = Vec::new();
    for _ in 0..rounds {
        last.clear();
        for (row, seconds) in rows.iter().zip(&mut seconds) {
            let measured = (row.run)().map_err(|e| format!("{title}, {}: {e}", row.name))?;
            seconds.push(measured.seconds / measured.steps.max(1) as f64);
            last.push(measured);
        }
    }
    println!("\n{title}");
    let times = if counts_only {
        String::new()
    } else {
        format!("{:>12}{:>14}", "us a step", "ns / unknown")
    };
    println!("{:<36}{:>14}{:>14}{times}", "", "gradients", "iterations");
    let mut per_unknown = Vec::new();
    for ((row, measured), seconds) in rows.iter().zip(&last).zip(&mut seconds) {
        seconds.sort_by(f64::total_cmp);
        let step = seconds[seconds.len() / 2];
        let nanoseconds = 1e9 * step / row.unknowns as f64;
        per_unknown.push((row.name.clone(), nanoseconds));
        let per_step = |count: u64| count as f64 / measured.steps.max(1) as f64;
        print!(
            "{:<36}{:>14.2}{:>14.2}",
            row.name,
            per_step(measured.gradients),
            per_step(measured.iterations)
        );
        if !counts_only {
            print!("{:>12.2}{nanoseconds:>14.2}", 1e6 * step);
        }
        println!();
    }
    Ok(per_unknown)
}

/// Prints the largest time an unknown over the smallest, for each method: 1 where the cost is linear in n.
fn linearity(per_unknown: &[(String, f64)], counts_only: bool) {
    let methods = per_unknown
        .iter()
        .filter_map(|(name, _)| name.split(", n = ").next());
    let methods: BTreeSet<&str> = methods.filter(|_| !counts_only).collect();
    for method in methods {
        let rows = per_unknown
            .iter()
            .filter(|(name, _)| name.split(", n = ").next() == Some(method));
        let (low, high) = rows.fold((f64::INFINITY, 0.0_f64), |(l, h), (_, ns)| {
            (l.min(*ns), h.max(*ns))
        });
        println!(
            "{method}: most over least time an unknown {:.2}",
            high / low
        );
    }
}

/// FPUT chains, whose cost should grow like n.
fn chains(counts_only: bool) -> Result<(), Box<dyn Error>> {
    let chain = |n: usize| FputBeta {
        n,
        beta: Constant::from(0.3),
        amplitude: Constant::from(10.0),
    };
    let sizes = [16_usize, 64, 256, 1024, 4096, 16384];
    let tapes: Result<Vec<_>, BuildError> = sizes.iter().map(|&n| chain(n).hamiltonian()).collect();
    let tapes = tapes?;
    let mut rows = Vec::new();
    for (&n, tape) in sizes.iter().zip(&tapes) {
        let mode = |i: usize| 10.0 * (std::f64::consts::PI * i as f64 / (n + 1) as f64).sin();
        let start: (Vec<f64>, Vec<f64>) = ((1..=n).map(mode).collect(), vec![0.0; n]);
        let steps = (20_000 / n as u64).clamp(20, 200);
        for (name, method) in [
            ("EQUIP(4)", equip(4)),
            ("EQUIP(4) automatic", automatic(4)),
            ("Gauss(4)", gauss(4)),
        ] {
            rows.push(row(
                format!("{name}, n = {n}"),
                tape,
                method,
                0.2,
                steps,
                start.clone(),
            ));
        }
    }
    let title = "FPUT-β chain of n masses, h = 0.2";
    linearity(&table(title, &rows, counts_only)?, counts_only);
    Ok(())
}

/// Bodies in a ring: n(n − 1)/2 pairs.
fn bodies(counts_only: bool) -> Result<(), Box<dyn Error>> {
    let sizes = [3_usize, 10, 30, 100];
    let mut systems = Vec::new();
    for &n in &sizes {
        let scene = find("n-body")?.instance(&[("n", &n.to_string())])?;
        let h = scene.suggested_step() / 4.0;
        let ring = Ring {
            n,
            disorder: Constant::from(0.01),
            seed: 1,
        };
        systems.push((n, h, scene.initial::<f64>(), ring.hamiltonian()?));
    }
    let mut rows = Vec::new();
    for (n, h, start, system) in &systems {
        for (name, method) in [
            ("EQUIP(4)", equip(4)),
            ("EQUIP(4) automatic", automatic(4)),
            ("Gauss(4)", gauss(4)),
        ] {
            rows.push(row(
                format!("{name}, n = {n}"),
                system,
                method,
                *h,
                10,
                start.clone(),
            ));
        }
    }
    table("n bodies in a ring", &rows, counts_only)?;
    Ok(())
}

/// Stages and precision on two small systems.
fn stages(counts_only: bool) -> Result<(), Box<dyn Error>> {
    let kepler = Kepler {
        e: Constant::from(0.6),
        mu: Constant::from(1.0),
    }
    .hamiltonian()?;
    let henon = HenonHeiles {
        energy: Constant::from(0.125),
        q2: Constant::from(0.3),
        p2: Constant::from(0.0),
    }
    .hamiltonian()?;
    let mut rows = Vec::new();
    for s in [2, 3, 4, 6, 8, 10, 12, 16] {
        for (name, method) in [("EQUIP", equip(s)), ("Gauss", gauss(s))] {
            // About as many stages a period for every s.
            let h = 0.04 * s as f64;
            let start = (vec![0.4, 0.0], vec![0.0, 2.0]);
            rows.push(row(
                format!("Kepler {name}({s}), h = {h:.2}"),
                &kepler,
                method,
                h,
                200,
                start,
            ));
            let start = (vec![0.0, 0.3], vec![0.42, 0.0]);
            rows.push(row(
                format!("Hénon–Heiles {name}({s}), h = {h:.2}"),
                &henon,
                method,
                h,
                200,
                start,
            ));
        }
    }
    table("stages", &rows, counts_only)?;

    let mut rows = Vec::new();
    for s in [4, 8, 12] {
        let method = equip(s);
        let h = 0.02 * s as f64;
        rows.push(row(
            format!("f64, EQUIP({s})"),
            &kepler,
            method,
            h,
            100,
            (vec![0.4, 0.0], vec![0.0, 2.0]),
        ));
        let wide = |x: [f64; 2]| x.map(DoubleDouble::exact).to_vec();
        let start = (wide([0.4, 0.0]), wide([0.0, 2.0]));
        rows.push(row(
            format!("dd, EQUIP({s})"),
            &kepler,
            method,
            DoubleDouble::exact(h),
            100,
            start,
        ));
    }
    table("precision, Kepler e = 0.6", &rows, counts_only)?;
    Ok(())
}

/// ∇H of an FPUT-β chain by hand.
fn chain_by_hand(beta: f64, q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]) {
    let spring = |d: f64| d + beta * (d * d * d);
    dp.copy_from_slice(p);
    let mut left = spring(q[0]);
    for (slope, pair) in dq.iter_mut().zip(q.windows(2)) {
        let right = spring(pair[1] - pair[0]);
        *slope = left - right;
        left = right;
    }
    let last = q.len() - 1;
    dq[last] = left - spring(-q[last]);
}

/// The same chain as a closure, with its gradient by hand, and as an external energy.
fn routes(counts_only: bool) -> Result<(), Box<dyn Error>> {
    let n = 512;
    let scene = find("fput-beta")?.instance(&[("n", "512")])?;
    let start = scene.initial::<f64>();
    let closure = scene.hamiltonian().clone();
    let beta = 0.3;
    let by_hand =
        (closure.clone()).with_gradient(move |q, p, dq, dp| chain_by_hand(beta, q, p, dq, dp));
    let external = Hamiltonian::external(
        n,
        f64::EPSILON,
        move |q, p| {
            let spring = |d: f64| 0.5 * d * d + 0.25 * beta * d.powi(4);
            let inner: f64 = q.windows(2).map(|pair| spring(pair[1] - pair[0])).sum();
            let kinetic: f64 = p.iter().map(|p| 0.5 * p * p).sum();
            kinetic + inner + spring(q[0]) + spring(q[n - 1])
        },
        move |q, p, dq, dp| chain_by_hand(beta, q, p, dq, dp),
    )?;
    for given in [&by_hand, &external] {
        given.check_gradient(&[start.0.clone(), start.1.clone()].concat())?;
    }
    let mut rows = Vec::new();
    for s in [4, 8] {
        for (name, system) in [
            ("closure", &closure),
            ("gradient by hand", &by_hand),
            ("external", &external),
        ] {
            let name = format!("{name}, s = {s}");
            rows.push(row(name, system, equip(s), 0.2, 20, start.clone()));
        }
    }
    let title = "FPUT-β chain of 512 masses, three ways to give H";
    table(title, &rows, counts_only)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let counts_only = std::env::args().any(|a| a == "--counts");
    println!(
        "Counts and times a step, work: gradients at one point; fixed-point and Newton iterations"
    );
    chains(counts_only)?;
    bodies(counts_only)?;
    stages(counts_only)?;
    routes(counts_only)
}
