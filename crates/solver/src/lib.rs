//! Energy and quadratic invariants preserving (EQUIP) integrators for Hamiltonian systems y' = J∇H(y).
//!
//! One step reads: initial guess (`guess`) → stages and α (`stages`, `constraint`, `linearised`, `alpha`, `newton`) → accept or halve (`step`)
//! → update (`state`) → observe (`stepper`, `run`).
//!
//! Paper: L. Brugnano, F. Iavernaro, D. Trigiante, *Energy and quadratic invariants preserving integrators of Gaussian
//! type*, AIP Conf. Proc. 1281 (2010), and arXiv:1005.1930.
#![forbid(unsafe_code)]

mod adaptive;
mod adaptive_first;
mod adaptive_run;
mod adaptive_stepper;
mod ahead;
mod aligned;
mod alpha;
mod certificate;
mod checkpoint;
mod checkpoint_adaptive;
mod checkpoint_fixed;
mod columns;
mod constraint;
mod contraction;
mod control;
mod control_estimate;
mod dear;
mod dense;
mod dense_trajectory;
mod dense_watch;
mod displaced;
mod displacement;
mod draft;
mod drive;
mod endpoint;
mod error;
mod escape;
mod event;
mod event_roots;
mod event_watch;
mod finer;
mod foresee;
mod grid;
mod guess;
mod half;
mod hessians;
mod invariant;
mod linear;
mod linear_sweeps;
mod linearisation;
mod linearised;
mod linearised_columns;
mod local_error;
mod method;
mod mix;
mod moves;
mod newton;
mod newton_alphas;
mod observer;
mod one_more;
mod opening;
mod options;
mod outcome;
mod pairs;
mod product;
mod prolongation;
mod ready;
mod refined;
mod response;
mod reversible;
mod reversible_stepper;
mod row;
mod run;
mod shifted;
mod simplified;
mod slight;
mod slopes;
mod slow;
mod small;
mod sparse;
mod splitting;
mod springs;
mod stages;
mod start;
mod state;
mod step;
mod step_density;
mod step_error;
mod step_swept;
mod stepper;
mod suggest;
mod sweep;
mod sweep_task;
mod sweeps;
mod tangent;
mod tangent_chaos;
mod time_dependent;
mod twice;
mod whole;

pub use adaptive::Adaptive;
pub use adaptive_stepper::AdaptiveStepper;
pub use certificate::{Certificate, VariableSteps};
pub use checkpoint::Checkpoint;
pub use dense_trajectory::Trajectory;
pub use error::IntegrateError;
pub use event::{Direction, Event, Occurrence};
pub use invariant::{Defect, Invariant};
pub use method::{Alphas, Equip, Family, Gauss, Method};
pub use newton::NewtonRecord;
pub use observer::{NoObserver, Observer};
pub use options::{FixedStep, OnNoAlpha, Record, StageSolver};
pub use outcome::{Counts, Outcome};
pub use reversible::{Reversible, StepRule};
pub use reversible_stepper::ReversibleStepper;
pub use run::{Run, RunFailure};
pub use stepper::{Step, StepView, Stepper};
pub use suggest::Target;
pub use tangent::{Steps, TangentMap};
pub use tangent_chaos::{Chaos, ChaosIndicators};
pub use time_dependent::Extended;

/// Most stages a method may have.
pub use equip_tableau::MAX_STAGES;
/// Fewest stages with an α.
const MIN_EQUIP_STAGES: usize = 2;
