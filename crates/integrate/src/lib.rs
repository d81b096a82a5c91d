//! Runs of energy-preserving steps for Hamiltonian systems y' = J∇H(y): step control, dense output, events,
//! checkpoints, the tangent map and the certificate.
//!
//! Each folder imports only from the folders before it, except for the constants in `control`: `error`,
//! `time` ← `options`, `control` ← `report` ← `checkpoints`, `dense` ← `events` ← `steppers` (single steps,
//! and step control) ← `tangent` ← `runs` (complete intervals). The step itself belongs to `equip-solver`,
//! whose public names are re-exported here.
#![forbid(unsafe_code)]

mod checkpoints;
mod control;
mod dense;
mod error;
mod events;
mod options;
mod report;
mod runs;
mod steppers;
mod tangent;
mod time;

pub use checkpoints::checkpoint::Checkpoint;
pub use dense::trajectory::Trajectory;
pub use equip_solver::{
    AlphaPolicy, Alphas, Counts, Family, Invariant, MAX_STAGES, Outcome, Preconditioner,
};
pub use error::IntegrateError;
pub use options::event::{Direction, Event, Occurrence};
pub use options::integrator::Integrator;
pub use options::method::{Equip, Gauss, Method};
pub use options::record::Record;
pub use report::certificate::Certificate;
pub use report::conserved::Conserved;
pub use report::energy_round_off::EnergyRoundOff;
pub use report::entries::{ChaosIndicators, EnergyJumps, PhasePerStep, VariableSteps};
#[cfg(feature = "rayon")]
pub use runs::ensemble::{Starts, drawn_start};
pub use runs::observer::{NoObserver, Observer};
pub use runs::prepared::Prepared;
pub use runs::run::{Run, RunFailure};
pub use runs::step_events::StepEvents;
pub use runs::suggest::Target;
pub use steppers::stepper::Stepper;
pub use steppers::view::{Step, StepView};
pub use tangent::{Chaos, TangentMap};
pub use time::extended::Extended;
