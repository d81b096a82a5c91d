//! The scenes of the comparison.

use crate::contestants::composition::propagate;
use crate::problem::{Problem, outer_mass, pythagorean_mass};
use crate::task::{DOUBLE, EXTENDED, Sizes, Task, WithTask};
use equip::scalar::Constant;
use equip::prelude::*;
use equip::scenes::Instance;
use equip::scenes::energies::{
    Fpu, FputBeta, HenonHeiles, Kepler, OuterSolarSystem, Pythagorean, SpringPendulum,
};
use std::f64::consts::TAU;

/// Names of all tasks.
pub const NAMES: [&str; 13] = [
    "kepler-0.1",
    "kepler-0.6",
    "kepler-0.9",
    "kepler-0.99",
    "henon-heiles-regular",
    "henon-heiles-chaotic",
    "outer-solar-system",
    "pythagorean",
    "fpu",
    "fput-beta",
    "spring-pendulum",
    "kepler-0.6-extended",
    "kepler-0.9-extended",
];

const EQUAL: &[Sizes] = &[Sizes::Equal];
const VARIABLE: &[Sizes] = &[Sizes::Variable];
const BOTH: &[Sizes] = &[Sizes::Equal, Sizes::Variable];

/// Builds the task `name` and hands it over.
///
/// # Errors
/// If there is no such task, or what `visitor` returns.
pub fn visit(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    match name {
        "kepler-0.1" => kepler(name, "0.1", 1000.3, EQUAL, DOUBLE, visitor),
        "kepler-0.6" => kepler(name, "0.6", 1000.3, BOTH, DOUBLE, visitor),
        "kepler-0.9" => kepler(name, "0.9", 1000.3, BOTH, DOUBLE, visitor),
        "kepler-0.99" => kepler(name, "0.99", 1000.3, VARIABLE, DOUBLE, visitor),
        "kepler-0.6-extended" => kepler(name, "0.6", 100.3, EQUAL, EXTENDED, visitor),
        "kepler-0.9-extended" => kepler(name, "0.9", 100.3, BOTH, EXTENDED, visitor),
        "henon-heiles-regular" => henon_heiles_regular(name, visitor),
        "henon-heiles-chaotic" => henon_heiles_chaotic(name, visitor),
        "outer-solar-system" => outer_solar_system(name, visitor),
        "pythagorean" => pythagorean(name, visitor),
        "fpu" => fpu(name, visitor),
        "fput-beta" => fput_beta(name, visitor),
        "spring-pendulum" => spring_pendulum(name, visitor),
        _ => Err(format!(
            "there is no scene {name}; there are {}",
            NAMES.join(", ")
        )),
    }
}

/// A task in `f64` with unit masses, equal steps, and no reference yet.
fn draft(
    name: &'static str,
    title: &str,
    system: &'static str,
    (q, p): (Vec<f64>, Vec<f64>),
    end: f64,
    periods: f64,
) -> Task {
    Task {
        name,
        title: title.into(),
        system,
        parameters: Vec::new(),
        masses: vec![1.0; q.len()],
        q,
        p,
        end,
        periods,
        finest: 32.0,
        sizes: EQUAL,
        reference: Vec::new(),
        uncertainty: 0.0,
        targets: DOUBLE,
        tolerance: None,
    }
}

fn instance(scene: &str, values: &[(&str, &str)]) -> Result<Instance, String> {
    let scene = equip::scenes::find(scene).and_then(|s| s.instance(values));
    scene.map_err(|e| e.to_string())
}

/// The task ends at the stored reference `reference`.
fn stored(
    name: &'static str,
    title: &str,
    system: &'static str,
    reference: &str,
    periods: f64,
) -> Result<Task, String> {
    let instance = Instance::from_reference(reference).map_err(|e| e.to_string())?;
    let reference = instance.reference().ok_or("the scene has no reference")?;
    let start = instance.initial::<f64>();
    let (q, p) = reference.state::<DoubleDouble>();
    Ok(Task {
        reference: [q, p].concat(),
        uncertainty: reference.trusted_error().max(1e-30),
        ..draft(name, title, system, start, reference.end(), periods)
    })
}

