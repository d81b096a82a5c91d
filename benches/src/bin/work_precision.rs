//! Error against run time: Kepler and Hénon–Heiles, EQUIP(s) and Gauss(s), in f64 and double-double.
//!
//! `cargo run --release -p equip-benches --bin work_precision`
//!
//! Every row is the median of interleaved repeats: all methods run once, then all again, so that a slow spell
//! of the machine does not hit one method alone. Times are CPU-bound wall-clock milliseconds of the whole run
//! with [`Record::Ends`]; the error is the max norm over (q, p) at a time that is no whole number of periods,
//! against the exact solution (Kepler) or the stored reference (Hénon–Heiles).

use equip_integrate::{Equip, Gauss, Method, Record};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::{Instance, SceneError, find};
use std::error::Error;
use std::time::Instant;

/// Repeats of each run.
const REPEATS: usize = 5;

/// One line of the table: a method with its step, and what its repeats showed.
struct Row<T> {
    method: Method,
    steps: i64,
    error: f64,
    energy: f64,
    milliseconds: Vec<f64>,
    h: T,
}

/// A scene with its end time and end state.
struct Task<T> {
    name: &'static str,
    scene: Instance,
    end: T,
    state: Vec<T>,
}

fn kepler<T: Float>() -> Result<Task<T>, SceneError> {
    let scene = find("kepler")?.instance(&[("e", "0.6")])?;
    // Ten periods and a bit: at whole periods a method that does nothing scores zero error.
    let end = T::int(64);
    let (q, p) = scene.exact(end).unwrap_or_default();
    Ok(Task {
        name: "kepler e = 0.6, t = 64",
        scene,
        end,
        state: [q, p].concat(),
    })
}

fn henon_heiles<T: Float>() -> Result<Task<T>, SceneError> {
    let scene = Instance::from_reference("henon_heiles_1_12")?;
    let (end, state) = match scene.reference() {
        Some(reference) => {
            let (q, p) = reference.state::<T>();
            (reference.end(), [q, p].concat())
        }
        None => (T::int(0), Vec::new()),
    };
    Ok(Task {
        name: "henon-heiles E = 1/12, t = 100",
        scene,
        end,
        state,
    })
}

fn measure<T: Float>(task: &Task<T>, row: &mut Row<T>) -> Result<(), Box<dyn Error>> {
    let (q0, p0) = task.scene.initial::<T>();
    let begun = Instant::now();
    let run = row.method.step(row.h).record(Record::Ends).integrate(
        task.scene.hamiltonian(),
        &q0,
        &p0,
        T::int(0)..=task.end,
    )?;
    row.milliseconds.push(1e3 * begun.elapsed().as_secs_f64());
    let (_, q, p) = run.last();
    let far = |(x, y): (&T, &T)| (*x - *y).to_f64().abs();
    row.error = q
        .iter()
        .chain(p)
        .zip(&task.state)
        .map(far)
        .fold(0.0, f64::max);
    row.energy = run
        .certificate()
        .energy
        .as_ref()
        .map_or(f64::NAN, |e| e.max.to_f64());
    Ok(())
}

fn table<T: Float>(task: &Task<T>, stages: &[usize], steps: &[i64]) -> Result<(), Box<dyn Error>> {
    let methods = stages
        .iter()
        .flat_map(|&s| [Gauss::stages(s), Equip::stages(s)]);
    let mut rows: Vec<Row<T>> = methods
        .flat_map(|method| {
            steps.iter().map(move |&steps| Row {
                method,
                steps,
                error: f64::NAN,
                energy: f64::NAN,
                milliseconds: Vec::with_capacity(REPEATS),
                h: task.end / T::int(steps),
            })
        })
        .collect();
    for _ in 0..REPEATS {
        for row in &mut rows {
            measure(task, row)?;
        }
    }
    println!("\n{}, {}", task.name, T::NAME);
    println!(
        "{:<28}{:>7}{:>11}{:>11}{:>11}",
        "method", "steps", "error", "energy", "ms"
    );
    for row in &mut rows {
        row.milliseconds.sort_by(f64::total_cmp);
        println!(
            "{:<28}{:>7}{:>11.1e}{:>11.1e}{:>11.3}",
            row.method.to_string(),
            row.steps,
            row.error,
            row.energy,
            row.milliseconds[REPEATS / 2]
        );
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    table(&kepler::<f64>()?, &[3, 4, 6], &[400, 800, 1600])?;
    table(&henon_heiles::<f64>()?, &[3, 4, 6], &[200, 400, 800])?;
    table(&kepler::<DoubleDouble>()?, &[6, 8], &[400, 800])?;
    table(&henon_heiles::<DoubleDouble>()?, &[6, 8], &[200, 400])?;
    Ok(())
}
