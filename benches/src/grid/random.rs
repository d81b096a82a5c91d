//! Judges that nothing was tuned on: random Hamiltonians, starts, stages and steps, each from its seed.

use crate::cell::{Cell, Patience, STEPS, Truth};
use crate::contestant::Task;
use crate::motion::Motion;
use equip_scalar::DoubleDouble;
use equip_tableau::TableauError;
use equip_tests::{RandomSystem, Reference, Seeded};

/// Agreement of two solutions that is asked for: random motions are not always smooth.
const AGREEMENT: f64 = 1e-14;
/// Numbers of stages drawn from.
const STAGES: [usize; 8] = [2, 3, 4, 5, 6, 8, 10, 16];

/// `count` cells, each of a system of its own; their number stands in place of that of the start.
pub(crate) fn cells(count: u64, seed: u64, patience: Patience) -> Result<Vec<Cell>, TableauError> {
    (1..=count)
        .map(|index| cell(index, seed, patience))
        .collect()
}

fn cell(index: u64, seed: u64, patience: Patience) -> Result<Cell, TableauError> {
    let mut rng = Seeded::new(seed.wrapping_mul(1_000_003).wrapping_add(index));
    let system = RandomSystem::draw(&mut rng);
    let hamiltonian = &system.hamiltonian;
    let stages = STAGES[rng.below(STAGES.len())];
    let rate = equip_tests::rate(hamiltonian, &system.start);
    // From well resolved to coarse for these stages.
    let angle = rng.power_of_ten(-1.0, 0.0) * (stages as f64).sqrt();
    let step = angle / rate;
    let times = [STEPS as f64 * step];
    let wanted = (rate, AGREEMENT);
    let reference = Reference::solve::<DoubleDouble>(hamiltonian, &system.start, &times, wanted)?;
    let motion = Motion::along(hamiltonian, &system.start, &reference);
    let (q, p) = system.start.split_at(system.m);
    let task = Task {
        hamiltonian,
        q,
        p,
        stages,
        step,
        steps: STEPS,
    };
    let truth = Truth {
        state: &reference.states[0],
        error: reference.errors[0],
        sizes: motion.sizes,
        rate: motion.rate,
        round_off: motion.round_off,
        is_stiff: false,
    };
    Ok(Cell::measure(("random", index), &task, truth, patience))
}