/// The task's end state is computed here, in double-double with a composition of order 10; twice the steps
/// bound its error.
fn computed(problem: &impl Problem, steps: u64, mut task: Task) -> Task {
    let run = |steps| propagate(problem, (&task.q, &task.p), task.end, steps);
    let (coarse, fine) = (run(steps), run(2 * steps));
    task.reference = fine;
    task.uncertainty = task.error(&coarse);
    task
}

fn kepler(
    name: &'static str,
    text: &'static str,
    periods: f64,
    sizes: &'static [Sizes],
    targets: &'static [f64],
    visitor: &mut impl WithTask,
) -> Result<(), String> {
    let scene = instance("kepler", &[("e", text)])?;
    let (q, p) = scene.initial::<f64>();
    let end = TAU * periods;
    let wide = |x: &Vec<f64>| x.iter().map(|&x| DoubleDouble::exact(x)).collect();
    let start: (Vec<DoubleDouble>, Vec<DoubleDouble>) = (wide(&q), wide(&p));
    let (qe, pe) = scene
        .flow(&start, DoubleDouble::exact(end))
        .ok_or("Kepler's flow is closed for bound orbits only")?;
    let e: f64 = text.parse().map_err(|_| "an eccentricity is a number")?;
    // Steps have to resolve the pericentre: there the motion is faster by √(1+e)/(1−e)^{3/2}.
    let faster = (1.0 + e).sqrt() / (1.0 - e).powf(1.5);
    let title = format!("Kepler e = {text}, {periods} periods");
    let task = Task {
        finest: if targets == EXTENDED { 64.0 } else { 24.0 },
        sizes,
        reference: [qe, pe].concat(),
        uncertainty: 1e-27,
        targets,
        ..draft(
            name,
            &title,
            "kepler",
            (q, p),
            end,
            periods * faster.powf(0.7),
        )
    };
    let problem = Kepler {
        e: decimal(text).map_err(|e| e.to_string())?,
        mu: Constant::from(1.0),
    };
    if task.extended() {
        visitor.with_extended(problem, task)
    } else {
        visitor.with(problem, task)
    }
}

fn henon_heiles_regular(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    let problem = HenonHeiles {
        energy: ratio(1, 8),
        q2: Constant::from(0.3),
        p2: Constant::from(0.0),
    };
    let title = "Hénon–Heiles, E = 1/8 (regular), T = 1000";
    let task = stored(name, title, "henon-heiles", "hh_regular", 1000.0 / TAU)?;
    visitor.with(problem, task)
}

fn henon_heiles_chaotic(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    let problem = HenonHeiles {
        energy: ratio(1, 6),
        q2: Constant::from(0.1),
        p2: Constant::from(0.0),
    };
    let title = "Hénon–Heiles, E = 1/6 (chaotic), T = 200";
    let values = [("energy", "1/6"), ("q2", "0.1"), ("p2", "0")];
    let start = instance("henon-heiles", &values)?.initial::<f64>();
    let task = draft(name, title, "henon-heiles", start, 200.0, 200.0 / TAU);
    let task = computed(&problem, 40_000, task);
    visitor.with(problem, task)
}

fn outer_solar_system(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    let title = "Outer solar system, 200 000 days";
    // Revolutions of Jupiter.
    let task = stored(name, title, "outer-solar-system", "outer_ss", 46.0)?;
    let task = Task {
        masses: (0..task.q.len()).map(outer_mass).collect(),
        ..task
    };
    visitor.with(OuterSolarSystem { planets: 5 }, task)
}

/// Errors to be reached in the Pythagorean problem: close encounters magnify a double's last digit to some
/// 1e-3.
const ENCOUNTERS: &[f64] = &[1e-1, 1e-2, 1e-3, 1e-4];

