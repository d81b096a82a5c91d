//! [`StepTangent`]: the derivative of a step at fixed α.
//!
//! With the stages Y_i and α's of a step and B_i = h b_i J∇²H(Y_i),
//!
//! $$ X_i = \delta y_0 + \sum_j K_{ij}(\alpha) B_j X_j, \qquad \delta y_1 = \delta y_0 + \sum_j B_j X_j , $$
//!
//! by [`LinearSweeps`], with ∇²H at all stages as preconditioner where these do not contract (about hω > 1).
//!
//! Cost: s Hessians per step; per deviation some linear sweeps, or a solve with a dense factorisation made
//! once a step.

use crate::outcome::failure::Failure;
use crate::outcome::parts::Part;
use crate::precondition::full::Full;
use equip_autodiff::{Evaluate, Pattern, System};
use equip_scalar::Float;
use equip_sweeps::{Held, Iterate, LinearSweeps, Preconditioner, State};
use equip_tableau::Gauss;

/// The tangent map of one step after the other.
#[derive(Debug)]
pub struct StepTangent<T: Float, E> {
    energy: E,
    gauss: Gauss<T>,
    pattern: Pattern,
    iterate: Iterate<T>,
    linear: LinearSweeps<T>,
    /// Made when sweeps first fail, and made use of in this step if they have.
    full: Option<Full>,
    is_preconditioned: bool,
    /// K(α), row by row.
    k: Vec<T>,
    start: State<T>,
    h: T,
    is_finite: bool,
    r: Vec<T>,
    x: Vec<T>,
    /// Room for a state and for ∇²H.
    state: Vec<T>,
    hessian: Vec<T>,
}

impl<T: Float, E: Evaluate<T>> StepTangent<T, E> {
    /// For steps of `system` with the nodes of `gauss`.
    pub fn new<H: System<Evaluator<T> = E>>(system: &H, gauss: Gauss<T>) -> Self {
        let (s, n) = (gauss.stages(), 2 * system.degrees_of_freedom());
        let zeros = |len: usize| vec![T::int(0); len];
        let pattern = system.structure().hessian.to_pattern();
        let iterate = Iterate::prepare(&gauss, n, None, &zeros(s - 1));
        let len = n * iterate.stride();
        StepTangent {
            energy: system.evaluator::<T>(),
            linear: LinearSweeps::new(&gauss, &iterate, pattern.clone(), 1),
            full: None,
            is_preconditioned: false,
            k: zeros(s * s),
            start: State::new(&zeros(n), &[]),
            h: T::int(0),
            is_finite: true,
            r: zeros(len),
            x: zeros(len),
            state: zeros(n),
            hessian: zeros(pattern.len()),
            pattern,
            iterate,
            gauss,
        }
    }

    /// n = 2m.
    pub fn components(&self) -> usize {
        self.iterate.components()
    }

    /// Takes the linearised stage equations of `part`. Costs s Hessians.
    pub fn linearise(&mut self, part: &Part<T>) {
        self.gauss.skew_into(&part.alphas, &mut self.k);
        self.start.copy_from(&part.start);
        self.h = part.h;
        let of = (part.l.as_slice(), self.k.as_slice());
        (self.iterate).set_stages(&self.gauss, (&part.start, part.h), of);
        self.linear
            .set_k(&self.k, (self.gauss.stages(), self.iterate.stride()));
        self.is_finite = self.linear.linearise(&self.iterate, &mut self.energy);
        self.is_preconditioned = false;
    }

    /// Carries `deviation`, n components, over the part that has been linearised.
    ///
    /// # Errors
    /// [`Failure::NotFinite`] or [`Failure::Singular`] if the linearised stages cannot be solved for.
    pub fn carry(&mut self, deviation: &mut [T]) -> Result<(), Failure<T>> {
        if !self.is_finite {
            return Err(Failure::NotFinite);
        }
        let (s, stride) = (self.gauss.stages(), self.iterate.stride());
        for (row, &x) in self.r.chunks_exact_mut(stride).zip(&*deviation) {
            row[..s].fill(x);
        }
        if !self.is_preconditioned && !self.solve() {
            let full = self
                .full
                .get_or_insert_with(|| Full::new(&self.gauss, &self.iterate, self.pattern.clone()));
            let room = (self.state.as_mut_slice(), self.hessian.as_mut_slice());
            full.linearise(&self.iterate, &mut self.energy, (&self.start, self.h), room)
                .map_err(|_| Failure::Singular)?;
            self.is_preconditioned = true;
        }
        if self.is_preconditioned && !self.solve() {
            return Err(Failure::Singular);
        }
        for (x, &sum) in deviation.iter_mut().zip(self.linear.sums()) {
            *x += sum;
        }
        Ok(())
    }

    fn solve(&mut self) -> bool {
        let full = self.full.as_mut().filter(|_| self.is_preconditioned);
        let m = full.map(|full| full as &mut dyn Preconditioner<T>);
        let sides = (self.r.as_slice(), self.x.as_mut_slice());
        let to_rest = (self.iterate.inverse_scale(), T::int(4) * T::EPSILON);
        self.linear
            .solve((Held::Start, false), sides, to_rest, &self.iterate, m)
    }
}
