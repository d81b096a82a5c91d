//! Tangent vectors along a run: [`TangentMap`], the derivative of a run with respect to its initial state,
//! and [`Chaos`], indicators of regular and chaotic motion.
//!
//! The step itself solves the variational equation ([`StepTangent`]). With α = 0 the derivative of the step
//! is symplectic up to rounding. If α conserves the energy, tangent vectors conserve ∇H·δ, as those of the
//! exact flow do. If α conserves further invariants, the derivative is that at fixed α.
//!
//! For the indicators, a tangent vector δ is propagated and normalised to length 1 after every step. The
//! growth ln|δ_{n+1}|/|δ_n| of each step gives:
//!
//! - the largest Lyapunov exponent, λ(t) = ln(|δ(t)|/|δ(0)|)/t → λ, zero for regular motion;
//! - MEGNO (Cincotta, Simó, Astron. Astrophys. Suppl. 147, 2000), Y(t) = (2/t) ∫ (d ln|δ|/ds) s ds, and its
//!   time average, which tends to 2 for quasi-periodic motion and to λt/2 for chaotic motion. MEGNO
//!   distinguishes both much earlier than λ(t).
//!
//! t is the time covered by the run since the initial tangent vector, forward and backward.
//!
//! The integral is a sum over the steps, with the growth of each step at its middle. Its error is O(h²) of
//! the growth, which is sufficient.

use crate::checkpoints::memory::Memory;
use crate::error::IntegrateError;
use crate::report::entries::ChaosIndicators;
use crate::steppers::stepper::Stepper;
use crate::time::visible;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Failure, StepTangent};

/// The tangent map along a run.
///
/// A tangent vector has 2m components, those of (q, p). If H depends on time, it has 2m + 2 components, those
/// of (q, t, p, p_t); the component of t belongs to the initial time.
///
/// Steps by a tolerance follow the orbit alone. A tangent vector may contain faster motions: across a plane
/// of symmetry, or at an equilibrium. If
/// [`Certificate::motion_is_resolved`](crate::Certificate::motion_is_resolved) is false, tangent vectors are
/// wrong: limit the steps (`max_step`).
///
/// An event that changes the state changes tangent vectors too: multiply them by the derivative of the
/// change.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::{Equip, TangentMap};
///
/// let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0]))?;
/// let mut run = Equip::stages(4).step(0.1).start(&oscillator, &[1.0], &[0.0], 0.0)?;
/// let mut tangent = TangentMap::new(&oscillator, &mut run);
/// // The columns of the identity: (∂q, ∂p)/∂q0, then (∂q, ∂p)/∂p0.
/// let mut columns = vec![1.0, 0.0, 0.0, 1.0];
/// tangent.advance_to(&mut run, 1.0, &mut columns)?;
/// assert!((columns[0] - 1f64.cos()).abs() < 1e-14 && (columns[1] + 1f64.sin()).abs() < 1e-14);
///
/// // The same step by step.
/// run.advance()?;
/// tangent.propagate(&run, &mut columns)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TangentMap<T: Float> {
    step: StepTangent<T>,
    /// The number of the step up to which tangent vectors have been propagated.
    propagated: u64,
}

impl<T: Float> TangentMap<T> {
    /// Follows `run` from its next step on. `run` must belong to the same `system`.
    pub fn new(system: &Hamiltonian, run: &mut Stepper<T>) -> Self {
        let run = &mut run.inner;
        run.core.keep_parts();
        run.measured.has_tangent = true;
        TangentMap {
            step: StepTangent::new(system, &run.core),
            propagated: run.index,
        }
    }

    /// Advances `run` to the time `t`, forward or backward, and propagates `tangent_vectors`,
    /// concatenated, over every step.
    ///
    /// # Errors
    /// The errors of `advance_to` of the run, and of [`propagate`](Self::propagate).
    ///
    /// # Panics
    /// If the length of `tangent_vectors` is not a multiple of the length of a tangent vector.
    pub fn advance_to(
        &mut self,
        run: &mut Stepper<T>,
        t: T,
        tangent_vectors: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        self.check_followed(run, 0)?;
        while run.advance_towards(t)? {
            self.propagate(run, tangent_vectors)?;
        }
        Ok(())
    }

    /// Propagates `tangent_vectors`, concatenated, over the last step of `run`.
    ///
    /// # Errors
    /// [`IntegrateError::Singular`] if the linearised stage equations cannot be solved; Newton's method could
    /// then not have solved the step either. [`IntegrateError::StepsNotFollowed`] if the run has made several
    /// steps since the last propagation.
    ///
    /// # Panics
    /// If the length of `tangent_vectors` is not a multiple of the length of a tangent vector.
    pub fn propagate(
        &mut self,
        run: &Stepper<T>,
        tangent_vectors: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        let n = self.step.components();
        assert_eq!(
            tangent_vectors.len() % n,
            0,
            "a tangent vector has 2m components"
        );
        self.check_followed(run, 1)?;
        self.propagated = run.inner.index;
        for part in run.inner.parts() {
            self.step.linearise(part);
            for tangent_vector in tangent_vectors.chunks_exact_mut(n) {
                let propagated = self.step.propagate(tangent_vector);
                let (time, step, halvings) = (part.time, part.h, 0);
                propagated.map_err(|failure| match failure {
                    Failure::NotFinite => IntegrateError::NotFinite {
                        time,
                        step,
                        halvings,
                    },
                    _ => IntegrateError::Singular {
                        time,
                        step,
                        halvings,
                    },
                })?;
            }
        }
        Ok(())
    }