fn pythagorean(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    let scene = instance("pythagorean", &[])?;
    let task = draft(
        name,
        "Pythagorean three bodies, T = 60",
        "pythagorean",
        scene.initial::<f64>(),
        60.0,
        60.0,
    );
    let task = Task {
        masses: (0..task.q.len()).map(pythagorean_mass).collect(),
        sizes: VARIABLE,
        targets: ENCOUNTERS,
        tolerance: Some(1e-14),
        ..task
    };
    visitor.with(Pythagorean {}, encounters(task, &scene)?)
}

/// The task's end state from two runs in double-double with variable steps, whose tolerances differ by a
/// factor of 100.
fn encounters(mut task: Task, scene: &Instance) -> Result<Task, String> {
    let (q, p) = scene.initial::<DoubleDouble>();
    let run = |tolerance: &str| -> Result<Vec<DoubleDouble>, String> {
        let tolerance = DoubleDouble::decimal(tolerance).map_err(|e| e.to_string())?;
        let interval = DoubleDouble::int(0)..=DoubleDouble::exact(task.end);
        let made = Gauss::stages(16)
            .tolerance(tolerance)
            .record(Record::Ends)
            .integrate(scene.hamiltonian(), &q, &p, interval)
            .map_err(|e| e.to_string())?;
        let (_, q, p) = made.last();
        Ok([q, p].concat())
    };
    let (coarse, fine) = (run("1e-24")?, run("1e-26")?);
    task.reference = fine;
    task.uncertainty = task.error(&coarse);
    Ok(task)
}

fn fpu(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    let problem = Fpu {
        m: 3,
        omega: Constant::from(50.0),
    };
    let title = "FPU, three springs of ω = 50, T = 200";
    let task = stored(name, title, "fpu", "fpu_hlw", 200.0 * 50.0 / TAU)?;
    let task = Task {
        parameters: vec![3.0, 50.0],
        finest: 16.0,
        ..task
    };
    visitor.with(problem, task)
}

/// The chain starts at rest positions with momenta spread evenly over [−1, 1): all modes move, up to the
/// fastest with ω = 2, as they do when the energy has spread. (The first mode alone is so slow and smooth
/// that any method with long steps is fast.)
fn fput_beta(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    const N: usize = 1024;
    let problem = FputBeta {
        n: N,
        beta: Constant::from(0.3),
        amplitude: Constant::from(0.0),
    };
    let mut seed = 1;
    let p = (0..N).map(|_| signed_unit(&mut seed)).collect();
    let title = "FPUT-β, 1024 masses, random momenta, T = 100";
    let start = (vec![0.0; N], p);
    let task = draft(name, title, "fput-beta", start, 100.0, 200.0 / TAU);
    let task = Task {
        parameters: vec![N as f64, 0.3],
        ..task
    };
    let task = computed(&problem, 1000, task);
    visitor.with(problem, task)
}

/// The next of a sequence of numbers in [−1, 1), multiples of 2⁻³¹: SplitMix64, [Steele, Lea, Flood, OOPSLA
/// 2014, Fig. 16].
fn signed_unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 32) as f64 / f64::from(1_u32 << 31) - 1.0
}

/// The spring swings by 1e-4 beside the pendulum: at a start without that, methods may step over the fast
/// motion.
fn spring_pendulum(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    let problem = SpringPendulum {
        k: Constant::from(1e6),
        g: Constant::from(1.0),
    };
    let title = "Stiff spring pendulum, k = 1e6, T = 10";
    let start = (vec![1.0, 0.0], vec![0.1, -1.0]);
    let task = draft(
        name,
        title,
        "spring-pendulum",
        start,
        10.0,
        10.0 * 1e3 / TAU,
    );
    let task = Task {
        parameters: vec![1e6, 1.0],
        ..task
    };
    let task = computed(&problem, 100_000, task);
    visitor.with(problem, task)
}
