//! Many runs of one system over threads: a row for each start, in the order of the starts.
//!
//! A row is what a run of its own makes, bit for bit, whatever the number of threads: threads share the
//! numbers of the starts that are left and nothing else, and each prepares the method once.

use crate::error::IntegrateError;
use crate::options::integrator::Integrator;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::view::StepView;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use std::ops::{ControlFlow, RangeInclusive};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The starts of an ensemble and the interval of all its runs.
#[derive(Debug, Clone, Copy)]
pub struct Starts<'a, T> {
    /// Positions at the starts, N × m, one start after the other.
    pub q0: &'a [T],
    /// Momenta at the starts, N × m.
    pub p0: &'a [T],
    /// Time of all starts.
    pub start: T,
    /// Time at which all runs end.
    pub end: T,
}

impl<'a, T: Float> Starts<'a, T> {
    /// N starts over one interval of time.
    pub fn new(q0: &'a [T], p0: &'a [T], interval: RangeInclusive<T>) -> Self {
        let (start, end) = interval.into_inner();
        Starts { q0, p0, start, end }
    }
}

impl<T: Float> Integrator<T> {
    /// Integrates from each of the starts over the threads of the present pool of rayon, and returns what
    /// `row` makes of each run: `row(i, run)` is called on the thread that made run number i. `stop` is asked
    /// before every run and after every step; once it is true, the runs that are not finished are `None`.
    ///
    /// A run that fails is a row like any other. What does not depend on the initial condition is prepared
    /// once a thread.
    ///
    /// # Errors
    /// Faults of options and steps, which are those of all runs; [`IntegrateError::WrongLength`] if there are
    /// not as many momenta as positions, or they are not those of whole starts.
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
        // Numbers of the runs that this thread makes, one after the other until none is left.
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
