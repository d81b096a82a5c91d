//! [`Checkpoint`]: everything a run needs to go on as if it had never stopped, bit for bit.
//!
//! Numbers are kept as the bits of their parts, so double-double comes back exactly as well. With the feature `serde` a checkpoint can be written
//! in any format serde knows; the parts are hexadecimal text.
//!
//! What is in it: time and state with the parts that rounding lost, the references of energy and invariants, what the
//! solver and step control remember of the steps so far, and the certificate so far. What is not: H, and what only
//! watches a run (observers, events, output times).

use crate::checkpoints::exact::Exact;
use crate::checkpoints::memories::{ChaosMemory, ControlMemory};
use crate::error::IntegrateError;
use equip_scalar::Float;
use equip_solver::{Counts, Outcome};

/// The version of what is in a checkpoint.
pub(crate) const FORMAT: u32 = 4;

/// A run at one of its steps, from which it can be resumed bit for bit. Made by [`Stepper::checkpoint`](crate::Stepper::checkpoint) and
/// [`AdaptiveStepper::checkpoint`](crate::AdaptiveStepper::checkpoint), read by `resume` and `integrate_from` of the same options.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::Equip;
///
/// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
/// let options = Equip::stages(4).step(0.1);
/// let mut run = options.start(&pendulum, &[0.0], &[1.0], 0.0)?;
/// run.advance()?;
/// let mut again = options.resume(&pendulum, &run.checkpoint())?;
/// assert_eq!(run.advance()?.q, again.advance()?.q);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checkpoint {
    pub(crate) format: u32,
    /// Name of the float type.
    pub(crate) precision: String,
    /// Method and options, as they have to be again.
    pub(crate) options: String,
    pub(crate) start: Exact,
    pub(crate) time: Exact,
    pub(crate) time_low: Exact,
    pub(crate) index: u64,
    pub(crate) high: Vec<Exact>,
    pub(crate) low: Vec<Exact>,
    /// H at the state, by which another H is found out.
    pub(crate) energy_now: Exact,
    pub(crate) energy_reference: Exact,
    /// Energy if it is measured, then the invariants: start, max, end of each.
    pub(crate) defects: Vec<[Exact; 3]>,
    pub(crate) in_floors: Option<Exact>,
    pub(crate) floor: Option<Exact>,
    pub(crate) alpha_range: Vec<[Exact; 2]>,
    pub(crate) last_step: Exact,
    pub(crate) last_outcome: Outcome,
    pub(crate) counts: Counts,
    pub(crate) seconds: f64,
    /// What the solver remembers of the steps so far.
    pub(crate) solver: Vec<(String, Vec<Exact>)>,
    pub(crate) control: Option<ControlMemory>,
    /// The deviation that is followed.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) chaos: Option<ChaosMemory>,
}

impl Checkpoint {
    /// Number of the step it was made after.
    pub fn index(&self) -> u64 {
        self.index
    }

    /// Time it was made at.
    ///
    /// # Errors
    /// [`IntegrateError::CheckpointDamaged`] if it is not a number.
    pub fn time<T: Float>(&self) -> Result<T, IntegrateError<T>> {
        self.time.read()
    }

    /// Whether it is of a run in this float type with these options.
    pub(crate) fn check<T: Float>(&self, options: &str) -> Result<(), IntegrateError<T>> {
        let same = |what, stored: &str, now: &str| {
            if stored == now {
                return Ok(());
            }
            Err(IntegrateError::CheckpointMismatch {
                what,
                stored: stored.to_owned(),
                now: now.to_owned(),
            })
        };
        same("format", &self.format.to_string(), &FORMAT.to_string())?;
        same("float type", &self.precision, T::NAME)?;
        same("method or options", &self.options, options)
    }

    /// Positions and momenta, rounded.
    pub(crate) fn state<T: Float>(&self) -> Result<(Vec<T>, Vec<T>), IntegrateError<T>> {
        let mut y = vec![T::int(0); self.high.len()];
        Exact::read_all(&self.high, &mut y, "the state")?;
        let p = y.split_off(y.len() / 2);
        Ok((y, p))
    }

    /// What step control has remembered.
    pub(crate) fn control<T: Float>(&self) -> Result<&ControlMemory, IntegrateError<T>> {
        let what = "the memory of step control";
        let damaged = IntegrateError::CheckpointDamaged { what };
        self.control.as_ref().ok_or(damaged)
    }
}
