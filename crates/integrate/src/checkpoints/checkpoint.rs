//! [`Checkpoint`]: everything a run needs to continue bit for bit as if it had not been interrupted.
//!
//! Numbers are stored as the bits of their parts, so `f64` and double-double are restored exactly. With the
//! feature `serde` a checkpoint can be written in any format of serde; the parts are hexadecimal text.
//!
//! A checkpoint contains: time and state with their rounding remainders, the references of energy and
//! invariants, the memory of the solver and of step control, and the certificate so far. It does not contain
//! H, nor anything that only observes a run (observers, events, output times).

use crate::checkpoints::checksum;
use crate::checkpoints::exact::Exact;
use crate::checkpoints::memory::Numbers;
use crate::error::IntegrateError;
use crate::options::common::in_digits;
use equip_scalar::Float;
use equip_solver::{Counts, Outcome};

/// The version of the content of a checkpoint.
pub(crate) const FORMAT: u32 = 15;

/// The state of a run after one of its steps. The run can be resumed from it bit for bit.
/// [`Stepper::checkpoint`](crate::Stepper::checkpoint) makes a checkpoint; `resume` and `integrate_from` with
/// the same options read it.
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
#[derive(Debug, Clone, PartialEq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Checkpoint {
    pub(crate) format: u32,
    /// The name of the floating-point type.
    pub(crate) precision: String,
    /// Method and options, which must be the same on resumption.
    pub(crate) options: Vec<(String, String)>,
    /// Checksums of H and of the invariants, by formula and values, with the names of the invariants.
    pub(crate) energy: String,
    pub(crate) invariants: Vec<(String, String)>,
    /// Time and state at the start of the run.
    pub(crate) start: Exact,
    pub(crate) start_state: Vec<Exact>,
    pub(crate) time: Exact,
    pub(crate) index: u64,
    pub(crate) last_outcome: Outcome,
    pub(crate) counts: Counts,
    /// State, references, measurements, and the memory of step control.
    pub(crate) run: Numbers,
    /// The memory of the solver.
    pub(crate) solver: Numbers,
    /// The tangent vector that is propagated.
    pub(crate) chaos: Option<Numbers>,
    /// The checksum of all other fields.
    pub(crate) checksum: String,
}

impl Checkpoint {
    /// The number of the last step before the checkpoint.
    pub fn index(&self) -> u64 {
        self.index
    }

    /// The time of the checkpoint.
    ///
    /// # Errors
    /// [`IntegrateError::CheckpointDamaged`] if the stored time is not a number.
    pub fn time<T: Float>(&self) -> Result<T, IntegrateError<T>> {
        self.time.read()
    }

    /// Checks that the run of this checkpoint started at (`q0`, `p0`), each of length m, at time `t0`.
    ///
    /// # Errors
    /// [`IntegrateError::CheckpointMismatch`] with the floating-point type or the first component that
    /// differs.
    pub fn check_start<T: Float>(
        &self,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<(), IntegrateError<T>> {
        self.check_precision::<T>()?;
        let now = std::iter::once(&t0).chain(q0).chain(p0);
        let stored = std::iter::once(&self.start).chain(&self.start_state);
        let names = ["start time", "start state"];
        for (index, (now, stored)) in now.zip(stored).enumerate() {
            let what = names[index.min(1)];
            let stored: T = stored.read()?;
            same(what, stored, *now, in_digits)?;
        }
        let (stored, now) = (self.start_state.len(), q0.len() + p0.len());
        same("length of the state", stored, now, |n| n.to_string())
    }

    fn check_precision<T: Float>(&self) -> Result<(), IntegrateError<T>> {
        same(
            "floating-point type",
            &*self.precision,
            T::NAME,
            str::to_owned,
        )
    }

    /// Checks that the checkpoint is complete, and belongs to a run in this floating-point type with these
    /// options.
    pub(crate) fn check<T: Float>(
        &self,
        options: &[(&'static str, String)],
    ) -> Result<(), IntegrateError<T>> {
        same("format", self.format, FORMAT, |n| n.to_string())?;
        if self.checksum != self.sum() {
            let what = "its checksum is not that of its content: it";
            return Err(IntegrateError::CheckpointDamaged { what });
        }
        self.check_precision::<T>()?;
        for (what, now) in options {
            let mut all = self.options.iter();
            let stored = all.find(|(name, _)| name == what);
            let stored = stored.map_or("none", |(_, value)| value.as_str());
            same(what, stored, now, str::to_owned)?;
        }
        let (stored, now) = (self.options.len(), options.len());
        same("number of options", stored, now, |n| n.to_string())
    }

    /// The checksum of the content.
    fn sum(&self) -> String {
        checksum::of(&Checkpoint {
            checksum: String::new(),
            ..self.clone()
        })
    }

    /// Stores the checksum of the content.
    #[doc(hidden)]
    pub fn seal(&mut self) {
        self.checksum = self.sum();
    }

    /// Positions and momenta at the start of the run. If H depends on time, they do not include time and its
    /// momentum.
    pub(crate) fn start_state<T: Float>(&self) -> Result<(Vec<T>, Vec<T>), IntegrateError<T>> {
        let mut q = vec![T::int(0); self.start_state.len()];
        Exact::read_all(&self.start_state, &mut q, "the start")?;
        let p = q.split_off(q.len() / 2);
        Ok((q, p))
    }
}

/// An error with both values, unless they are equal.
fn same<T: Float, X: PartialEq>(
    what: &'static str,
    stored: X,
    now: X,
    text: impl Fn(X) -> String,
) -> Result<(), IntegrateError<T>> {
    if stored == now {
        return Ok(());
    }
    Err(IntegrateError::CheckpointMismatch {
        what,
        stored: text(stored),
        now: text(now),
    })
}
