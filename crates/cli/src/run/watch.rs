//! [`Watch`]: the observer of a run, which writes the table, keeps what is drawn and shows the progress.

use crate::draw::samples::{Envelope, Path};
use crate::fault::Fault;
use crate::run::progress::Progress;
use crate::write::csv::{Row, Rows};
use crate::write::saver::{self, Saver};
use equip_integrate::{Checkpoint, Observer, Run, StepView};
use equip_scalar::Float;
use std::fs::File;
use std::io::BufWriter;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Files are made at the first step: late enough to leave them alone on bad input, early enough to miss no hour's work.
#[derive(Debug)]
pub(crate) struct Watch<'a, T> {
    pub(crate) start: (&'a [T], &'a [T]),
    pub(crate) out: Option<PathBuf>,
    pub(crate) every: u64,
    pub(crate) plot: Option<PathBuf>,
    pub(crate) path: Path,
    pub(crate) energy: Envelope,
    /// Whether there are Lyapunov exponents to see, and what was seen of them: t, λ, t, MEGNO.
    pub(crate) follows_chaos: bool,
    pub(crate) chaos: Path,
    pub(crate) progress: Progress,
    rows: Option<Rows<BufWriter<File>>>,
    pub(crate) drawing: Option<File>,
    /// Keeps checkpoints.
    pub(crate) saver: Option<Saver>,
    /// Number and time of the step that the run goes on from.
    pub(crate) resumed: Option<(u64, T)>,
    fault: Option<Fault>,
    begun: bool,
}

impl<'a, T: Float> Watch<'a, T> {
    pub(crate) fn new(start: (&'a [T], &'a [T]), path: Path, progress: Progress) -> Self {
        Watch {
            start,
            out: None,
            every: 1,
            plot: None,
            path,
            energy: Envelope::default(),
            follows_chaos: false,
            chaos: Path::new(vec![0, 1, 2, 3]),
            progress,
            rows: None,
            drawing: None,
            saver: None,
            resumed: None,
            fault: None,
            begun: false,
        }
    }

    /// Makes the files and puts the initial state in.
    fn begin(&mut self) -> Result<(), Fault> {
        self.begun = true;
        let (q, p) = self.start;
        self.path.see(0, |i| component(q, p, i));
        let write = |path: &PathBuf, source| Fault::Write {
            path: path.clone(),
            source,
        };
        if let Some(path) = &self.plot {
            self.drawing = Some(File::create(path).map_err(|e| write(path, e))?);
        }
        if let Some(path) = &self.out {
            self.rows = Some(
                match self.resumed {
                    Some(step) if path.exists() => {
                        Rows::go_on(path, self.every, step, self.follows_chaos)
                    }
                    _ => File::create(path).and_then(|file| {
                        let file = BufWriter::new(file);
                        Rows::start(file, self.every, (q, p), self.follows_chaos)
                    }),
                }
                .map_err(|e| write(path, e))?,
            );
        }
        Ok(())
    }

    fn see(&mut self, view: &StepView<'_, T>) -> Result<(), Fault> {
        if !self.begun {
            self.begin()?;
        }
        self.progress.see(view.index);
        self.path.see(view.index, |i| component(view.q, view.p, i));
        if let Some(defect) = view.energy_defect {
            self.energy.see(view.time.to_f64(), defect.to_f64());
        }
        if let Some(chaos) = &view.chaos {
            let seen = [view.time, chaos.lyapunov, view.time, chaos.megno];
            self.chaos.see(view.index, |i| seen[i].to_f64());
        }
        if let (Some(rows), Some(path)) = (&mut self.rows, &self.out) {
            let row = Row {
                index: view.index,
                time: view.time,
                q: view.q,
                p: view.p,
                energy_defect: view.energy_defect,
                outcome: view.outcome.label(),
                chaos: view.chaos,
            };
            rows.step(row).map_err(|source| Fault::Write {
                path: path.clone(),
                source,
            })?;
        }
        Ok(())
    }

    /// Rows first: what a checkpoint stands for must be in the table.
    fn save(&mut self, checkpoint: &Checkpoint) -> Result<(), Fault> {
        if let (Some(rows), Some(path)) = (&mut self.rows, &self.out) {
            rows.flush().map_err(|source| Fault::Write {
                path: path.clone(),
                source,
            })?;
        }
        self.saver
            .as_mut()
            .map_or(Ok(()), |saver| saver.save(checkpoint))
    }

    fn go_on_if(&mut self, done: Result<(), Fault>) -> ControlFlow<()> {
        match done {
            Ok(()) => ControlFlow::Continue(()),
            Err(fault) => {
                self.fault = Some(fault);
                ControlFlow::Break(())
            }
        }
    }

    /// Ends the table with the last state of `run`.
    ///
    /// # Errors
    /// Every fault of writing, also those that ended the run early.
    pub(crate) fn finish(&mut self, run: &Run<T>) -> Result<(), Fault> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        if !self.begun {
            self.begin()?;
        }
        let (time, q, p) = run.last();
        if let (Some(rows), Some(path)) = (self.rows.take(), &self.out) {
            let last = Row {
                index: run.certificate().counts.steps,
                time,
                q,
                p,
                energy_defect: run.energy_defects().last().copied(),
                outcome: run.outcomes().last().map_or("", |outcome| outcome.label()),
                chaos: run.certificate().chaos,
            };
            rows.finish(last).map_err(|source| Fault::Write {
                path: path.clone(),
                source,
            })?;
        }
        Ok(())
    }
}

impl<T: Float> Observer<T> for Watch<'_, T> {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        let seen = self.see(view);
        if saver::interrupted() {
            let _ = self.go_on_if(seen);
            return ControlFlow::Break(());
        }
        self.go_on_if(seen)
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.fault.is_none() && self.saver.as_ref().is_some_and(Saver::is_due)
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        let saved = self.save(&checkpoint);
        self.go_on_if(saved)
    }
}

/// Component i of y = (q, p) as a double.
fn component<T: Float>(q: &[T], p: &[T], i: usize) -> f64 {
    let y = if i < q.len() { q[i] } else { p[i - q.len()] };
    y.to_f64()
}
