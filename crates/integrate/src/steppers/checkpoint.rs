//! Checkpoints: the part of an [`Integration`].

use crate::checkpoints::checkpoint::{Checkpoint, FORMAT};
use crate::checkpoints::checksum::of_function;
use crate::checkpoints::exact::Exact;
use crate::checkpoints::memory::{Memory, Numbers};
use crate::error::IntegrateError;
use crate::report::conserved::Watched;
use crate::report::entries::{EnergyJumps, PhasePerStep};
use crate::report::measured::Measured;
use crate::report::stopwatch::Stopwatch;
use crate::steppers::integration::Integration;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use std::slice::from_mut;
use std::time::Duration;

impl<T: Float> Integration<T> {
    /// The names of the invariants, conserved and monitored, and their checksums at `y` and time `t`.
    fn invariants(&mut self, t: T, y: &[T]) -> Vec<(String, String)> {
        let all = self.measured.watched.iter_mut();
        let named = |watched: &mut Watched<T>| {
            let (function, point) = watched.evaluator_at(t, y);
            let sum = of_function(function, point);
            (watched.conserved.name.clone(), sum)
        };
        all.map(named).collect()
    }

    /// Checks that H and the invariants are those of the run of `checkpoint`.
    pub(crate) fn check_functions(
        &mut self,
        checkpoint: &Checkpoint,
    ) -> Result<(), IntegrateError<T>> {
        let (time, mut y) = (checkpoint.time.read()?, self.y.hi.clone());
        let mut memory = Memory::to_read(&checkpoint.run);
        memory.finite("the state", &mut y);
        memory.check()?;
        if of_function(self.core.energy_mut(), &y) != checkpoint.energy {
            return Err(IntegrateError::CheckpointOtherEnergy { time });
        }
        let stored = checkpoint.invariants.iter();
        for ((name, now), (_, stored)) in self.invariants(time, &y).iter().zip(stored) {
            if stored != now {
                return Err(IntegrateError::CheckpointMismatch {
                    what: "an invariant",
                    stored: format!("{name} as it was then"),
                    now: "another function of that name".to_owned(),
                });
            }
        }
        Ok(())
    }

    /// The present state of the run without the memory of its step control. The checkpoint must be sealed
    /// afterwards.
    pub(crate) fn checkpoint(&mut self) -> Checkpoint {
        let mut numbers = Numbers::new();
        self.remember(&mut Memory::to_write(&mut numbers));
        let mut solver = Numbers::new();
        self.core.remember(&mut Memory::to_write(&mut solver));
        let words = self.fingerprint.iter();
        Checkpoint {
            format: FORMAT,
            precision: T::NAME.to_owned(),
            options: words
                .map(|(name, value)| ((*name).to_owned(), value.clone()))
                .collect(),
            energy: of_function(self.core.energy_mut(), &self.y.hi),
            invariants: self.invariants(self.time, &self.y.hi.clone()),
            start: Exact::of(self.t0),
            start_state: Exact::all(&self.start),
            time: Exact::of(self.time),
            index: self.index,
            last_outcome: self.last.1,
            counts: *self.core.counts(),
            run: numbers,
            solver,
            chaos: None,
            checksum: String::new(),
        }
    }

    /// Restores the state of the run of a checkpoint, of which `memory` reads the numbers. The run has begun
    /// at the initial state of that run.
    pub(crate) fn restore_from(
        &mut self,
        from: &Checkpoint,
        memory: &mut Memory<'_>,
    ) -> Result<(), IntegrateError<T>> {
        self.time = from.time.read_finite("the time")?;
        self.index = from.index;
        self.last.1 = from.last_outcome;
        *self.core.counts_mut() = from.counts;
        self.remember(memory);
        memory.check()?;
        let mut solver = Memory::to_read(&from.solver);
        self.core.remember(&mut solver);
        solver.check()
    }

    /// Writes or reads the numbers of the run.
    fn remember(&mut self, memory: &mut Memory<'_>) {
        memory.finite("the state", &mut self.y.hi);
        memory.finite("the rounding remainder of the state", &mut self.y.lo);
        memory.finite("the energy", from_mut(&mut self.h_ref));
        memory.finite("the last step", from_mut(&mut self.last.0));
        let goes_back = u64::from(self.direction == TimeDirection::Backward);
        self.direction = match memory.count::<T>("the direction", goes_back) {
            0 => TimeDirection::Forward,
            _ => TimeDirection::Backward,
        };
        let mut seconds = T::exact(self.begun.seconds());
        memory.any("the seconds", from_mut(&mut seconds));
        let before = Duration::try_from_secs_f64(seconds.to_f64());
        self.begun = Stopwatch::after(before.unwrap_or_default());
        remember_measured(&mut self.measured, memory);
    }
}

/// Writes or reads what was measured of the steps so far.
fn remember_measured<T: Float>(measured: &mut Measured<T>, memory: &mut Memory<'_>) {
    let watched = measured.watched.iter_mut().map(|w| &mut w.conserved);
    for of in measured.energy.iter_mut().chain(watched) {
        let mut errors = [of.start, of.max, of.end];
        memory.any("the errors", &mut errors);
        [of.start, of.max, of.end] = errors;
    }
    for range in &mut measured.alpha_range {
        let mut ends = [range.0, range.1];
        memory.any("the range of α", &mut ends);
        *range = ends.into();
    }
    measured.in_levels = memory.one("the errors in round-off levels", measured.in_levels);
    measured.round_off = memory.one("the round-off level", measured.round_off);
    if let Some(of) = &mut measured.energy_round_off {
        let mut levels = [of.round_off, of.time, of.scale, of.last, of.recent_kinetic];
        memory.any("the round-off levels of the energy", &mut levels);
        [of.round_off, of.time, of.scale, of.last, of.recent_kinetic] = levels;
    }
    let phase = (measured.phase_per_step).map(|phase| [T::exact(phase.angle), phase.step]);
    let phase = memory.optional("the phase per step", phase);
    measured.phase_per_step = phase.map(|[angle, step]| {
        let angle = angle.to_f64();
        PhasePerStep { angle, step }
    });
    measured.discontinuities_crossed =
        memory.count::<T>("the discontinuities", measured.discontinuities_crossed);
    let (changes, changed) = &mut measured.state_changes;
    *changes = memory.count::<T>("the changes of the state", *changes);
    memory.finite("the last change of the state", from_mut(changed));
    let count = measured.energy_jumps.map_or(0, |jumps| jumps.count);
    let count = memory.count::<T>("the number of jumps of H", count);
    let largest = measured.energy_jumps.map(|jumps| jumps.largest);
    let largest = memory.one("the largest jump of H", largest);
    measured.energy_jumps = largest.map(|largest| EnergyJumps { count, largest });
}
