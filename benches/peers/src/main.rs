//! equip beside other integrators: CPU time to reach an accuracy, interleaved on one core.
//!
//! The rules are in docs/compare.md.

mod clock;
mod contestant;
mod contestants;
mod problem;
mod race;
mod scenes;
mod table;
mod task;
mod versions;

use clap::Parser;
use contestant::Contestant;
use contestants::ours::{Ours, Solver, Variant};
use equip::scalar::Float;
use equip::prelude::*;
use problem::Problem;
use scenes::NAMES;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use task::{Sizes, Task, WithTask};

/// equip beside other integrators: CPU time to reach an accuracy, interleaved on one core
#[derive(Debug, Parser)]
struct Args {
    /// Scenes whose name contains one of these; all if none is named
    scenes: Vec<String>,
    /// Rounds of interleaved repeats
    #[arg(long, default_value_t = 7)]
    rounds: usize,
    /// Core to stay on
    #[arg(long, default_value_t = 0)]
    core: usize,
    /// Contestants whose name contains one of these, like heyoka or "equip closure"
    #[arg(long)]
    only: Vec<String>,
    /// Stages of ours; four more in double-double
    #[arg(long, value_delimiter = ',', default_values_t = [4, 6, 8, 10, 12, 16])]
    stages: Vec<usize>,
    /// How our stages are solved
    #[arg(long, value_delimiter = ',', default_values = ["automatic", "fixed-point"])]
    solver: Vec<Solver>,
    /// How our steps are chosen; each scene leaves out what is hopeless there
    #[arg(long, value_delimiter = ',', default_values = ["equal", "variable"])]
    steps: Vec<Sizes>,
    /// Fewer variants of ours, fewer rounds: the closure by fixed-point iteration with 6, 8 and 12 stages,
    /// three rounds
    #[arg(long)]
    quick: bool,
    /// Where to write peers.csv, peers.json and peers.md
    #[arg(long, default_value = "out")]
    out: PathBuf,
}

impl Args {
    /// The variants of EQUIP to be run on a task.
    fn variants(&self, task: &Task) -> Vec<Variant> {
        let add = if task.extended() { 4 } else { 0 };
        let mut all = Vec::new();
        for &sizes in self.steps.iter().filter(|s| task.sizes.contains(s)) {
            for &solver in &self.solver {
                all.extend(self.stages.iter().map(|s| Variant {
                    stages: s + add,
                    sizes,
                    solver,
                }));
            }
        }
        all
    }
}

fn ours<T: Float>(
    h: &Rc<Hamiltonian>,
    route: &'static str,
    variant: Variant,
    task: &Task,
) -> Box<dyn Contestant> {
    Box::new(Ours::<T>::new(h, route, variant, task))
}

struct Run {
    args: Args,
    worker: Option<Rc<RefCell<contestants::python::Worker>>>,
    /// Programs and their versions.
    versions: Value,
    csv: String,
    markdown: String,
    scenes: Vec<Value>,
}

impl WithTask for Run {
    fn with<P: Problem>(&mut self, problem: P, task: Task) -> Result<(), String> {
        let mut all = self.peers(&task);
        all.extend(contestants::rust_peers::contestants(&problem, &task));
        if task.sizes.contains(&Sizes::Equal) {
            all.extend(contestants::composition::contestants(&problem, &task));
        }
        let closure = Rc::new(problem.hamiltonian().map_err(|e| e.to_string())?);
        let by_hand = problem.with_gradient_by_hand().map_err(|e| e.to_string())?;
        by_hand
            .check_gradient(&[task.q.clone(), task.p.clone()].concat())
            .map_err(|e| e.to_string())?;
        let by_hand = Rc::new(by_hand);
        for variant in self.args.variants(&task) {
            all.push(ours::<f64>(&closure, "closure", variant, &task));
            if !self.args.quick {
                all.push(ours::<f64>(&by_hand, "by hand", variant, &task));
            }
        }
        self.race(&task, all)
    }

    fn with_extended<P: Problem>(&mut self, problem: P, task: Task) -> Result<(), String> {
        let mut all = self.peers(&task);
        let closure = Rc::new(problem.hamiltonian().map_err(|e| e.to_string())?);
        for variant in self.args.variants(&task) {
            all.push(ours::<DoubleDouble>(&closure, "closure", variant, &task));
        }
        self.race(&task, all)
    }
}

impl Run {
    /// The Python peers, if there are any.
    fn peers(&self, task: &Task) -> Vec<Box<dyn Contestant>> {
        let worker = self.worker.as_ref();
        worker.map_or_else(Vec::new, |worker| {
            contestants::python::contestants(worker, task)
        })
    }

    fn race(&mut self, task: &Task, mut all: Vec<Box<dyn Contestant>>) -> Result<(), String> {
        let wanted = &self.args.only;
        all.retain(|c| {
            let name = format!("{} {}", c.program(), c.method());
            wanted.is_empty() || wanted.iter().any(|w| name.contains(w.as_str()))
        });
        let lanes = race::race(task, all, self.args.rounds, |text| eprintln!("{text}"));
        print!("{}", table::text(task, &lanes));
        self.csv.push_str(&table::csv(task, &lanes));
        self.markdown.push_str(&table::markdown(task, &lanes));
        self.scenes.push(table::json(task, &lanes));
        self.write()
    }

    /// Writes what there is; after every scene, so that an end before the last one loses little.
    fn write(&self) -> Result<(), String> {
        let text = |e: std::io::Error| format!("{}: {e}", self.args.out.display());
        std::fs::create_dir_all(&self.args.out).map_err(text)?;
        let csv = format!("{}{}", table::HEADER, self.csv);
        let table = format!("{}{}", table::MARKDOWN_HEADER, self.markdown);
        std::fs::write(self.args.out.join("peers.md"), table).map_err(text)?;
        std::fs::write(self.args.out.join("peers.csv"), csv).map_err(text)?;
        let document =
            json!({"version": 1, "cpu": cpu(), "versions": self.versions, "scenes": self.scenes});
        let document = serde_json::to_string_pretty(&document).map_err(|e| e.to_string())?;
        std::fs::write(self.args.out.join("peers.json"), document + "\n").map_err(text)
    }
}

/// What the system says its processor is.
fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(": "))
        .map_or("unknown".into(), |(_, name)| name.to_owned())
}

fn main() -> Result<(), String> {
    let mut args = Args::parse();
    if args.quick {
        (args.stages, args.solver, args.rounds) = (vec![6, 8, 12], vec![Solver::FixedPoint], 3);
    }
    clock::pin(args.core)
        .map_err(|e| format!("core {}: {e}; choose another with --core", args.core))?;
    let home = Path::new(env!("CARGO_MANIFEST_DIR"));
    let worker = match contestants::python::Worker::start(home) {
        Ok(worker) => Some(Rc::new(RefCell::new(worker))),
        Err(reason) => {
            eprintln!("without the Python peers: {reason}");
            None
        }
    };
    let versions = versions::of_all(worker.as_ref());
    eprintln!("{versions}");
    let chosen = |name: &&&str| {
        args.scenes.is_empty() || args.scenes.iter().any(|s| name.contains(s.as_str()))
    };
    let names: Vec<&'static str> = NAMES.iter().filter(chosen).copied().collect();
    let mut run = Run {
        args,
        worker,
        versions,
        csv: String::new(),
        markdown: String::new(),
        scenes: Vec::new(),
    };
    for name in names {
        scenes::visit(name, &mut run)?;
    }
    Ok(())
}
