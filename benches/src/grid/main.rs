//! EQUIP as it comes beside Gauss on the same steps: scenes × stages × steps, and random starts.
//!
//! `cargo run --release -p equip-benches --bin grid -- --quick --csv grid.csv --svg grid.svg`
//!
//! A cell is 40 steps of one size with both methods: counts of work, CPU time of the steps (interleaved
//! repeats, the least), error at the end against a reference in double-double that uses none of the
//! solver's code, largest |H − H_ref|, outcomes of the steps. The summary gives shares and quantiles by
//! regime, the targets, and the worst cells.

mod cache;
mod cell;
mod contestant;
mod csv;
mod motion;
mod random;
mod scenes;
mod summary;
mod svg;

use cell::{Cell, Patience, STEPS, Truth};
use clap::Parser;
use contestant::Task;
use motion::Motion;
use scenes::Scene;
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

/// EQUIP beside Gauss on scenes × stages × steps.
#[derive(Debug, Parser)]
struct Args {
    /// Fewer stages, steps, random starts and repeats.
    #[arg(long)]
    quick: bool,
    /// One row a cell.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Heat maps of time and error over Gauss's.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Only the scenes whose name contains this.
    #[arg(long, value_name = "SCENE")]
    filter: Option<String>,
    /// Numbers of stages.
    #[arg(long, value_delimiter = ',')]
    stages: Option<Vec<usize>>,
    /// Seed of the random starts.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Random starts at each of the three settings of a scene.
    #[arg(long)]
    starts: Option<u64>,
    /// In place of the scenes so many random systems, each with a start, stages and a step of its own.
    #[arg(long, value_name = "N")]
    random: Option<u64>,
    /// Where references are kept.
    #[arg(long, default_value = "target/grid-references")]
    cache: PathBuf,
}

const STAGES: [usize; 14] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 20, 24, 32];
const QUICK_STAGES: [usize; 8] = [2, 3, 4, 6, 8, 12, 16, 32];
/// Step sizes of a scene.
const SIZES: usize = 12;
const QUICK_SIZES: [usize; 6] = [0, 2, 4, 6, 8, 11];
/// Stages and number of the step size, for random starts.
const SETTINGS: [(usize, usize); 3] = [(4, 3), (6, 5), (8, 7)];

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let begun = Instant::now();
    let mut cells = Vec::new();
    if let Some(count) = args.random {
        cells = random::cells(count, args.seed, patience(&args))?;
    }
    let scenes = match args.random {
        Some(_) => Vec::new(),
        None => scenes::all()?,
    };
    for scene in scenes {
        let wanted = |filter: &String| scene.name.contains(filter.as_str());
        if args.filter.as_ref().is_none_or(wanted) {
            of_scene(&args, &scene, &mut cells)?;
            let seconds = begun.elapsed().as_secs_f64();
            eprintln!("{seconds:>6.1} s  {}", scene.name);
            // A run that is ended early leaves what it has.
            if let Some(path) = &args.csv {
                csv::write(path, &cells)?;
            }
        }
    }
    if let Some(path) = &args.csv {
        csv::write(path, &cells)?;
    }
    if let Some(path) = &args.svg {
        std::fs::write(path, svg::page(&cells))?;
    }
    print!("{}", summary::text(&cells));
    Ok(())
}

fn of_scene(args: &Args, scene: &Scene, cells: &mut Vec<Cell>) -> Result<(), Box<dyn Error>> {
    let [first, last] = scene.steps;
    let ratio = (last / first).powf(1.0 / (SIZES - 1) as f64);
    let steps: Vec<f64> = (0..SIZES).map(|i| first * ratio.powi(i as i32)).collect();
    let stages = match &args.stages {
        Some(stages) => stages.clone(),
        None if args.quick => QUICK_STAGES.to_vec(),
        None => STAGES.to_vec(),
    };
    let shown: Vec<usize> = match args.quick {
        true => QUICK_SIZES.to_vec(),
        false => (0..SIZES).collect(),
    };
    let grid = stages
        .iter()
        .flat_map(|&s| shown.iter().map(move |&h| (s, h)));
    of_start(args, scene, 0, &steps, &grid.collect::<Vec<_>>(), cells)?;
    let starts = args.starts.unwrap_or(if args.quick { 4 } else { 20 });
    for start in 1..=starts {
        let steps = SETTINGS.map(|(_, h)| steps[h]);
        let grid = SETTINGS.iter().enumerate().map(|(h, &(s, _))| (s, h));
        of_start(args, scene, start, &steps, &grid.collect::<Vec<_>>(), cells)?;
    }
    Ok(())
}

/// The cells (stages, number of the step size) of one start.
fn of_start(
    args: &Args,
    scene: &Scene,
    start: u64,
    steps: &[f64],
    grid: &[(usize, usize)],
    cells: &mut Vec<Cell>,
) -> Result<(), Box<dyn Error>> {
    let (q, p) = scene.start(start, args.seed);
    let y = [q.as_slice(), &p].concat();
    let times: Vec<f64> = steps.iter().map(|h| STEPS as f64 * h).collect();
    let rate = equip_tests::rate(&scene.hamiltonian, &y);
    let named = (scene.name, &scene.hamiltonian);
    let reference = cache::reference(&args.cache, named, &y, &times, rate)?;
    let known = Motion::along(&scene.hamiltonian, &y, &reference);
    for &(stages, h) in grid {
        let task = Task {
            hamiltonian: &scene.hamiltonian,
            q: &q,
            p: &p,
            stages,
            step: steps[h],
            steps: STEPS,
        };
        let truth = Truth {
            state: &reference.states[h],
            error: reference.errors[h],
            sizes: known.sizes,
            rate: known.rate,
            round_off: known.round_off,
            is_stiff: scene.is_stiff,
        };
        cells.push(Cell::measure(
            (scene.name, start),
            &task,
            truth,
            patience(args),
        ));
    }
    Ok(())
}

fn patience(args: &Args) -> Patience {
    match args.quick {
        true => Patience {
            repeats: 8,
            seconds: 2e-3,
        },
        false => Patience {
            repeats: 15,
            seconds: 6e-3,
        },
    }
}
