//! Checkpoints: the part of an [`Integration`].

use crate::checkpoints::checkpoint::{Checkpoint, FORMAT};
use crate::checkpoints::checksum::of_function;
use crate::checkpoints::exact::Exact;
use crate::checkpoints::memories::{read_round_off, round_off_memory};
use crate::error::IntegrateError;
use crate::report::conserved::Watched;
use crate::report::energy_jumps::EnergyJumps;
use crate::report::phase_per_step::PhasePerStep;
use crate::report::stopwatch::Stopwatch;
use crate::steppers::integration::Integration;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use equip_solver::{Damaged, SolverMemory};
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
        Exact::read_all(&checkpoint.high, &mut y, "the state")?;
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
        let memory = self.core.memory();
        let parts = memory.parts().iter();
        let solver = parts
            .map(|(name, numbers)| (name.clone(), Exact::all(numbers)))
            .collect();
        let energy = of_function(self.core.energy_mut(), &self.y.hi);
        let invariants = self.invariants(self.time, &self.y.hi.clone());
        let words = self.fingerprint.iter();
        let options = words.map(|(name, value)| ((*name).to_owned(), value.clone()));
        let errors = self
            .measured
            .energy
            .iter()
            .chain(self.measured.watched.iter().map(|w| &w.conserved));
        let seconds = self.begun.seconds();
        Checkpoint {
            format: FORMAT,
            precision: T::NAME.to_owned(),
            options: options.collect(),
            energy,
            invariants,
            start_state: Exact::all(&self.start),
            start: Exact::of(self.t0),
            time: Exact::of(self.time),
            time_low: Exact::default(),
            index: self.index,
            goes_back: self.direction == TimeDirection::Backward,
            grid_start: Exact::of(self.t0),
            place: 0,
            high: Exact::all(&self.y.hi),
            low: Exact::all(&self.y.lo),
            energy_reference: Exact::of(self.h_ref),
            errors: errors
                .map(|d| [d.start, d.max, d.end].map(Exact::of))
                .collect(),
            in_levels: self.measured.in_levels.map(Exact::of),
            energy_round_off: self.measured.energy_round_off.map(round_off_memory),
            phase_per_step: (self.measured.phase_per_step)
                .map(|phase| [T::exact(phase.angle), phase.step].map(Exact::of)),
            round_off: self.measured.round_off.map(Exact::of),
            alpha_range: self
                .measured
                .alpha_range
                .iter()
                .map(|&(a, b)| [a, b].map(Exact::of))
                .collect(),
            last_step: Exact::of(self.last.0),
            last_outcome: self.last.1,
            counts: *self.core.counts(),
            switches_crossed: self.measured.switches_crossed,
            energy_jumps: (self.measured.energy_jumps)
                .map(|jumps| (jumps.count, Exact::of(jumps.largest))),
            seconds: Exact::of(seconds),
            solver,
            control: None,
            chaos: None,
            checksum: String::new(),
        }
    }

    pub(crate) fn restore_from(&mut self, from: &Checkpoint) -> Result<(), IntegrateError<T>> {
        let damaged = |what| IntegrateError::CheckpointDamaged { what };
        Exact::read_all(&from.high, &mut self.y.hi, "the state")?;
        Exact::read_all(&from.low, &mut self.y.lo, "the state")?;
        Exact::read_all(&from.start_state, &mut self.start, "the start")?;
        let mut numbers = self.y.hi.iter().chain(&self.y.lo).chain(&self.start);
        if !numbers.all(|x| x.is_finite()) {
            return Err(damaged("the state"));
        }
        self.time = from.time.read_finite("the time")?;
        let low: T = from.time_low.read_finite("the time")?;
        if low.abs() > T::EPSILON * self.time.abs() {
            return Err(damaged("the time"));
        }
        from.grid_start.read_finite::<T>("the time")?;
        self.index = from.index;
        self.direction = match from.goes_back {
            true => TimeDirection::Backward,
            false => TimeDirection::Forward,
        };
        self.h_ref = from.energy_reference.read_finite("the energy")?;
        let measured = &mut self.measured;
        let watched = measured.watched.iter_mut().map(|w| &mut w.conserved);
        let errors: Vec<_> = measured.energy.iter_mut().chain(watched).collect();
        if errors.len() != from.errors.len() || measured.alpha_range.len() != from.alpha_range.len()
        {
            return Err(damaged("the errors"));
        }
        for (conserved, [start, max, end]) in errors.into_iter().zip(&from.errors) {
            (conserved.start, conserved.max, conserved.end) =
                (start.read()?, max.read()?, end.read()?);
        }
        for (range, [low, high]) in self.measured.alpha_range.iter_mut().zip(&from.alpha_range) {
            *range = (low.read()?, high.read()?);
        }
        let read = |x: &Option<Exact>| x.as_ref().map(Exact::read).transpose();
        self.measured.in_levels = read(&from.in_levels)?;
        let pair = |x: &Option<[Exact; 2]>| match x {
            Some([first, second]) => Ok(Some((first.read()?, second.read()?))),
            None => Ok(None),
        };
        let round_off = from.energy_round_off.as_ref();
        self.measured.energy_round_off = round_off.map(read_round_off).transpose()?;
        self.measured.phase_per_step = pair(&from.phase_per_step)?.map(|(angle, step): (T, T)| {
            let angle = angle.to_f64();
            PhasePerStep { angle, step }
        });
        self.measured.round_off = read(&from.round_off)?;
        self.last = (
            from.last_step.read_finite("the last step")?,
            from.last_outcome,
        );
        *self.core.counts_mut() = from.counts;
        self.measured.switches_crossed = from.switches_crossed;
        self.measured.energy_jumps = match &from.energy_jumps {
            Some((count, largest)) => Some(EnergyJumps {
                count: *count,
                largest: largest.read()?,
            }),
            None => None,
        };
        let mut parts = Vec::with_capacity(from.solver.len());
        for (name, stored) in &from.solver {
            let numbers = stored.iter().map(Exact::read);
            let numbers = numbers.collect::<Result<Vec<T>, _>>()?;
            // The gradients in the memory begin with a state that is NaN if there are none.
            let is_none = name == "gradients" && numbers.first().is_some_and(|x| x.is_nan());
            if !is_none && numbers.iter().any(|x| x.is_nan()) {
                return Err(damaged("the memory of the solver"));
            }
            parts.push((name.clone(), numbers));
        }
        self.core
            .restore(&SolverMemory::from_parts(parts))
            .map_err(|Damaged { what }| damaged(what))?;
        let before =
            Duration::try_from_secs_f64(from.seconds.read::<T>()?.to_f64()).unwrap_or_default();
        self.begun = Stopwatch::after(before);
        Ok(())
    }
}
