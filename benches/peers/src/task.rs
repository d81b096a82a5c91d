//! The scenes of the comparison: the same initial data, end time and error norm for all.

use crate::problem::{Problem, outer_mass};
use equip::prelude::*;
use equip::scenes::Instance;
use equip::scenes::energies::{
    Fpu, FputBeta, HenonHeiles, Kepler, OuterSolarSystem, SpringPendulum,
};

/// A scene with start, end and what the end state is.
#[derive(Debug, Clone)]
pub struct Task {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Name for people.
    pub title: String,
    /// What the worker of the Python peers builds.
    pub system: &'static str,
    pub parameters: Vec<f64>,
    /// Doubles to start from, in every number type.
    pub q: Vec<f64>,
    pub p: Vec<f64>,
    /// p = m v: what the peers that compute in velocities start from.
    pub masses: Vec<f64>,
    pub end: f64,
    /// Natural periods of the fastest motion over the interval; sets where ladders of steps begin.
    pub periods: f64,
    /// Ladders of steps end with so many times the steps they begin with.
    pub finest: f64,
    /// (q, p) at the end.
    pub reference: Vec<DoubleDouble>,
    /// How far the reference may be off.
    pub uncertainty: f64,
    /// Errors to be reached.
    pub targets: &'static [f64],
}

const DOUBLE: &[f64] = &[1e-6, 1e-8, 1e-10, 1e-12];
const EXTENDED: &[f64] = &[1e-12, 1e-15, 1e-20, 1e-25];

impl Task {
    /// The largest difference from the reference in any component of q and p.
    pub fn error(&self, end: &[DoubleDouble]) -> f64 {
        let far = |(&x, &y): (&DoubleDouble, &DoubleDouble)| (x - y).to_f64().abs();
        let error = |worst: f64, x: f64| if x <= worst { worst } else { x };
        end.iter().zip(&self.reference).map(far).fold(0.0, error)
    }

    /// v = p/m at the start, the doubles nearest to the quotients.
    pub fn velocities(&self) -> Vec<f64> {
        self.p
            .iter()
            .zip(&self.masses)
            .map(|(p, m)| p / m)
            .collect()
    }

    /// Whether it is about bodies that attract each other.
    pub fn gravity(&self) -> bool {
        matches!(self.system, "kepler" | "outer-solar-system")
    }
}

/// What can be done with a task whatever its Hamiltonian is.
pub trait WithTask {
    /// Called with the energy of the task.
    fn with<P: Problem>(&mut self, problem: P, task: Task) -> Result<(), String>;
}

/// Names of all tasks.
pub const NAMES: [&str; 11] = [
    "kepler-0.1",
    "kepler-0.6",
    "kepler-0.9",
    "henon-heiles-regular",
    "henon-heiles-chaotic",
    "outer-solar-system",
    "fpu",
    "fput-beta",
    "spring-pendulum",
    "kepler-0.6-extended",
    "kepler-0.9-extended",
];

/// Builds the task `name` and hands it over.
///
/// # Errors
/// If there is no such task, or what `visitor` returns.
pub fn visit(name: &'static str, visitor: &mut impl WithTask) -> Result<(), String> {
    match name {
        "kepler-0.1" => kepler(name, "0.1", 0.1, 1000.3, DOUBLE, visitor),
        "kepler-0.6" => kepler(name, "0.6", 0.6, 1000.3, DOUBLE, visitor),
        "kepler-0.9" => kepler(name, "0.9", 0.9, 1000.3, DOUBLE, visitor),
        "kepler-0.6-extended" => kepler(name, "0.6", 0.6, 100.3, EXTENDED, visitor),
        "kepler-0.9-extended" => kepler(name, "0.9", 0.9, 100.3, EXTENDED, visitor),
        "henon-heiles-regular" => {
            let problem = HenonHeiles {
                energy: ratio(1, 8),
                q2: Constant::from(0.3),
                p2: Constant::from(0.0),
            };
            let instance = Instance::from_reference("hh_regular").map_err(|e| e.to_string())?;
            stored(
                name,
                "Hénon–Heiles, E = 1/8 (regular), T = 1000",
                "henon-heiles",
                &[],
                1000.0 / std::f64::consts::TAU,
                32.0,
                problem,
                &instance,
                visitor,
            )
        }
        "henon-heiles-chaotic" => {
            let parameters = [("energy", "1/6"), ("q2", "0.1"), ("p2", "0")];
            let problem = HenonHeiles {
                energy: ratio(1, 6),
                q2: Constant::from(0.1),
                p2: Constant::from(0.0),
            };
            let title = "Hénon–Heiles, E = 1/6 (chaotic), T = 200";
            computed(
                name,
                title,
                "henon-heiles",
                &[],
                &parameters,
                200.0,
                200.0 / std::f64::consts::TAU,
                40_000,
                problem,
                visitor,
            )
        }
        "outer-solar-system" => {
            let problem = OuterSolarSystem { planets: 5 };
            let instance = Instance::from_reference("outer_ss").map_err(|e| e.to_string())?;
            stored(
                name,
                "Outer solar system, 200 000 days",
                "outer-solar-system",
                &[],
                46.0,
                32.0,
                problem,
                &instance,
                visitor,
            )
        }
        "fpu" => {
            let problem = Fpu {
                m: 3,
                omega: Constant::from(50.0),
            };
            let instance = Instance::from_reference("fpu_hlw").map_err(|e| e.to_string())?;
            stored(
                name,
                "FPU, three springs of ω = 50, T = 200",
                "fpu",
                &[3.0, 50.0],
                200.0 * 50.0 / std::f64::consts::TAU,
                16.0,
                problem,
                &instance,
                visitor,
            )
        }
        "fput-beta" => {
            let problem = FputBeta {
                n: 1024,
                beta: Constant::from(0.3),
                amplitude: Constant::from(10.0),
            };
            let title = "FPUT-β, 1024 masses, T = 100";
            computed(
                name,
                title,
                "fput-beta",
                &[1024.0, 0.3],
                &[("n", "1024")],
                100.0,
                8.0,
                400,
                problem,
                visitor,
            )
        }
        "spring-pendulum" => {
            let parameters = [("k", "1000000")];
            let problem = SpringPendulum {
                k: Constant::from(1e6),
                g: Constant::from(1.0),
            };
            let title = "Stiff spring pendulum, k = 1e6, T = 10";
            computed(
                name,
                title,
                "spring-pendulum",
                &[1e6, 1.0],
                &parameters,
                10.0,
                10.0 * 1e3 / std::f64::consts::TAU,
                100_000,
                problem,
                visitor,
            )
        }
        _ => Err(format!(
            "there is no scene {name}; there are {}",
            NAMES.join(", ")
        )),
    }
}

