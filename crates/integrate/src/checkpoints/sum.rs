//! The checksum of a checkpoint.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::checksum::Checksum;
use crate::checkpoints::memories::{ChaosMemory, ControlMemory};
use crate::events::switch_memory::SwitchMemory;
use equip_solver::Outcome;

impl Checkpoint {
    /// Of all that is in it.
    pub(super) fn sum(&self) -> String {
        // A field that is not named here is an error.
        let Checkpoint {
            format,
            precision,
            options,
            energy,
            invariants,
            start,
            start_state,
            time,
            time_low,
            index,
            goes_back,
            grid_start,
            place,
            high,
            low,
            energy_reference,
            errors,
            in_levels,
            energy_round_off,
            phase_per_step,
            round_off,
            alpha_range,
            last_step,
            last_outcome,
            counts,
            switches_crossed,
            energy_jumps,
            seconds,
            solver,
            control,
            chaos,
            checksum: _,
        } = self;
        let mut sum = Checksum::new();
        sum.count((*format).into());
        sum.text(precision);
        sum.text(energy);
        for (name, value) in options.iter().chain(invariants) {
            sum.text(name);
            sum.text(value);
        }
        sum.numbers([start, time, time_low, grid_start]);
        sum.numbers([energy_reference, last_step, seconds]);
        for numbers in [start_state, high, low] {
            sum.numbers(numbers);
        }
        sum.count(*index);
        sum.count((*goes_back).into());
        sum.count(place.cast_unsigned());
        sum.count(*switches_crossed);
        sum.count(energy_jumps.as_ref().map_or(0, |jumps| jumps.0));
        sum.numbers(energy_jumps.iter().map(|jumps| &jumps.1));
        sum.numbers(errors.iter().flatten());
        sum.numbers(in_levels);
        sum.numbers(energy_round_off.iter().flatten());
        sum.numbers(phase_per_step.iter().flatten());
        sum.numbers(round_off);
        sum.numbers(alpha_range.iter().flatten());
        sum.text(last_outcome.label());
        for count in [
            counts.steps,
            counts.fixed_point_iterations,
            counts.newton_iterations,
            counts.taken_over,
            counts.factorisations,
            counts.simplified_factorisations,
            counts.gradients,
            counts.energies,
            counts.hessians,
            counts.directions,
            counts.alpha_updates,
            counts.local_errors,
            counts.halvings,
        ] {
            sum.count(count);
        }
        for outcome in Outcome::ALL {
            sum.count(counts.outcome(outcome));
        }
        for (name, numbers) in solver {
            sum.text(name);
            sum.numbers(numbers);
        }
        if let Some(control) = control {
            let ControlMemory {
                next,
                tries,
                smallest,
                largest,
                rejected,
                failed,
                switches,
            } = control;
            sum.numbers([next, smallest, largest]);
            sum.count(tries.map_or(0, |tries| 1 + u64::from(tries)));
            sum.count(*rejected);
            sum.count(*failed);
            let SwitchMemory {
                sides,
                is_among_knots,
            } = switches;
            sum.count((*is_among_knots).into());
            for side in sides {
                sum.count(side.map_or(0, |side| (i64::from(side) + 2).cast_unsigned()));
            }
        }
        if let Some(chaos) = chaos {
            let ChaosMemory {
                elapsed,
                sums,
                deviation,
            } = chaos;
            sum.numbers(std::iter::once(elapsed).chain(sums));
            sum.numbers(deviation);
        }
        sum.hexadecimal()
    }
}
