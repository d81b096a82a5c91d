//! The systems of the grid, with their range of steps and their random starts.

use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_scenes::{SceneError, find};
use equip_tests::Seeded;

/// A system, a start, and the steps it is made with.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) hamiltonian: Hamiltonian,
    pub(crate) q: Vec<f64>,
    pub(crate) p: Vec<f64>,
    /// Smallest step, which resolves the motion well, and the largest, which does not.
    pub(crate) steps: [f64; 2],
    /// Random starts differ from the first by up to this much, in each position and in each momentum.
    pub(crate) spread: [Vec<f64>; 2],
    /// Whether the fastest frequency is 20 times or more that of the motion one wants.
    pub(crate) is_stiff: bool,
}

/// Why a scene could not be made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error("the start of `{0}` is no decimal number; write the digits out in this file")]
    Start(&'static str),
}

impl Scene {
    /// Start `index`: 0 is the scene's own, the others are random.
    pub(crate) fn start(&self, index: u64, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let (mut q, mut p) = (self.q.clone(), self.p.clone());
        if index > 0 {
            let name = self.name.bytes().fold(seed, |sum, byte| {
                sum.wrapping_mul(31).wrapping_add(byte.into())
            });
            let mut rng = Seeded::new(name.wrapping_mul(1_000_003).wrapping_add(index));
            for (x, spread) in [(&mut q, &self.spread[0]), (&mut p, &self.spread[1])] {
                for (x, &spread) in x.iter_mut().zip(spread) {
                    *x += spread * rng.between(-1.0, 1.0);
                }
            }
        }
        (q, p)
    }

    fn closure(
        name: &'static str,
        start: (Vec<f64>, Vec<f64>),
        steps: [f64; 2],
        energy: impl FnOnce(&[Var], &[Var]) -> Var,
    ) -> Result<Scene, Fault> {
        let (q, p) = start;
        let spread = [vec![0.1; q.len()], vec![0.1; q.len()]];
        Ok(Scene {
            name,
            hamiltonian: Hamiltonian::new(q.len(), energy)?,
            q,
            p,
            steps,
            spread,
            is_stiff: false,
        })
    }

    fn of(
        name: &'static str,
        scene: &str,
        parameters: &[(&str, &str)],
        steps: [f64; 2],
    ) -> Result<Scene, Fault> {
        let instance = find(scene)?.instance(parameters)?;
        let (q, p) = instance.initial::<f64>();
        let hamiltonian = instance.hamiltonian().clone();
        let spread = [vec![0.1; q.len()], vec![0.1; q.len()]];
        Ok(Scene {
            name,
            hamiltonian,
            q,
            p,
            steps,
            spread,
            is_stiff: false,
        })
    }

    /// The same spread for all positions, and for all momenta.
    fn spread(mut self, q: f64, p: f64) -> Self {
        self.spread[0].fill(q);
        self.spread[1].fill(p);
        self
    }

    fn stiff(self) -> Self {
        Scene {
            is_stiff: true,
            ..self
        }
    }

    /// Positions from number `first` on get the spread `q` instead.
    fn spread_from(mut self, first: usize, q: f64) -> Self {
        self.spread[0][first..].fill(q);
        self
    }
}

fn kepler(name: &'static str, e: &str, a_period: [f64; 2]) -> Result<Scene, Fault> {
    let period = std::f64::consts::TAU;
    let steps = a_period.map(|steps| period / steps);
    Ok(Scene::of(name, "kepler", &[("e", e)], steps)?.spread(0.02, 0.02))
}

fn chaotic_henon_heiles(shift: f64) -> impl FnOnce(&[Var], &[Var]) -> Var {
    move |q, p| {
        let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
        let quadratic = 0.5 * (q[0] * q[0] + q[1] * q[1]);
        let h = kinetic + quadratic + q[0] * q[0] * q[1] - q[1].powi(3) / 3.0;
        (shift + h) - shift
    }
}

fn spring(name: &'static str, k: f64, steps: [f64; 2]) -> Result<Scene, Fault> {
    let start = (vec![1.0, 0.0], vec![0.0, 0.0]);
    let scene = Scene::closure(name, start, steps, move |q, p| {
        let stretch = (q[0] * q[0] + q[1] * q[1]).sqrt() - 1.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 0.5 * k * stretch * stretch + q[1]
    })?;
    Ok(scene.spread(1.0 / k.sqrt(), 0.5).stiff())
}

/// n numbers in [low, high), the same on every machine.
fn random(n: usize, seed: u64, low: f64, high: f64) -> Vec<f64> {
    let mut rng = Seeded::new(seed);
    (0..n).map(|_| rng.between(low, high)).collect()
}

fn rotors(n: usize) -> Result<Scene, Fault> {
    let start = (random(n, 1, 0.0, 3.0), random(n, 2, -2.0, 2.0));
    let energy = |q: &[Var], p: &[Var]| {
        let n = q.len();
        (0..n)
            .map(|i| 0.5 * p[i] * p[i] + 1.0 - (q[(i + 1) % n] - q[i]).cos())
            .sum::<Var>()
    };
    Ok(Scene::closure("rotors-16", start, [0.02, 1.0], energy)?.spread(1.0, 1.0))
}

fn toda(n: usize, amplitude: f64) -> Result<Scene, Fault> {
    let size = amplitude;
    let start = (random(n, 3, -size, size), random(n, 4, -size, size));
    let energy = |q: &[Var], p: &[Var]| {
        let n = q.len();
        (0..n)
            .map(|i| {
                let d = q[(i + 1) % n] - q[i];
                0.5 * p[i] * p[i] + d.exp() - d - 1.0
            })
            .sum::<Var>()
    };
    let scene = Scene::closure("toda-8-small", start, [0.05, 1.8], energy)?;
    Ok(scene.spread(amplitude, amplitude))
}