fn kepler(
    name: &'static str,
    text: &str,
    e: f64,
    periods: f64,
    targets: &'static [f64],
    visitor: &mut impl WithTask,
) -> Result<(), String> {
    let scene = equip::scenes::find("kepler").and_then(|s| s.instance(&[("e", text)]));
    let scene = scene.map_err(|e| e.to_string())?;
    let (q, p) = scene.initial::<f64>();
    let end = std::f64::consts::TAU * periods;
    let wide = |x: &Vec<f64>| x.iter().map(|&x| DoubleDouble::exact(x)).collect();
    let start: (Vec<DoubleDouble>, Vec<DoubleDouble>) = (wide(&q), wide(&p));
    let (qe, pe) = scene
        .flow(&start, DoubleDouble::exact(end))
        .ok_or("Kepler's flow is closed for bound orbits only")?;
    // Steps have to resolve the pericentre: there the motion is faster by √(1+e)/(1−e)^{3/2}.
    let faster = (1.0 + e).sqrt() / (1.0 - e).powf(1.5);
    let task = Task {
        name,
        title: format!("Kepler e = {e}, {periods} periods"),
        system: "kepler",
        parameters: vec![],
        masses: vec![1.0; 2],
        q,
        p,
        end,
        periods: periods * faster.powf(0.7),
        finest: if targets[0] < 1e-6 { 64.0 } else { 24.0 },
        reference: [qe, pe].concat(),
        uncertainty: 1e-27,
        targets,
    };
    visitor.with(
        Kepler {
            e: Constant::from(e),
            mu: Constant::from(1.0),
        },
        task,
    )
}

/// A task that ends at a stored reference.
#[expect(
    clippy::too_many_arguments,
    reason = "a table of scenes in the form of calls"
)]
fn stored(
    name: &'static str,
    title: &str,
    system: &'static str,
    parameters: &[f64],
    periods: f64,
    finest: f64,
    problem: impl Problem,
    instance: &Instance,
    visitor: &mut impl WithTask,
) -> Result<(), String> {
    let reference = instance.reference().ok_or("the scene has no reference")?;
    let (q, p) = instance.initial::<f64>();
    let (qe, pe) = reference.state::<DoubleDouble>();
    let outer = system == "outer-solar-system";
    let mass = |i| if outer { outer_mass::<f64>(i) } else { 1.0 };
    let task = Task {
        name,
        title: title.into(),
        system,
        parameters: parameters.to_vec(),
        masses: (0..q.len()).map(mass).collect(),
        q,
        p,
        end: reference.end(),
        periods,
        finest,
        reference: [qe, pe].concat(),
        uncertainty: reference.trusted_error().max(1e-30),
        targets: DOUBLE,
    };
    visitor.with(problem, task)
}

/// A task whose end state is computed here, in double-double with a composition of order 10.
#[expect(
    clippy::too_many_arguments,
    reason = "a table of scenes in the form of calls"
)]
fn computed(
    name: &'static str,
    title: &str,
    system: &'static str,
    parameters: &[f64],
    values: &[(&str, &str)],
    end: f64,
    periods: f64,
    steps: u64,
    problem: impl Problem,
    visitor: &mut impl WithTask,
) -> Result<(), String> {
    let scene = equip::scenes::find(system).and_then(|s| s.instance(values));
    let (q, p) = scene.map_err(|e| e.to_string())?.initial::<f64>();
    let coarse = crate::composition::propagate(&problem, &q, &p, end, steps);
    let reference = crate::composition::propagate(&problem, &q, &p, end, 2 * steps);
    let mut task = Task {
        name,
        title: title.into(),
        system,
        parameters: parameters.to_vec(),
        masses: vec![1.0; q.len()],
        q,
        p,
        end,
        periods,
        finest: 32.0,
        reference,
        uncertainty: 0.0,
        targets: DOUBLE,
    };
    task.uncertainty = task.error(&coarse);
    visitor.with(problem, task)
}
