//! [`Watch`]: the observer of a run, which writes the table, keeps what is drawn and shows the progress.

use crate::draw::samples::Picture;
use crate::fault::Fault;
use crate::run::progress::Progress;
use crate::run::signals;
use crate::text::say;
use crate::write::checkpoint::Saver;
use crate::write::csv::{Mark, Row, Rows};
use crate::write::lock::{self, unwritten};
use crate::write::outputs::Output;
use equip_integrate::{Checkpoint, Observer, Run, StepView};
use equip_scalar::Float;
use std::fs::File;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Files are made at the first step: late enough to leave them alone on bad input, early enough to miss no
/// hour's work.
#[derive(Debug)]
pub(crate) struct Watch<'a, T> {
    pub(crate) start: (&'a [T], &'a [T]),
    end: T,
    /// The step of a fixed grid of time.
    pub(crate) grid: Option<T>,
    /// Where the table goes, and how far it is.
    pub(crate) out: Option<(PathBuf, Mark)>,
    pub(crate) plot: Option<PathBuf>,
    pub(crate) picture: Picture,
    /// Whether there are Lyapunov exponents to see.
    pub(crate) follows_chaos: bool,
    pub(crate) progress: Progress,
    rows: Option<Rows>,
    pub(crate) drawing: Option<Output>,
    /// Keeps checkpoints.
    pub(crate) saver: Option<Saver>,
    /// Of a run that goes on from a checkpoint.
    pub(crate) resumed: Option<Resumed>,
    at_end: bool,
    /// Whether a run can be gone on with from here, and whether a run of this length has no other such place
    /// before it.
    is_on_grid: bool,
    is_last_place: bool,
    fault: Option<Fault>,
    begun: bool,
}

/// What a run that goes on from a checkpoint has of the one before.
#[derive(Debug, Default)]
pub(crate) struct Resumed {
    /// Its table, locked and checked.
    pub(crate) table: Option<File>,
    /// What the user is told when the run has begun.
    pub(crate) notes: Vec<String>,
}

impl<'a, T: Float> Watch<'a, T> {
    /// Of a run from `start` to the time `end`.
    pub(crate) fn new(
        start: (&'a [T], &'a [T]),
        end: T,
        picture: Picture,
        progress: Progress,
    ) -> Self {
        Watch {
            start,
            end,
            grid: None,
            out: None,
            plot: None,
            picture,
            follows_chaos: false,
            progress,
            rows: None,
            drawing: None,
            saver: None,
            resumed: None,
            at_end: false,
            is_on_grid: true,
            is_last_place: false,
            fault: None,
            begun: false,
        }
    }

    /// Makes the files and puts the initial state in.
    fn begin(&mut self) -> Result<(), Fault> {
        self.begun = true;
        let (q, p) = self.start;
        if self.resumed.is_none() {
            self.picture.path.see_state(0, q, p);
        }
        // All files are had before one of them is emptied.
        let table = self
            .resumed
            .as_mut()
            .and_then(|resumed| resumed.table.take());
        let (is_new, table) = match (table, &self.out) {
            (None, Some((path, _))) => (true, Some(lock::open(path)?)),
            (table, _) => (false, table),
        };
        self.drawing = self.plot.as_deref().map(Output::open).transpose()?;
        if let (Some(table), Some((path, mark))) = (table, &self.out) {
            let rows = if is_new {
                lock::empty(&table).and_then(|()| Rows::start(table, mark.clone(), (q, p)))
            } else {
                Rows::go_on(table, mark.clone())
            };
            self.rows = Some(rows.map_err(|e| unwritten_rows(path, e))?);
        }
        if let Some(resumed) = &self.resumed {
            resumed.notes.iter().for_each(|note| say(note));
        }
        Ok(())
    }

    fn see(&mut self, view: &StepView<'_, T>) -> Result<(), Fault> {
        if !self.begun {
            self.begin()?;
        }
        // The run begins at time 0.
        let (left, size) = (self.end.abs() - view.time.abs(), view.step.abs());
        self.at_end = left <= T::int(0);
        (self.is_on_grid, self.is_last_place) = match self.grid {
            None => (true, self.at_end),
            // The last step of a run may be shorter than those of the grid.
            Some(h) => (size == h.abs(), left <= h.abs()),
        };
        self.progress.see(view.index);
        let picture = &mut self.picture;
        (picture.path).see_state(view.index, view.q, view.p);
        if let Some(energy_error) = view.energy_error {
            (picture.energy).see(view.time.to_f64(), energy_error.to_f64());
        }
        if let Some(chaos) = &view.chaos {
            let time = view.time.abs();
            let seen = [time, chaos.lyapunov, time, chaos.megno];
            (picture.chaos).see(view.index, |i| seen[i].to_f64());
        }
        if let (Some(rows), Some((path, _))) = (&mut self.rows, &self.out) {
            let row = Row {
                index: view.index,
                time: view.time,
                q: view.q,
                p: view.p,
                energy_error: view.energy_error,
                outcome: view.outcome.label(),
                chaos: view.chaos,
            };
            (rows.step(row, self.at_end)).map_err(|e| unwritten_rows(path, e))?;
        }
        Ok(())
    }

    /// Rows first: what a checkpoint speaks of must be in the table, and on the disk.
    fn save(&mut self, checkpoint: Checkpoint) -> Result<(), Fault> {
        let mark = match (&mut self.rows, &self.out) {
            (Some(rows), Some((path, _))) => {
                Some(rows.sync().map_err(|e| unwritten_rows(path, e))?)
            }
            _ => None,
        };
        let picture = self.plot.is_some().then(|| self.picture.clone());
        match &mut self.saver {
            Some(saver) => saver.save(checkpoint, mark, picture),
            None => Ok(()),
        }
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
        if let (Some(rows), Some((path, _))) = (self.rows.take(), &self.out) {
            let last = Row {
                index: run.certificate().counts.steps,
                time,
                q,
                p,
                energy_error: run.energy_errors().last().copied(),
                outcome: run.outcomes().last().map_or("", |outcome| outcome.label()),
                chaos: run.certificate().chaos,
            };
            rows.finish(last).map_err(|e| unwritten_rows(path, e))?;
        }
        Ok(())
    }
}

impl<T: Float> Observer<T> for Watch<'_, T> {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        let seen = self.see(view);
        if signals::caught().is_some() {
            let _ = self.go_on_if(seen);
            return ControlFlow::Break(());
        }
        self.go_on_if(seen)
    }

    fn wants_checkpoint(&mut self) -> bool {
        let now = self.is_last_place || signals::caught().is_some();
        let is_due = |saver: &Saver| now || saver.is_due();
        self.fault.is_none() && self.is_on_grid && self.saver.as_ref().is_some_and(is_due)
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        let saved = self.save(checkpoint);
        self.go_on_if(saved)
    }
}

/// A fault of the table, which may have fewer rows.
fn unwritten_rows(path: &Path, source: io::Error) -> Fault {
    match unwritten(path, source) {
        Fault::NoRoom { path, source, .. } => Fault::NoRoom {
            path,
            source,
            advice: ", or write less often with --every",
        },
        other => other,
    }
}