fn outer_solar_system() -> Result<Scene, Fault> {
    let name = "outer-solar-system";
    let mut scene = Scene::of(name, name, &[], [40.0, 1500.0])?;
    scene.spread[0].fill(0.1);
    scene.spread[1] = scene.p.iter().map(|p| 0.01 * p).collect();
    Ok(scene)
}

/// All of them.
pub(crate) fn all() -> Result<Vec<Scene>, Fault> {
    let swing = || (vec![1.5], vec![0.0]);
    let chaos = || (vec![0.0, 0.1], vec![0.51, 0.15]);
    let plane = || (vec![0.5, 0.0], vec![0.0, 3.0_f64.sqrt()]);
    Ok(vec![
        Scene::closure("pendulum", swing(), [0.1, 2.4], |q, p| {
            0.5 * p[0] * p[0] - q[0].cos()
        })?
        .spread(0.7, 0.7),
        Scene::closure(
            "pendulum-small",
            (vec![0.01], vec![0.0]),
            [0.1, 2.4],
            |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0].cos()),
        )?
        .spread(0.009, 0.01),
        Scene::of("henon-heiles-1/12", "henon-heiles", &[], [0.05, 1.8])?,
        Scene::closure(
            "henon-heiles-chaos",
            chaos(),
            [0.05, 1.8],
            chaotic_henon_heiles(0.0),
        )?
        .spread(0.02, 0.02),
        Scene::closure(
            "henon-heiles-shifted",
            chaos(),
            [0.05, 1.8],
            chaotic_henon_heiles(1e4),
        )?
        .spread(0.02, 0.02),
        kepler("kepler-.05", "0.05", [80.0, 4.0])?,
        kepler("kepler-.3", "0.3", [100.0, 5.0])?,
        kepler("kepler-.6", "0.6", [160.0, 8.0])?,
        kepler("kepler-.9", "0.9", [600.0, 20.0])?.spread(0.005, 0.02),
        Scene::of("double-pendulum", "double-pendulum", &[], [0.008, 0.25])?.spread(0.3, 0.3),
        fpu("fpu-50", "50", [0.01, 1.0])?,
        fpu("fpu-500", "500", [0.002, 0.5])?,
        Scene::of("fput-16", "fput-beta", &[("n", "16")], [0.03, 1.0])?.spread(0.3, 0.3),
        Scene::of("fput-64", "fput-beta", &[("n", "64")], [0.05, 1.2])?.spread(0.3, 0.3),
        rotors(16)?,
        Scene::of("charged-particle", "charged-particle", &[], [0.1, 3.0])?,
        Scene::of("spring-1e4", "spring-pendulum", &[], [0.002, 0.3])?
            .spread(0.01, 0.3)
            .stiff(),
        spring("spring-1e6", 1e6, [2e-4, 0.03])?,
        Scene::closure("relativistic-kepler", plane(), [0.03, 0.7], |q, p| {
            let c = 10.0;
            let square = p[0] * p[0] + p[1] * p[1];
            c * (c * c + square).sqrt() - c * c - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
        })?
        .spread(0.05, 0.05),
        Scene::closure(
            "schwarzschild",
            (vec![100.0, 0.0], vec![0.0, 10.0]),
            [20.0, 600.0],
            |q, p| {
                let f = 1.0 - 2.0 / q[0];
                (f * (1.0 + f * p[0] * p[0] + (p[1] / q[0]).powi(2))).sqrt() - 1.0
            },
        )?
        .spread(3.0, 0.003),
        Scene::of("lennard-jones-7", "lennard-jones", &[], [0.004, 0.1])?.spread(0.02, 0.1),
        outer_solar_system()?,
        Scene::of("dnls-16", "dnls", &[], [0.04, 1.2])?,
        Scene::closure(
            "polynomial-tops",
            (vec![0.8, -0.3], vec![0.4, 0.9]),
            [0.03, 1.2],
            |q, p| {
                let turn = q[0] * p[1] - q[1] * p[0];
                let body = 0.5 * (p[0] * p[0] + 1.5 * p[1] * p[1] + 2.0 * turn * turn);
                body + 0.25 * (q[0] * q[0] + q[1] * q[1]).powi(2) + 0.5 * q[0] * q[0]
            },
        )?
        .spread(0.3, 0.3),
        Scene::closure(
            "gyration-1e4",
            (vec![0.0, 0.01], vec![1.0, 0.0]),
            [2e-5, 2e-3],
            |q, p| {
                let across = (1.0 + q[0] * q[0]) * q[1] * q[1] + p[1] * p[1];
                0.5 * p[0] * p[0] + across / (2.0 * 0.01 * 0.01)
            },
        )?
        .spread(0.3, 0.01)
        .spread_from(1, 0.01)
        .stiff(),
        toda(8, 0.1)?,
        Scene::of("sine-gordon-64", "sine-gordon", &[], [0.05, 1.2])?,
        Scene::of("n-body-8", "n-body", &[], [0.01, 0.3])?.spread(0.01, 0.01),
    ])
}

fn fpu(name: &'static str, omega: &'static str, steps: [f64; 2]) -> Result<Scene, Fault> {
    let scene = Scene::of(name, "fpu", &[("omega", omega)], steps)?;
    let omega: f64 = omega.parse().map_err(|_| Fault::Start(name))?;
    Ok(scene.spread(0.3, 0.3).spread_from(3, 0.7 / omega).stiff())
}
