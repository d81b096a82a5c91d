//! What the tests in `tests/tests` share: problems written like a user writes them, measurements, seeded
//! numbers.
//!
//! | file | question |
//! |---|---|
//! | `order.rs` | are the errors those of the printed tables, and the orders 2s (2s − 2 at a fixed α)? |
//! | `invariants.rs` | are energy and quadratic invariants kept at every step, and is the trajectory the better for it? |
//! | `agreement.rs` | do end states agree with references from other methods, to all digits there are? |
//! | `newton.rs` | does Newton on system (7) converge quadratically? |
//! | `pay_as_you_go.rs` | does a scene that needs less pay less? |
//! | `random/` | does every random Hamiltonian end well: typed, finite, the energy kept where claimed, no worse than Gauss? |
//! | `long.rs` | does anything grow in 10⁷ steps? |
//! | `many.rs` | are many components as cheap and as near as with Gauss, and stiff ones kept from slopes? |
//! | `cases_step.rs` | are small inputs from outside as right and as cheap as with Gauss on the same steps? |
//! | `cases_step_long.rs` | the same, of many steps, many components and wide numbers |
//! | `cases_step_starts.rs` | the same in the mean over random starts, with few stages or many components |
//! | `failures/` | is every failure typed, with a remedy, and the state intact? |
//! | `extremes.rs` | wild units, shifted energies, every number of stages |
//! | `stories.rs` | energies as users write them |
//! | `kinks.rs` | by tolerance, are energies that bend and jump as right as smooth ones? |
//! | `kinks_random.rs` | does any random energy that bends and jumps end a run that fixed steps survive? |
//! | `tables.rs` | are potentials known at points as right as splines are, and as quick as formulas? |
//! | `reproducibility.rs` | is a run the same to the last bit, whatever is watched, and does it run backwards? |
//! | `work.rs` | is the work of standard runs what it was? |
//! | `allocations.rs` | does a step allocate? |
//! | `house.rs` | do imports point downward, without circles, in few floors and small rooms? |
//!
//! Every tolerance is a measured figure times a stated headroom; the figure stands beside it. Where both
//! float types run the same function, double-double asserts digits that `f64` cannot reach.
#![forbid(unsafe_code)]
// Test code fails by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod measure;
mod misses;
mod problems;
mod random_system;
mod reference;
mod seeded;
mod side_by_side;

pub use measure::{
    Trend, decimal_digits, distance, largest_ratio, observed_order, relative_distance, trend,
};
pub use misses::{Limits, Misses, Pair, geometric_mean};
pub use problems::{Start, double_pendulum, harmonic, henon_heiles, kepler, pendulum};
pub use random_system::{RandomSystem, TermKind, rate};
pub use reference::{Reference, apart, sizes};
pub use seeded::Seeded;
pub use side_by_side::{Made, Trial, Who};
