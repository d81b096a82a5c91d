//! [`Checkpoint`]: everything a run needs to go on as if it had never stopped, bit for bit.
//!
//! Numbers are kept as the bits of their parts, so double-double comes back exactly as well. With the feature `serde` a checkpoint can be written
//! in any format serde knows; the parts are hexadecimal text.
//!
//! What is in it: time and state with the parts that rounding lost, the references of energy and invariants, the stage polynomial that the next
//! guess prolongs, what simplified Newton and step control remember, and the certificate so far. What is not: H, and what only
//! watches a run (observers, events, output times).

use crate::error::IntegrateError;
use crate::outcome::{Counts, Outcome};
use crate::springs::Trial;
use equip_scalar::Float;

/// The version of what is in a checkpoint.
pub(crate) const FORMAT: u32 = 3;

/// A run at one of its steps, from which it can be resumed bit for bit. Made by [`Stepper::checkpoint`](crate::Stepper::checkpoint) and
/// [`AdaptiveStepper::checkpoint`](crate::AdaptiveStepper::checkpoint), read by `resume` and `integrate_from` of the same options.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_solver::Equip;
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
    /// References of the constraints.
    pub(crate) references: Vec<Exact>,
    /// Energy if it is measured, then the invariants: start, max, end of each.
    pub(crate) defects: Vec<[Exact; 3]>,
    pub(crate) in_floors: Option<Exact>,
    pub(crate) floor: Option<Exact>,
    pub(crate) alpha_range: Vec<[Exact; 2]>,
    pub(crate) alphas: Vec<Exact>,
    pub(crate) last_step: Exact,
    pub(crate) last_outcome: Outcome,
    pub(crate) counts: Counts,
    pub(crate) seconds: f64,
    /// h, then L, of the step that the next guess prolongs.
    pub(crate) guess: Vec<Exact>,
    pub(crate) solver: SolverMemory,
    /// What sweeps remember: contraction, defect and scale of the energy, how far slopes and responses move the end point; and the steps that are left to Newton.
    pub(crate) sweeps: Option<[Exact; 6]>,
    pub(crate) pause: [u32; 2],
    /// Steps that are halved at once.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) halved: Vec<[u32; 2]>,
    /// The floors that the constraints have inherited.
    pub(crate) inherited: Vec<Exact>,
    pub(crate) control: Option<ControlMemory>,
    /// The deviation that is followed.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) chaos: Option<ChaosMemory>,
    /// Stiff springs, if there were any at the start of the run.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) springs: Option<SpringsMemory>,
    /// hω of the stiffest spring that sweeps do not solve for.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) unresolved_spring: Option<Exact>,
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
}

/// What the stage solver remembers of earlier steps: simplified Newton's one Hessian. Full Newton remembers nothing.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SolverMemory {
    pub(crate) full_steps: u32,
    /// The step of the factorisation, and θ of the last step and of the one it was made in; none if there is no factorisation.
    pub(crate) made_for: Option<Exact>,
    pub(crate) theta: [Exact; 2],
    pub(crate) untried: bool,
    pub(crate) hessian: Vec<Exact>,
    pub(crate) unit: Vec<Exact>,
    pub(crate) generator: Vec<Exact>,
}

/// What step control remembers.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ControlMemory {
    pub(crate) next: Exact,
    pub(crate) held: Exact,
    pub(crate) tries: u32,
    pub(crate) smallest: Exact,
    pub(crate) largest: Exact,
    pub(crate) rejected: u64,
    pub(crate) failed: u64,
}

/// Which components are on stiff springs, and what is known of whether they pay.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SpringsMemory {
    pub(crate) components: Vec<usize>,
    pub(crate) kappa: Vec<Exact>,
    pub(crate) kept: Vec<usize>,
    pub(crate) trial: Trial,
    pub(crate) without: Exact,
    pub(crate) counts: [u64; 3],
}

/// A deviation and what has been summed of it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ChaosMemory {
    pub(crate) start: Exact,
    pub(crate) sums: [Exact; 3],
    pub(crate) deviation: Vec<Exact>,
}

/// A number by the bits of its parts: hexadecimal, separated by colons, the largest part first.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub(crate) struct Exact(String);

impl Default for Exact {
    fn default() -> Self {
        Exact::of(0.0)
    }
}

impl Exact {
    pub(crate) fn of<T: Float>(x: T) -> Self {
        let parts = x.expansion();
        let last = parts.iter().rposition(|&part| part != 0.0).unwrap_or(0);
        let text: Vec<String> = parts[..=last]
            .iter()
            .map(|part| format!("{:016x}", part.to_bits()))
            .collect();
        Exact(text.join(":"))
    }

    pub(crate) fn all<T: Float>(x: &[T]) -> Vec<Self> {
        x.iter().map(|&x| Exact::of(x)).collect()
    }

    pub(crate) fn read<T: Float>(&self) -> Result<T, IntegrateError<T>> {
        let mut parts = [0.0; 4];
        let mut count = 0;
        for text in self.0.split(':') {
            let bits = u64::from_str_radix(text, 16);
            let (Ok(bits), Some(part)) = (bits, parts.get_mut(count)) else {
                return Err(IntegrateError::CheckpointDamaged { what: "a number" });
            };
            *part = f64::from_bits(bits);
            count += 1;
        }
        Ok(if count == 1 {
            T::exact(parts[0])
        } else {
            T::from_expansion(parts)
        })
    }

    /// Reads as many numbers as `out` holds.
    pub(crate) fn read_all<T: Float>(
        stored: &[Self],
        out: &mut [T],
        what: &'static str,
    ) -> Result<(), IntegrateError<T>> {
        if stored.len() != out.len() {
            return Err(IntegrateError::CheckpointDamaged { what });
        }
        for (out, stored) in out.iter_mut().zip(stored) {
            *out = stored.read()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Exact;
    use equip_scalar::{DoubleDouble, Float};

    #[test]
    fn numbers_come_back_with_all_their_bits() {
        let third = DoubleDouble::ratio(1, 3);
        for x in [
            0.0,
            -0.0,
            1.0,
            -0.1,
            f64::MAX,
            5e-324,
            f64::INFINITY,
            1e-300,
        ] {
            let back: f64 = Exact::of(x).read().unwrap();
            assert_eq!(back.to_bits(), x.to_bits());
            let x = third * DoubleDouble::exact(x);
            let back: DoubleDouble = Exact::of(x).read().unwrap();
            let bits = |x: DoubleDouble| x.expansion().map(f64::to_bits);
            if x.is_finite() && x != DoubleDouble::exact(0.0) {
                assert_eq!(bits(back), bits(x), "{x}");
            }
        }
        let back: f64 = Exact::of(f64::NAN).read().unwrap();
        assert!(back.is_nan());
        assert!(Exact("no number".into()).read::<f64>().is_err());
        assert!(Exact("0:0:0:0:0".into()).read::<f64>().is_err());
    }
}
