//! Everything a program that integrates its own Hamiltonian needs: `use equip::prelude::*;`.

pub use equip_autodiff::{BuildError, Hamiltonian, Var};
pub use equip_integrate::{
    Adaptive, AdaptiveStepper, Alphas, Certificate, Chaos, ChaosIndicators, Checkpoint, Counts,
    Direction, Equip, Event, FixedStep, Gauss, IntegrateError, Integrator, Invariant, Method,
    Observer, Occurrence, Outcome, Preconditioner, Prepared, Reach, Record, Reversible,
    ReversibleStepper, Run, RunFailure, Step, StepEvents, StepRule, StepView, Stepper, TangentMap,
    Target, Trajectory, VariableSteps,
};
pub use equip_scalar::{Constant, DoubleDouble, Float, Num, Scalar, decimal, ratio};
pub use equip_tables::{Custom, Table, Table2, TableError};
