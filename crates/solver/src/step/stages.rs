//! The stages of a method: Z ← Z + M⁻¹ (K(α) L(Z) − Z) from an initial guess to convergence.

use crate::options::step_options::Preconditioner;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Counts;
use crate::precondition::choice::Choice;
use equip_autodiff::{Evaluator, Kinetic, Structure};
use equip_iterate::{Contraction, Iterate, MOST_ITERATIONS, Polynomial, Progress, State};
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// The stages and their iteration.
#[derive(Debug)]
pub(crate) struct Stages<T: Float> {
    pub(crate) method: Coefficients<T>,
    pub(crate) iterate: Iterate<T>,
    pub(crate) contraction: Contraction,
    pub(crate) choice: Choice<T>,
    polynomial: Polynomial<T>,
    /// Where the next step starts in the last one (0 or 1), and the size of the last step, if its polynomial
    /// gives the initial guess.
    pub(crate) last: Option<(T, T)>,
}

impl<T: Float> Stages<T> {
    /// With the initial α_k of every step.
    pub(crate) fn new(
        method: Coefficients<T>,
        structure: &Structure,
        kinetic: Option<Kinetic<T>>,
        alphas: &[T],
        preconditioner: Preconditioner,
    ) -> Self {
        let n = structure.hessian.dimension();
        let iterate = Iterate::prepare(&method, n, kinetic, alphas);
        Stages {
            contraction: Contraction::new(iterate.is_twofold(), T::EPSILON.to_f64()),
            choice: Choice::new(preconditioner, (&method, &iterate), structure),
            polynomial: Polynomial::new(&method),
            last: None,
            iterate,
            method,
        }
    }

    /// Forgets the last step.
    pub(crate) fn forget(&mut self) {
        self.last = None;
        self.choice.forget();
        self.contraction = Contraction::new(self.iterate.is_twofold(), T::EPSILON.to_f64());
    }

    /// Solves for Z of a step of size `h` from `y`. The initial guess is the polynomial of the last step, or
    /// Z = 0 if M ≠ 1. `known` is ∇H at `y`. Ends as [`converge`](Self::converge) does.
    ///
    /// With M ≠ 1 the polynomial would save no iterations: it takes 1.01 (Gauss) and 1.04 (EQUIP) times as
    /// many in the mean over the grid, and up to 3 times as many if the step does not resolve the motion.
    pub(crate) fn solve(
        &mut self,
        energy: &mut Evaluator<T>,
        (y, h): (&State<T>, T),
        known: Option<&[T]>,
        noise: f64,
        counts: &mut Counts,
    ) -> Result<bool, Failure<T>> {
        let mut last = self.last.take();
        loop {
            match last.take().filter(|_| self.choice.is_identity()) {
                Some((start, size)) => {
                    let polynomial = (&mut self.polynomial, start, size);
                    (self.iterate).begin_from_last(&self.method, (y, h), polynomial, known);
                }
                None => self.iterate.begin(&self.method, (y, h)),
            }
            self.contraction.begin(!self.choice.is_identity());
            let solved = self.converge(energy, (y, h), noise, counts);
            if solved.is_ok() || !self.choice.escalate() {
                return solved;
            }
            counts.preconditioner_changes += 1;
        }
    }

    /// Iterates with the present α from the present Z until Z has converged to round-off, or until its noise
    /// at y1 is at most `noise`. Returns whether it has converged.
    pub(crate) fn converge(
        &mut self,
        energy: &mut Evaluator<T>,
        (y, h): (&State<T>, T),
        noise: f64,
        counts: &mut Counts,
    ) -> Result<bool, Failure<T>> {
        let s = self.iterate.stages() as u64;
        let (mut iterations, mut begins) = (0, true);
        self.contraction.set_target(noise);
        while iterations < MOST_ITERATIONS {
            let is_old = self.choice.follows_stages() && !self.contraction.is_near();
            let makes = is_old || !self.choice.is_made_for(h);
            if makes {
                let at = (&self.method, &self.iterate);
                if !self.choice.make(at, energy, (y, h), counts) {
                    return Err(self.choice.failure());
                }
            }
            if makes || std::mem::take(&mut begins) {
                let amplification = self.choice.amplification(&mut self.iterate);
                self.contraction.set_amplification(amplification);
            }
            let is_identity = self.choice.is_identity();
            let (progress, made) = match self.choice.operator() {
                None => self.iterate.fixed_point(energy, y, &mut self.contraction),
                Some(m) => self
                    .iterate
                    .preconditioned(energy, y, &mut self.contraction, m),
            };
            iterations += made;
            counts.gradients += u64::from(made) * s;
            let of = if is_identity {
                &mut counts.fixed_point_iterations
            } else {
                &mut counts.newton_iterations
            };
            *of += u64::from(made);
            match progress {
                Progress::Converged => return Ok(true),
                Progress::Contracts
                    if self.contraction.is_at_target() && self.iterate.has_increments() =>
                {
                    return Ok(false);
                }
                Progress::Contracts => {}
                Progress::Diverges => break,
            }
        }
        let correction = T::exact(self.contraction.change());
        Err(if correction.is_finite() {
            Failure::NoConvergence {
                iterations,
                correction,
            }
        } else {
            Failure::NotFinite
        })
    }
}
