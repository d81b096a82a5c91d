//! [`Chaos`]: indicators of regular and chaotic motion.
//!
//! A tangent vector δ is propagated and normalised to length 1 after every step. The growth ln|δ_{n+1}|/|δ_n|
//! of each step gives:
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
use crate::report::chaos_indicators::ChaosIndicators;
use crate::steppers::integration::Integration;
use crate::tangent::tangent_map::TangentMap;
use crate::time::visible;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

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
    /// The time of the run, and the time covered since the initial tangent vector.
    time: T,
    elapsed: T,
    /// ln|δ(t)|/|δ(0)|, ∫ s d ln|δ|, ∫ Y ds.
    growth: T,
    weighted: T,
    sum: T,
}

impl<T: Float> Chaos<T> {
    /// Follows `run` from now on.
    pub(crate) fn of(system: &Hamiltonian, run: &mut Integration<T>, tangent_vector: &[T]) -> Self {
        let zero = T::int(0);
        let time = run.time;
        let n = 2 * system.degrees_of_freedom();
        let mut whole = vec![zero; n];
        for (j, &x) in tangent_vector.iter().enumerate() {
            whole[visible::place(j, tangent_vector.len() / 2, n)] = x;
        }
        let mut chaos = Chaos {
            tangent: TangentMap::of(system, run),
            tangent_vector: whole,
            time,
            elapsed: zero,
            growth: zero,
            weighted: zero,
            sum: zero,
        };
        chaos.normalise();
        chaos
    }

    /// Propagates over the last step of `run`.
    pub(crate) fn see_step(&mut self, run: &Integration<T>) -> Result<(), IntegrateError<T>> {
        self.tangent.propagate_over(run, &mut self.tangent_vector)?;
        let growth = self.normalise().ln();
        let (before, step) = (self.elapsed, (run.time - self.time).abs());
        let now = before + step;
        self.growth += growth;
        self.weighted += growth * (before + now) / T::int(2);
        // Y at the end of the step represents the step.
        self.sum += T::int(2) * self.weighted / now * step;
        (self.time, self.elapsed) = (run.time, now);
        Ok(())
    }

    /// Normalises δ to length 1. Returns its previous length.
    fn normalise(&mut self) -> T {
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
