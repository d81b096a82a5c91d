//! EQUIP beside Gauss on the same steps: error and time, and what EQUIP costs at equal error.
//!
//! `cargo run --release -p equip-benches --bin choosing` prints the table of `docs/choosing.md`.
//!
//! Each row has eight starts within 1 % of the scene's, with the errors of (q, p) at the end, max norm,
//! against a run in double-double by tolerance; their geometric mean; and the ratio of the means of their CPU
//! times, each the least of several interleaved runs. At order 2s an error F times as large is worth F^(1/2s)
//! times the steps: the last column is the time of EQUIP over that of Gauss by this rule.

use cpu_time::ThreadTime;
use equip_integrate::{Equip, Gauss, Method, Record};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::{Instance, find};
use std::error::Error;

const STARTS: usize = 8;
const REPEATS: usize = 5;

/// A scene with its parameters, the end of the run, and (stages, steps).
type Row = (
    &'static str,
    &'static str,
    &'static [(&'static str, &'static str)],
    f64,
    &'static [(usize, u32)],
);

const ROWS: [Row; 8] = [
    (
        "Kepler, e = 0.6",
        "kepler",
        &[("e", "0.6")],
        62.9,
        &[(4, 480)],
    ),
    (
        "Kepler, e = 0.6",
        "kepler",
        &[("e", "0.6")],
        628.6,
        &[(6, 3200), (8, 2400), (16, 1200)],
    ),
    (
        "Hénon–Heiles, E = 1/6",
        "henon-heiles",
        &[("energy", "1/6")],
        100.0,
        &[(4, 200), (6, 150), (8, 100)],
    ),
    (
        "spring pendulum, k = 10⁴",
        "spring-pendulum",
        &[("k", "1e4")],
        5.0,
        &[(4, 400), (6, 200)],
    ),
    (
        "double pendulum",
        "double-pendulum",
        &[],
        4.0,
        &[(4, 64), (8, 64)],
    ),
    (
        "stiff double pendulum",
        "stiff-double-pendulum",
        &[],
        2.0,
        &[(4, 128), (6, 128)],
    ),
    ("pendulum", "pendulum", &[], 70.0, &[(4, 105), (6, 105)]),
    (
        "outer solar system",
        "outer-solar-system",
        &[],
        200_000.0,
        &[(4, 1000), (8, 600)],
    ),
];

/// The scene's start, each component moved by a part of at most 1 %, the same on every machine.
fn starts(scene: &Instance) -> Vec<Vec<f64>> {
    let (q, p) = scene.initial::<f64>();
    let start = [q, p].concat();
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
    let mut drawn = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let moved =
        |drawn: &mut dyn FnMut() -> f64| start.iter().map(|x| x * (1.0 + 0.01 * drawn())).collect();
    (0..STARTS).map(|_| moved(&mut drawn)).collect()
}

/// The state at the end, and the seconds of CPU time.
fn run(
    method: Method,
    scene: &Instance,
    y: &[f64],
    (end, steps): (f64, u32),
) -> Result<(Vec<f64>, f64), Box<dyn Error>> {
    let (q, p) = y.split_at(y.len() / 2);
    let options = method.step(end / f64::from(steps)).record(Record::Ends);
    let mut prepared = options.prepare(scene.hamiltonian())?;
    let begun = ThreadTime::now();
    let run = prepared
        .integrate(q, p, 0.0..=end)
        .map_err(|e| e.to_string())?;
    let seconds = begun.elapsed().as_secs_f64();
    let (_, q, p) = run.last();
    Ok(([q, p].concat(), seconds))
}

fn reference(scene: &Instance, y: &[f64], end: f64) -> Result<Vec<f64>, Box<dyn Error>> {
    let exact: Vec<DoubleDouble> = y.iter().map(|&x| DoubleDouble::exact(x)).collect();
    let (q, p) = exact.split_at(y.len() / 2);
    let options = Equip::stages(16).tolerance(DoubleDouble::exact(1e-20));
    let options = options.record(Record::Ends);
    let span = DoubleDouble::int(0)..=DoubleDouble::exact(end);
    let run = options.integrate(scene.hamiltonian(), q, p, span);
    let run = run.map_err(|e| e.to_string())?;
    let (_, q, p) = run.last();
    Ok(q.iter().chain(p).map(|x| x.to_f64()).collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("| | s | steps | error: EQUIP, Gauss | time over Gauss | at equal error |");
    println!("|---|---|---|---|---|---|");
    let (mut product, mut rows) = (1.0, 0);
    for (title, name, parameters, end, settings) in ROWS {
        let scene = find(name)?.instance(parameters)?;
        let starts = starts(&scene);
        let right: Vec<_> = starts
            .iter()
            .map(|y| reference(&scene, y, end))
            .collect::<Result<_, _>>()?;
        for &(stages, steps) in settings {
            let methods = [Equip::stages(stages), Gauss::stages(stages)];
            let (mut logs, mut times) = ([0.0; 2], [0.0; 2]);
            for (y, right) in starts.iter().zip(&right) {
                let mut least = [f64::INFINITY; 2];
                for repeat in 0..REPEATS {
                    for (k, method) in methods.into_iter().enumerate() {
                        let (found, seconds) = run(method, &scene, y, (end, steps))?;
                        least[k] = least[k].min(seconds);
                        if repeat == 0 {
                            let pairs = found.iter().zip(right);
                            let error = pairs.fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
                            logs[k] += error.max(f64::EPSILON).ln() / STARTS as f64;
                        }
                    }
                }
                for (total, least) in times.iter_mut().zip(least) {
                    *total += least;
                }
            }
            let errors = logs.map(f64::exp);
            let worth = (errors[0] / errors[1]).powf(0.5 / stages as f64);
            let slower = times[0] / times[1];
            let cost = slower * worth;
            (product, rows) = (product * cost, rows + 1);
            println!(
                "| {title}, t = {end} | {stages} | {steps} | {:.1e}, {:.1e} | {slower:.1} | {cost:.1} |",
                errors[0], errors[1]
            );
        }
    }
    let mean = product.powf(1.0 / f64::from(rows));
    println!("| geometric mean | | | | | {mean:.1} |");
    Ok(())
}
