//! Checkpoints of a [`Stepper`], the part that all step sizes share.

use crate::checkpoints::checkpoint::{Checkpoint, FORMAT};
use crate::checkpoints::exact::Exact;
use crate::error::IntegrateError;
use crate::steppers::stepper::Stepper;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_solver::{Damaged, SolverMemory};
use std::time::{Duration, Instant};

impl<T: Float, E: Evaluate<T>> Stepper<T, E> {
    /// H at the state, by which another H is found out.
    pub(crate) fn energy_now(&mut self) -> Exact {
        Exact::of(self.core.energy_mut().value(&self.y.hi))
    }

    /// The run as it is now, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let memory = self.core.memory();
        let parts = memory.parts().iter();
        let solver = parts
            .map(|(name, numbers)| (name.clone(), Exact::all(numbers)))
            .collect();
        let energy_now = self.energy_now();
        let defects = self
            .energy
            .iter()
            .chain(self.watched.iter().map(|w| &w.defect));
        let seconds = self.begun.elapsed().as_secs_f64();
        Checkpoint {
            format: FORMAT,
            precision: T::NAME.to_owned(),
            options: self.fingerprint.clone(),
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

    pub(super) fn restore_from(&mut self, from: &Checkpoint) -> Result<(), IntegrateError<T>> {
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
