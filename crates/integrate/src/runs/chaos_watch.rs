//! The tangent vector that a complete run propagates, if requested.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::memory::Memory;
use crate::error::IntegrateError;
use crate::options::common::Options;
use crate::steppers::integration::Integration;
use crate::tangent::chaos::{Chaos, any_tangent_vector};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// The tangent vector of a run with `options`, if requested, from its start or from the checkpoint `from`.
///
/// # Errors
/// The checkpoint has a tangent vector and the options have none, or vice versa.
pub(crate) fn chaos_of_run<T: Float>(
    system: &Hamiltonian,
    options: &Options<T>,
    run: &mut Integration<T>,
    from: Option<&Checkpoint>,
) -> Result<Option<Chaos<T>>, IntegrateError<T>> {
    let follows = from.map_or(options.chaos, |from| from.chaos.is_some());
    if follows != options.chaos {
        let word = |follows| if follows { "followed" } else { "none followed" };
        return Err(IntegrateError::CheckpointMismatch {
            what: "tangent vector",
            stored: word(follows).to_owned(),
            now: word(options.chaos).to_owned(),
        });
    }
    if !options.chaos {
        return Ok(None);
    }
    let mut chaos = Chaos::of(system, run, &any_tangent_vector(2 * run.m));
    if let Some(numbers) = from.and_then(|from| from.chaos.as_ref()) {
        let mut memory = Memory::to_read(numbers);
        chaos.remember(&mut memory);
        memory.check()?;
    }
    Ok(Some(chaos))
}
