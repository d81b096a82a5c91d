//! The Python peers: one long-lived worker, spoken to in lines of JSON, so that its runs can stand between
//! ours.

use crate::contestant::{Contestant, Ladder, Ran};
use crate::task::Task;
use equip::prelude::*;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

/// The worker process.
#[derive(Debug)]
pub struct Worker {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Worker {
    /// Starts the worker with the interpreter of the virtual environment that `setup` makes.
    ///
    /// # Errors
    /// If there is none.
    pub fn start(home: &Path) -> Result<Self, String> {
        let python = home.join("venv/bin/python");
        let mut child = Command::new(&python)
            .arg(home.join("python/worker.py"))
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| {
                format!(
                    "{}: {e}; make it with benches/peers/setup",
                    python.display()
                )
            })?;
        let input = child.stdin.take();
        let output = child.stdout.take().ok_or("the worker has no output")?;
        Ok(Worker {
            child,
            input,
            output: BufReader::new(output),
        })
    }

    /// The Python programs with their versions.
    ///
    /// # Errors
    /// If the worker is gone.
    pub fn versions(&mut self) -> Result<Value, String> {
        self.ask(&json!({"peer": "versions"}))
    }

    fn ask(&mut self, request: &Value) -> Result<Value, String> {
        let input = self.input.as_mut().ok_or("the worker was closed")?;
        writeln!(input, "{request}").map_err(|e| format!("the worker is gone: {e}"))?;
        let mut line = String::new();
        self.output
            .read_line(&mut line)
            .map_err(|e| e.to_string())?;
        let answer: Value =
            serde_json::from_str(&line).map_err(|e| format!("the worker said {line:?}: {e}"))?;
        match answer.get("error").and_then(Value::as_str) {
            Some(error) => Err(error.to_owned()),
            None => Ok(answer),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // At the end of its input the worker ends.
        self.input = None;
        let _ = self.child.wait();
    }
}

/// A Python peer on a task.
#[derive(Debug)]
pub struct Remote {
    worker: Rc<RefCell<Worker>>,
    peer: &'static str,
    variant: &'static str,
    ladder: Ladder,
    masses: Vec<f64>,
    request: Value,
}

impl Remote {
    fn boxed(
        worker: &Rc<RefCell<Worker>>,
        task: &Task,
        peer: &'static str,
        variant: &'static str,
        ladder: Ladder,
    ) -> Box<dyn Contestant> {
        let parameters = match task.system {
            "outer-solar-system" => crate::problem::GM.to_vec(),
            "pythagorean" => task.masses.iter().step_by(2).copied().collect(),
            _ => task.parameters.clone(),
        };
        let velocities = task.velocities();
        let request = json!({
            "key": format!("{} {peer} {variant}", task.name),
            "peer": peer,
            "variant": variant,
            "system": task.system,
            "parameters": parameters,
            "q": task.q,
            "v": velocities,
            "end": task.end,
            "turn": 5e-3,
            "repeats": 9,
        });
        Box::new(Remote {
            worker: Rc::clone(worker),
            peer,
            variant,
            ladder,
            masses: task.masses.clone(),
            request,
        })
    }
}

/// The Python peers that can do a task.
pub fn contestants(worker: &Rc<RefCell<Worker>>, task: &Task) -> Vec<Box<dyn Contestant>> {
    let tolerances = Ladder::tolerances;
    let mut all = Vec::new();
    let mut add =
        |peer, variant, ladder| all.push(Remote::boxed(worker, task, peer, variant, ladder));
    if task.extended() {
        add("heyoka", "long double", tolerances(10, 20));
        add("heyoka", "real128", tolerances(10, 34));
        return all;
    }
    add("heyoka", "default", tolerances(5, 17));
    add("heyoka", "high accuracy", tolerances(9, 17));
    if task.gravity() {
        add("rebound", "IAS15", tolerances(1, 12));
    }
    if task.system == "outer-solar-system" {
        for variant in ["WHFast", "WHFast lazy", "WHFast modifiedkick"] {
            add("rebound", variant, Ladder::steps(200.0, 40_000.0));
        }
    }
    add("scipy", "DOP853", tolerances(6, 13));
    all
}

impl Contestant for Remote {
    fn program(&self) -> &str {
        self.peer
    }

    fn method(&self) -> String {
        self.variant.into()
    }

    fn ladder(&self) -> Ladder {
        self.ladder
    }

    fn run(&mut self, setting: f64) -> Result<Ran, String> {
        self.request["setting"] = json!(setting);
        let answer = self.worker.borrow_mut().ask(&self.request)?;
        let read = |x: &Value| x.as_str().and_then(|x| DoubleDouble::decimal(x).ok());
        let numbers = |name: &str| -> Option<Vec<DoubleDouble>> {
            answer[name].as_array()?.iter().map(read).collect()
        };
        let (Some(mut end), Some(v)) = (numbers("q"), numbers("v")) else {
            return Err(format!("{} left no state", self.peer));
        };
        let momentum = |(v, &m): (DoubleDouble, &f64)| v * DoubleDouble::exact(m);
        end.extend(v.into_iter().zip(&self.masses).map(momentum));
        Ok(Ran {
            seconds: answer["seconds"].as_f64().unwrap_or(f64::NAN),
            end,
            steps: answer["steps"].as_u64(),
        })
    }
}
