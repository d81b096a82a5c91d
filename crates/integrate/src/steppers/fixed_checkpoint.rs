//! Checkpoints of [`Stepper`]s, the part that fixed and variable steps share.

use crate::checkpoints::checkpoint::{Checkpoint, FORMAT};
use crate::checkpoints::exact::Exact;
use crate::error::IntegrateError;
use crate::options::fixed_step::FixedStep;
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_solver::{Damaged, Invariant, SolverMemory};
use std::time::{Duration, Instant};

impl<T: Float> FixedStep<T> {
    /// The run that `checkpoint` was made of, at the step where it was made. Bit for bit the same as if it had not stopped.
    ///
    /// # Errors
    /// When the checkpoint was made in another float type, with another method, other options or another H, or is damaged; every fault of [`start`](Self::start).
    pub fn resume<H: System>(
        &self,
        system: &H,
        checkpoint: &Checkpoint,
    ) -> Result<Stepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        self.resume_as(system, checkpoint, self.fingerprint())
    }

    /// What has to be the same again.
    pub(crate) fn fingerprint(&self) -> String {
        format!("step {:?}; {}", self.h, self.common_fingerprint())
    }

    /// The same but for the steps.
    pub(crate) fn common_fingerprint(&self) -> String {
        let names = |x: &[Invariant]| {
            let names: Vec<_> = x.iter().map(Invariant::name).collect();
            names.join(", ")
        };
        format!(
            "{}; {:?}, alpha_bound {:?}, {} halvings, {:?}, measured {}; kept: {}; watched: {}",
            self.method,
            self.reach,
            self.alpha_bound,
            self.max_halvings,
            self.preconditioner,
            self.measure_energy,
            names(&self.kept),
            names(&self.invariants),
        )
    }

    pub(crate) fn resume_as<H: System>(
        &self,
        system: &H,
        checkpoint: &Checkpoint,
        fingerprint: String,
    ) -> Result<Stepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let same = |what, stored: &str, now: &str| {
            if stored == now {
                return Ok(());
            }
            Err(IntegrateError::CheckpointMismatch {
                what,
                stored: stored.to_owned(),
                now: now.to_owned(),
            })
        };
        same(
            "format",
            &checkpoint.format.to_string(),
            &FORMAT.to_string(),
        )?;
        same("float type", &checkpoint.precision, T::NAME)?;
        same("method or options", &checkpoint.options, &fingerprint)?;
        let mut y = vec![T::int(0); checkpoint.high.len()];
        Exact::read_all(&checkpoint.high, &mut y, "the state")?;
        let (q, p) = y.split_at(y.len() / 2);
        let mut stepper = self.start(system, q, p, checkpoint.start.read()?)?;
        let energy = Exact::of(stepper.core.energy_mut().value(&y));
        if energy != checkpoint.energy_now {
            return Err(IntegrateError::CheckpointOtherEnergy {
                time: checkpoint.time.read()?,
            });
        }
        stepper.restore(checkpoint)?;
        Ok(stepper)
    }
}

impl<T: Float, E: Evaluate<T>> Stepper<T, E> {
    /// The run as it is now, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let fingerprint = self.fingerprint.clone();
        self.save(fingerprint)
    }

    pub(crate) fn save(&mut self, options: String) -> Checkpoint {
        let memory = self.core.memory();
        let parts = memory.parts().iter();
        let solver = parts
            .map(|(name, numbers)| (name.clone(), Exact::all(numbers)))
            .collect();
        let energy_now = Exact::of(self.core.energy_mut().value(&self.y.hi));
        let defects = self
            .energy
            .iter()
            .chain(self.watched.iter().map(|w| &w.defect));
        let seconds = self.begun.elapsed().as_secs_f64();
        Checkpoint {
            format: FORMAT,
            precision: T::NAME.to_owned(),
            options,
            start: Exact::of(self.t0),
            time: Exact::of(self.time),
            time_low: Exact::default(),
            index: self.index,
            high: Exact::all(&self.y.hi),
            low: Exact::all(&self.y.lo),
            energy_reference: Exact::of(self.h_ref),
            defects: defects
                .map(|d| [d.start, d.max, d.end].map(Exact::of))
                .collect(),
            in_floors: self.in_floors.map(Exact::of),
            floor: self.floor.map(Exact::of),
            alpha_range: self
                .alpha_range
                .iter()
                .map(|&(a, b)| [a, b].map(Exact::of))
                .collect(),
            last_step: Exact::of(self.last.0),
            last_outcome: self.last.1,
            counts: *self.core.counts(),
            seconds,
            solver,
            control: None,
            chaos: None,
            energy_now,
        }
    }

    fn restore(&mut self, from: &Checkpoint) -> Result<(), IntegrateError<T>> {
        let damaged = |what| IntegrateError::CheckpointDamaged { what };
        Exact::read_all(&from.high, &mut self.y.hi, "the state")?;
        Exact::read_all(&from.low, &mut self.y.lo, "the state")?;
        self.time = from.time.read()?;
        self.index = from.index;
        self.h_ref = from.energy_reference.read()?;
        let watched = self.watched.iter_mut().map(|w| &mut w.defect);
        let defects: Vec<_> = self.energy.iter_mut().chain(watched).collect();
        if defects.len() != from.defects.len() || self.alpha_range.len() != from.alpha_range.len() {
            return Err(damaged("the defects"));
        }
        for (defect, [start, max, end]) in defects.into_iter().zip(&from.defects) {
            (defect.start, defect.max, defect.end) = (start.read()?, max.read()?, end.read()?);
        }
        for (range, [low, high]) in self.alpha_range.iter_mut().zip(&from.alpha_range) {
            *range = (low.read()?, high.read()?);
        }
        let read = |x: &Option<Exact>| x.as_ref().map(Exact::read).transpose();
        self.in_floors = read(&from.in_floors)?;
        self.floor = read(&from.floor)?;
        self.last = (from.last_step.read()?, from.last_outcome);
        *self.core.counts_mut() = from.counts;
        let mut parts = Vec::with_capacity(from.solver.len());
        for (name, stored) in &from.solver {
            let numbers: Result<Vec<T>, _> = stored.iter().map(Exact::read).collect();
            parts.push((name.clone(), numbers?));
        }
        self.core
            .restore(&SolverMemory::from_parts(parts))
            .map_err(|Damaged { what }| damaged(what))?;
        let before = Duration::try_from_secs_f64(from.seconds).unwrap_or_default();
        self.begun = Instant::now()
            .checked_sub(before)
            .unwrap_or_else(Instant::now);
        Ok(())
    }
}
