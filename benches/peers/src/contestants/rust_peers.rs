//! Rust crates: ode_solvers, differential-equations, diffsol, with the right-hand side by hand.

use crate::clock::turn;
use crate::contestant::{Contestant, Ladder, Ran};
use crate::problem::Problem;
use crate::task::Task;
use differential_equations::prelude as de;
use diffsol::{NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason, VectorCommon};
use equip::prelude::DoubleDouble;
use equip::scalar::Float;
use ode_solvers::{DVector, Dop853, SVector, dop_shared::OutputType};

/// Steps after which a peer gives up.
const MOST_STEPS: u32 = 20_000_000;

/// The Rust peers that can do a task.
pub fn contestants<P: Problem>(problem: &P, task: &Task) -> Vec<Box<dyn Contestant>> {
    let n = 2 * task.q.len();
    let ladder = Ladder::tolerances(6, 14);
    let mut all: Vec<Box<dyn Contestant>> = Vec::new();
    macro_rules! fixed {
        ($n:literal) => {{
            all.push(Box::new(OdeSolvers::<P, $n>::new(problem, task, ladder)));
            all.push(Box::new(DifferentialEquations::<P, $n>::new(
                problem, task, ladder,
            )));
        }};
    }
    match n {
        4 => fixed!(4),
        12 => fixed!(12),
        36 => fixed!(36),
        _ => all.push(Box::new(OdeSolvers::<P, 0>::new(problem, task, ladder))),
    }
    // Order 5: nothing to be had below 1e-10 in the time others take.
    all.push(Box::new(Diffsol::new(
        problem,
        task,
        Ladder::tolerances(6, 12),
    )));
    all
}

/// What every peer here starts from.
#[derive(Clone)]
struct Start<P> {
    problem: P,
    y: Vec<f64>,
    end: f64,
    ladder: Ladder,
}

impl<P: Problem> Start<P> {
    fn new(problem: &P, task: &Task, ladder: Ladder) -> Self {
        Start {
            problem: problem.clone(),
            y: [task.q.clone(), task.p.clone()].concat(),
            end: task.end,
            ladder,
        }
    }
}

fn ran(seconds: f64, end: &[f64], steps: Option<u64>) -> Ran {
    Ran {
        seconds,
        end: end.iter().map(|&x| DoubleDouble::exact(x)).collect(),
        steps,
    }
}

/// ode_solvers: DOP853 on vectors of fixed length N, or of length found at run time if N is 0.
struct OdeSolvers<P, const N: usize>(Start<P>);

impl<P: Problem, const N: usize> OdeSolvers<P, N> {
    fn new(problem: &P, task: &Task, ladder: Ladder) -> Self {
        OdeSolvers(Start::new(problem, task, ladder))
    }
}

#[derive(Clone)]
struct Slope<P>(P);

impl<P: Problem, const N: usize> ode_solvers::System<f64, SVector<f64, N>> for Slope<P> {
    fn system(&self, _t: f64, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        self.0.slope(y.as_slice(), dy.as_mut_slice());
    }
}

impl<P: Problem> ode_solvers::System<f64, DVector<f64>> for Slope<P> {
    fn system(&self, _t: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        self.0.slope(y.as_slice(), dy.as_mut_slice());
    }
}

macro_rules! dop853 {
    ($start:expr, $y:expr, $tolerance:expr) => {{
        let (start, tolerance) = ($start, $tolerance);
        let prepare = || {
            Dop853::from_param(
                Slope(start.problem.clone()),
                0.0,
                start.end,
                start.end,
                $y,
                tolerance,
                tolerance,
                0.9,
                0.0,
                0.333,
                6.0,
                start.end,
                0.0,
                MOST_STEPS,
                u32::MAX,
                OutputType::Sparse,
            )
        };
        let (seconds, solver) = turn(prepare, |s| {
            s.integrate().map(drop).map_err(|e| e.to_string())
        })?;
        match (solver.x_out().last(), solver.y_out().last()) {
            (Some(&t), Some(y)) if t == start.end => Ok(ran(seconds, y.as_slice(), None)),
            (t, _) => Err(format!("ended at {t:?}")),
        }
    }};
}

