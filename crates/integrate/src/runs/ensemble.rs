//! Many runs of one system in parallel: one row for each initial state, in the order of the initial states.
//!
//! A row agrees bit for bit with that of a single run, for any number of threads. Threads share only the
//! index of the next initial state, and each prepares the method once.
//!
//! Initial states may be drawn at random around a given one. Each depends on the seed and its own index only,
//! not on threads or order.

use crate::error::IntegrateError;
use crate::options::integrator::Integrator;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::view::StepView;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::ops::{ControlFlow, RangeInclusive};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The initial states of an ensemble, and the interval of all its runs.
#[derive(Debug, Clone, Copy)]
pub struct Starts<'a, T> {
    /// The initial positions, N × m, one state after the other.
    pub q0: &'a [T],
    /// The initial momenta, N × m.
    pub p0: &'a [T],
    /// The initial time of all runs.
    pub start: T,
    /// The final time of all runs.
    pub end: T,
}

impl<'a, T: Float> Starts<'a, T> {
    /// N initial states over one interval of time.
    pub fn new(q0: &'a [T], p0: &'a [T], interval: RangeInclusive<T>) -> Self {
        let (start, end) = interval.into_inner();
        Starts { q0, p0, start, end }
    }
}

impl<T: Float> Integrator<T> {
    /// Integrates from each initial state, in parallel on the current thread pool of rayon. Returns the
    /// results of `row`, where `row(i, run)` is called on the thread of run number i. `stop` is called before
    /// every run and after every step; once it returns true, runs that are not finished are `None`.
    ///
    /// A failed run is a row like any other. Everything that does not depend on the initial state is prepared
    /// once per thread.
    ///
    /// # Errors
    /// Invalid options and steps, which concern all runs; [`IntegrateError::WrongLength`] if the numbers of
    /// momenta and positions differ, or are not multiples of m.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::{Equip, Starts};
    ///
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let (angles, momenta) = ([0.5, 1.0, 1.5], [0.0; 3]);
    /// let starts = Starts::new(&angles, &momenta, 0.0..=10.0);
    /// let ends = Equip::stages(4).step(0.1).ensemble(
    ///     &pendulum,
    ///     starts,
    ///     |_, run| run.map(|run| run.last().1[0]),
    ///     || false,
    /// )?;
    /// assert!(ends.iter().all(|end| matches!(end, Some(Ok(angle)) if angle.abs() <= 1.5)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn ensemble<R: Send>(
        &self,
        system: &Hamiltonian,
        starts: Starts<'_, T>,
        row: impl Fn(usize, Result<Run<T>, RunFailure<T>>) -> R + Sync,
        stop: impl Fn() -> bool + Sync,
    ) -> Result<Vec<Option<R>>, IntegrateError<T>> {
        drop(self.prepare(system)?);
        let m = system.degrees_of_freedom() - usize::from(system.has_time());
        let members = starts.q0.len() / m;
        for (what, found) in [("q0", starts.q0.len()), ("p0", starts.p0.len())] {
            if found != members * m {
                return Err(IntegrateError::WrongLength {
                    what,
                    expected: members * m,
                    found,
                });
            }
        }
        let next = AtomicUsize::new(0);
        // The index of the next run of this thread, until none is left.
        let take = || {
            let left = next.fetch_add(1, Relaxed);
            (left < members && !stop()).then_some(left)
        };
        let work = || {
            let mut made = Vec::new();
            let Some(mut i) = take() else { return made };
            let Ok(mut prepared) = self.prepare(system) else {
                return made;
            };
            loop {
                let mut is_cut = false;
                let mut watch = |_: &StepView<'_, T>| {
                    is_cut = stop();
                    match is_cut {
                        true => ControlFlow::Break(()),
                        false => ControlFlow::Continue(()),
                    }
                };
                let [q, p] = [starts.q0, starts.p0].map(|all| &all[i * m..][..m]);
                let interval = starts.start..=starts.end;
                let run = prepared.integrate_observed(q, p, interval, &mut watch);
                if is_cut {
                    return made;
                }
                made.push((i, row(i, run)));
                match take() {
                    Some(following) => i = following,
                    None => return made,
                }
            }
        };
        let mut rows: Vec<Option<R>> = (0..members).map(|_| None).collect();
        for (i, made) in rayon::broadcast(|_| work()).into_iter().flatten() {
            rows[i] = Some(made);
        }
        Ok(rows)
    }
}

/// The initial state with this `index` that `seed` draws around (`q0`, `p0`), each of length m: every
/// component x becomes x (1 + `spread` u), with an independent u uniform in [−1, 1) for each component.
/// Components that are zero stay zero.
///
/// u comes from ChaCha8, with the key from the seed and the stream from the index: 53 bits of one 64-bit word
/// for each component, those of q first. The states are the same on every machine.
///
/// ```
/// use equip_integrate::drawn_start;
/// let (q, p) = drawn_start(&[1.0, 0.0], &[0.0, 2.0], 0.01, 7, 3);
/// assert!((q[0] - 1.0f64).abs() <= 0.01 && (p[1] - 2.0).abs() <= 0.02);
/// assert_eq!((q[1], p[0]), (0.0, 0.0));
/// assert_eq!((q, p), drawn_start(&[1.0, 0.0], &[0.0, 2.0], 0.01, 7, 3));
/// ```
pub fn drawn_start<T: Float>(
    q0: &[T],
    p0: &[T],
    spread: T,
    seed: u64,
    index: u64,
) -> (Vec<T>, Vec<T>) {
    let mut words = ChaCha8Rng::seed_from_u64(seed);
    words.set_stream(index);
    let mut draw = |&x: &T| {
        let bits = (words.next_u64() >> 11) as f64; // in units of 2⁻⁵³
        let u = bits * f64::EPSILON - 1.0;
        x + x * (spread * T::exact(u))
    };
    (
        q0.iter().map(&mut draw).collect(),
        p0.iter().map(&mut draw).collect(),
    )
}
