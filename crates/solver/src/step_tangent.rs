//! [`StepTangent`]: the derivative of a step at fixed α.
//!
//! With the stages Y_i and α's of a step and B_i = h b_i J∇²H(Y_i),
//!
//! $$ X_i = \delta y_0 + \sum_j K_{ij}(\alpha) B_j X_j, \qquad \delta y_1 = \delta y_0 + \sum_j B_j X_j , $$
//!
//! by [`LinearSweeps`], preconditioned as the stages are ([`crate::precondition::choice`]) where these do not
//! contract (about hω > 1).
//!
//! Cost: s Hessians per step; per deviation some linear sweeps. A preconditioner is made once a step.

use crate::options::step_options::Preconditioner;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Counts;
use crate::outcome::parts::Part;
use crate::precondition::choice::Choice;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_sweeps::{Held, Iterate, LinearSweeps, State};
use equip_tableau::Gauss;

/// The tangent map of one step after the other.
#[derive(Debug)]
pub struct StepTangent<T: Float, E> {
    energy: E,
    gauss: Gauss<T>,
    iterate: Iterate<T>,
    linear: LinearSweeps<T>,
    choice: Choice<T>,
    /// The preconditioner that is chosen is there.
    is_made: bool,
    /// K(α), row by row.
    k: Vec<T>,
    start: State<T>,
    h: T,
    is_finite: bool,
    r: Vec<T>,
    x: Vec<T>,
}

impl<T: Float, E: Evaluate<T>> StepTangent<T, E> {
    /// For steps of `system` with the nodes of `gauss`.
    pub fn new<H: System<Evaluator<T> = E>>(system: &H, gauss: Gauss<T>) -> Self {
        let (s, n) = (gauss.stages(), 2 * system.degrees_of_freedom());
        let zeros = |len: usize| vec![T::int(0); len];
        let structure = system.structure();
        let iterate = Iterate::prepare(&gauss, n, None, &zeros(s - 1));
        let len = n * iterate.stride();
        StepTangent {
            energy: system.evaluator::<T>(),
            linear: LinearSweeps::new(&gauss, &iterate, structure.hessian.to_pattern(), 1),
            choice: Choice::new(Preconditioner::Automatic, (&gauss, &iterate), structure),
            is_made: false,
            k: zeros(s * s),
            start: State::new(&zeros(n), &[]),
            h: T::int(0),
            is_finite: true,
            r: zeros(len),
            x: zeros(len),
            iterate,
            gauss,
        }
    }

    /// n = 2m.
    pub fn components(&self) -> usize {
        self.iterate.components()
    }

    pub(crate) fn make(&mut self, part: &Part<T>) {
        self.gauss.skew_into(&part.alphas, &mut self.k);
        self.start.copy_from(&part.start);
        self.h = part.h;
        let of = (part.l.as_slice(), self.k.as_slice());
        (self.iterate).set_stages(&self.gauss, (&part.start, part.h), of);
        self.linear
            .set_k(&self.k, (self.gauss.stages(), self.iterate.stride()));
        self.is_finite = self.linear.linearise(&self.iterate, &mut self.energy);
        // What is carried depends on the part alone.
        self.choice.forget();
        self.is_made = false;
    }

    pub(crate) fn propagate(&mut self, deviation: &mut [T]) -> Result<(), Failure<T>> {
        if !self.is_finite {
            return Err(Failure::NotFinite);
        }
        let (s, stride) = (self.gauss.stages(), self.iterate.stride());
        for (row, &x) in self.r.chunks_exact_mut(stride).zip(&*deviation) {
            row[..s].fill(x);
        }
        while !self.solve() {
            if !self.choice.escalate() {
                return Err(Failure::Singular);
            }
            self.is_made = false;
        }
        for (x, &sum) in deviation.iter_mut().zip(self.linear.sums()) {
            *x += sum;
        }
        Ok(())
    }

    /// With the preconditioner that is chosen.
    fn solve(&mut self) -> bool {
        let (at, step) = ((&self.gauss, &self.iterate), (&self.start, self.h));
        self.is_made = self.is_made
            || self
                .choice
                .make(at, &mut self.energy, step, &mut Counts::default());
        if !self.is_made {
            return false;
        }
        let sides = (self.r.as_slice(), self.x.as_mut_slice());
        let to_rest = (self.iterate.inverse_scale(), T::int(4) * T::EPSILON);
        let m = self.choice.operator();
        self.linear
            .solve(Held::Start, sides, to_rest, &self.iterate, m)
    }
}