impl<P: Problem, const N: usize> Contestant for OdeSolvers<P, N> {
    fn program(&self) -> &str {
        "ode_solvers"
    }

    fn method(&self) -> String {
        "DOP853".into()
    }

    fn ladder(&self) -> Ladder {
        self.0.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        let start = &self.0;
        if N == 0 {
            dop853!(start, DVector::from_vec(start.y.clone()), setting)
        } else {
            dop853!(
                start,
                SVector::<f64, N>::from_column_slice(&start.y),
                setting
            )
        }
    }
}

/// differential-equations: DOP853 on arrays of fixed length.
struct DifferentialEquations<P, const N: usize>(Start<P>);

impl<P: Problem, const N: usize> DifferentialEquations<P, N> {
    fn new(problem: &P, task: &Task, ladder: Ladder) -> Self {
        DifferentialEquations(Start::new(problem, task, ladder))
    }
}

impl<P: Problem, const N: usize> de::ODE<f64, [f64; N]> for Slope<P> {
    fn diff(&self, _t: f64, y: &[f64; N], dy: &mut [f64; N]) {
        self.0.slope(y, dy);
    }
}

impl<P: Problem, const N: usize> Contestant for DifferentialEquations<P, N> {
    fn program(&self) -> &str {
        "differential-equations"
    }

    fn method(&self) -> String {
        "DOP853".into()
    }

    fn ladder(&self) -> Ladder {
        self.0.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        let start = &self.0;
        let system = Slope(start.problem.clone());
        let mut y = [0.0; N];
        y.copy_from_slice(&start.y);
        let prepare = || None;
        let (seconds, solution) = turn(prepare, |solution| {
            let method = de::ExplicitRungeKutta::dop853()
                .rtol(setting)
                .atol(setting)
                .max_steps(MOST_STEPS as usize);
            let solved = de::IVP::ode(&system, 0.0, start.end, y)
                .t_eval([start.end])
                .method(method)
                .solve();
            *solution = Some(solved.map_err(|e| format!("{e:?}"))?);
            Ok::<(), String>(())
        })?;
        let solution = solution.ok_or("no solution")?;
        match solution.last() {
            Ok((&t, end)) if t == start.end => Ok(ran(seconds, end, None)),
            _ => Err("it did not reach the end".into()),
        }
    }
}

/// diffsol: Tsit5, the explicit method it has, on nalgebra vectors.
struct Diffsol<P>(Start<P>);

impl<P: Problem> Diffsol<P> {
    fn new(problem: &P, task: &Task, ladder: Ladder) -> Self {
        Diffsol(Start::new(problem, task, ladder))
    }
}

impl<P: Problem> Contestant for Diffsol<P> {
    fn program(&self) -> &str {
        "diffsol"
    }

    fn method(&self) -> String {
        "Tsit45".into()
    }

    fn ladder(&self) -> Ladder {
        self.0.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        let start = &self.0;
        let (system, y) = (start.problem.clone(), start.y.clone());
        let n = y.len();
        let text = |e: diffsol::error::DiffsolError| e.to_string();
        let problem = OdeBuilder::<NalgebraMat<f64>>::new()
            .rtol(setting)
            .atol([setting])
            .rhs(move |x, _p, _t, dx| system.slope(x, dx))
            .init(move |_p, _t, x| x.copy_from_slice(&y), n)
            .build()
            .map_err(text)?;
        let prepare = || {
            let mut solver = problem.tsit45()?;
            solver.set_stop_time(start.end)?;
            Ok(solver)
        };
        let (seconds, solver) = turn(
            prepare,
            |solver: &mut Result<_, diffsol::error::DiffsolError>| {
                let solver = solver.as_mut().map_err(|e| e.to_string())?;
                loop {
                    match solver.step().map_err(|e| e.to_string())? {
                        OdeSolverStopReason::TstopReached => return Ok::<(), String>(()),
                        _ => continue,
                    }
                }
            },
        )?;
        let solver = solver.map_err(text)?;
        Ok(ran(seconds, solver.state().y.inner().as_slice(), None))
    }
}