    /// Checks that the run has made at most `most` steps since the last propagation or since it was
    /// restarted.
    fn check_followed(&self, run: &Stepper<T>, most: u64) -> Result<(), IntegrateError<T>> {
        let made = run.inner.index;
        let steps = made.checked_sub(self.propagated).unwrap_or(made);
        if steps > most {
            return Err(IntegrateError::StepsNotFollowed { steps });
        }
        Ok(())
    }
}

/// Lyapunov exponent and MEGNO along a run that is advanced step by step;
/// [`Integrator::chaos`](crate::Integrator::chaos) is the option for a complete run.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::{Chaos, Equip};
///
/// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
/// let mut run = Equip::stages(6).tolerance(1e-10).start(&pendulum, &[0.0], &[1.0], 0.0)?;
/// let mut chaos = Chaos::new(&pendulum, &mut run, &[1.0, 0.0]);
/// chaos.advance_to(&mut run, 500.0)?;
/// assert!(chaos.megno() < 2.5 && chaos.lyapunov() < 0.02); // one degree of freedom is regular
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Chaos<T: Float> {
    tangent: TangentMap<T>,
    tangent_vector: Vec<T>,
    /// The degrees of freedom, without time.
    m: usize,
    /// The time of the run, and the time covered since the initial tangent vector.
    time: T,
    elapsed: T,
    /// ln|δ(t)|/|δ(0)|, ∫ s d ln|δ|, ∫ Y ds.
    growth: T,
    weighted: T,
    sum: T,
}

impl<T: Float> Chaos<T> {
    /// Follows `run` from now on, with a `tangent_vector` of any length except zero (2m components,
    /// without time). `run` must belong to the same `system`.
    pub fn new(system: &Hamiltonian, run: &mut Stepper<T>, tangent_vector: &[T]) -> Self {
        let zero = T::int(0);
        let time = run.time();
        let n = 2 * system.degrees_of_freedom();
        let mut whole = vec![zero; n];
        for (j, &x) in tangent_vector.iter().enumerate() {
            whole[visible::place(j, tangent_vector.len() / 2, n)] = x;
        }
        let mut chaos = Chaos {
            tangent: TangentMap::new(system, run),
            tangent_vector: whole,
            m: run.inner.m,
            time,
            elapsed: zero,
            growth: zero,
            weighted: zero,
            sum: zero,
        };
        chaos.normalise();
        chaos
    }

    /// Advances `run` to the time `t`, and propagates over every step.
    ///
    /// # Errors
    /// The errors of `advance_to` of the run, and of [`see`](Self::see).
    pub fn advance_to(&mut self, run: &mut Stepper<T>, t: T) -> Result<(), IntegrateError<T>> {
        while run.advance_towards(t)? {
            self.see(run)?;
        }
        Ok(())
    }

    /// Propagates over the last step of `run`.
    ///
    /// # Errors
    /// The errors of [`TangentMap::propagate`].
    pub fn see(&mut self, run: &Stepper<T>) -> Result<(), IntegrateError<T>> {
        self.tangent.propagate(run, &mut self.tangent_vector)?;
        let growth = self.normalise().ln();
        let (before, step) = (self.elapsed, (run.time() - self.time).abs());
        let now = before + step;
        self.growth += growth;
        self.weighted += growth * (before + now) / T::int(2);
        // Y at the end of the step represents the step.
        self.sum += T::int(2) * self.weighted / now * step;
        (self.time, self.elapsed) = (run.time(), now);
        Ok(())
    }

    /// Normalises δ to length 1. Returns its previous length. The component of the momentum of time has no
    /// effect on the others, and is not part of the length.
    fn normalise(&mut self) -> T {
        let half = self.tangent_vector.len() / 2;
        self.tangent_vector[half + self.m..].fill(T::int(0));
        let squares = self
            .tangent_vector
            .iter()
            .fold(T::int(0), |sum, &x| sum + x * x);
        let length = squares.sqrt();
        self.tangent_vector.iter_mut().for_each(|x| *x /= length);
        length
    }

    /// λ(t), per unit of time.
    pub fn lyapunov(&self) -> T {
        self.growth / self.elapsed
    }

    /// The time average of MEGNO.
    pub fn megno(&self) -> T {
        self.sum / self.elapsed
    }

    /// λ(t) and MEGNO.
    pub fn indicators(&self) -> ChaosIndicators<T> {
        ChaosIndicators {
            lyapunov: self.lyapunov(),
            megno: self.megno(),
        }
    }

    /// The tangent vector, normalised to length 1.
    pub fn tangent_vector(&self) -> &[T] {
        &self.tangent_vector
    }
}

/// A default tangent vector: no component vanishes, and no two components are equal.
pub(crate) fn any_tangent_vector<T: Float>(n: usize) -> Vec<T> {
    (1..=n).map(|j| T::int(j as i64).sin()).collect()
}

impl<T: Float> Chaos<T> {
    /// Writes the tangent vector and its sums to a checkpoint, or reads them.
    pub(crate) fn remember(&mut self, memory: &mut Memory<'_>) {
        memory.finite("the tangent vector", &mut self.tangent_vector);
        let mut sums = [self.elapsed, self.growth, self.weighted, self.sum];
        memory.finite("the sums of the tangent vector", &mut sums);
        [self.elapsed, self.growth, self.weighted, self.sum] = sums;
    }
}
