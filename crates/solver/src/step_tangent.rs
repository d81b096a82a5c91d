//! [`StepTangent`]: the tangent map of a step.
//!
//! With the stages Y_i and α_k of a step and B_i = h b_i J∇²H(Y_i),
//!
//! $$ X_i = \delta y_0 + \sum_j K_{ij}(\alpha) B_j X_j, \qquad \delta y_1 = \delta y_0 + \sum_j B_j X_j , $$
//!
//! solved by [`LinearIteration`]. If its iteration does not contract (about hω > 1), it is preconditioned
//! like the stages ([`crate::precondition::choice`]).
//!
//! This is the derivative at fixed α. If α = D t conserves the energy, t depends on y0 as well. The condition
//! H(y1) = H(y0) along neighbouring solutions determines δt. With v = ∂y1/∂t
//!
//! $$ \delta y_1 \leftarrow \delta y_1 - v\, \frac{\nabla H(y_1)\cdot\delta y_1 - \nabla H(y_0)\cdot\delta
//!    y_0}{\nabla H(y_1)\cdot v}, $$
//!
//! Only the direction of v matters: it is the response to r = (K(α) − K(0)) L. The change of D is neglected;
//! its effect is of the order of the change of y1 caused by α.
//!
//! Cost: s Hessians per step, and some linear iterations for each tangent vector and for v. A preconditioner
//! is computed once a step.

use crate::alpha::least_displacement::dot;
use crate::options::step_options::Preconditioner;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Counts;
use crate::outcome::parts::Part;
use crate::precondition::choice::Choice;
use crate::step::core::Core;
use equip_autodiff::{Evaluator, Hamiltonian};
use equip_iterate::{Held, Iterate, LinearIteration, State};
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// The tangent map of successive steps.
#[derive(Debug)]
pub struct StepTangent<T: Float> {
    energy: Evaluator<T>,
    method: Coefficients<T>,
    iterate: Iterate<T>,
    linear: LinearIteration<T>,
    choice: Choice<T>,
    /// Whether the chosen preconditioner has been computed.
    is_made: bool,
    /// K(α) and K(0), row by row.
    k: Vec<T>,
    k_start: Vec<T>,
    start: State<T>,
    h: T,
    is_finite: bool,
    r: Vec<T>,
    x: Vec<T>,
    /// Whether the energy, and nothing else, is conserved by α.
    conserves_energy: bool,
    /// Whether α ≠ 0 in this part, so that v is needed.
    needs_v: bool,
    /// v/(∇H(y1)·v), or zero if it is not known.
    v: Vec<T>,
    /// y0 and y1, and ∇H at both.
    ends: Vec<T>,
    gradients: Vec<T>,
}

impl<T: Float> StepTangent<T> {
    /// For the steps of `core`, which must belong to the same `system`.
    pub fn new(system: &Hamiltonian, core: &Core<T>) -> Self {
        let method = core.method().clone();
        let (s, n) = (method.stages(), 2 * system.degrees_of_freedom());
        let zeros = |len: usize| vec![T::int(0); len];
        let structure = system.structure();
        let iterate = Iterate::prepare(&method, n, None, &zeros(method.alphas()));
        let len = n * iterate.stride();
        let mut k_start = zeros(s * s);
        method.matrix_into(&zeros(method.alphas()), &mut k_start);
        StepTangent {
            energy: system.evaluator::<T>(),
            linear: LinearIteration::new(&method, &iterate, structure.hessian.to_pattern(), 1),
            choice: Choice::new(Preconditioner::Automatic, (&method, &iterate), structure),
            is_made: false,
            k: zeros(s * s),
            k_start,
            start: State::new(&zeros(n), &[]),
            h: T::int(0),
            is_finite: true,
            r: zeros(len),
            x: zeros(len),
            conserves_energy: core.conserves_energy_alone(),
            needs_v: false,
            v: zeros(n),
            ends: zeros(2 * n),
            gradients: zeros(2 * n),
            iterate,
            method,
        }
    }

    /// The number of components n = 2m.
    pub fn components(&self) -> usize {
        self.iterate.components()
    }

    pub(crate) fn make(&mut self, part: &Part<T>) {
        self.method.matrix_into(&part.alphas, &mut self.k);
        self.start.copy_from(&part.start);
        self.h = part.h;
        let of = (part.l.as_slice(), self.k.as_slice());
        (self.iterate).set_stages(&self.method, (&part.start, part.h), of);
        self.linear
            .set_k(&self.k, (self.method.stages(), self.iterate.stride()));
        self.is_finite = self.linear.linearise(&self.iterate, &mut self.energy);
        // The result must depend on the part alone.
        self.choice.forget();
        self.is_made = false;
        let is_moved = part.alphas.iter().any(|&alpha| alpha != T::int(0));
        self.needs_v = self.conserves_energy && is_moved && self.is_finite;
        self.v.fill(T::int(0));
        if self.needs_v {
            let n = self.v.len();
            let (y0, y1) = self.ends.split_at_mut(n);
            y0.copy_from_slice(&part.start.hi);
            y1.copy_from_slice(&part.start.hi);
            for l in part.l.chunks_exact(n) {
                y1.iter_mut().zip(l).for_each(|(y, &l)| *y += l);
            }
            (self.energy).gradients(&self.ends, &mut self.gradients, n);
            self.take_difference(part);
        }
    }

    /// r = (K(α) − K(0)) L.
    fn take_difference(&mut self, part: &Part<T>) {
        let (s, stride, n) = (self.method.stages(), self.iterate.stride(), self.v.len());
        for (c, r) in self.r.chunks_exact_mut(stride).enumerate() {
            for (i, r) in r.iter_mut().enumerate().take(s) {
                let row = self.k[i * s..].iter().zip(&self.k_start[i * s..]).take(s);
                let terms = row
                    .enumerate()
                    .map(|(j, (&k, &k0))| (k - k0) * part.l[j * n + c]);
                *r = terms.fold(T::int(0), |sum, x| sum + x);
            }
        }
    }

    pub(crate) fn propagate_part(&mut self, tangent_vector: &mut [T]) -> Result<(), Failure<T>> {
        if !self.is_finite {
            return Err(Failure::NotFinite);
        }
        let (s, stride, n) = (self.method.stages(), self.iterate.stride(), self.v.len());
        if std::mem::replace(&mut self.needs_v, false) {
            // Since α is small, √ε is the accuracy that rounding leaves in r. Without v the derivative is
            // that at fixed α.
            if self.solve(T::EPSILON.sqrt()) {
                self.v.copy_from_slice(&self.linear.sums()[..n]);
                let derivative = dot(&self.gradients[n..], &self.v);
                self.v.iter_mut().for_each(|v| *v /= derivative);
            }
            if self.v.iter().any(|v| !v.is_finite()) {
                self.v.fill(T::int(0));
            }
        }
        for (row, &x) in self.r.chunks_exact_mut(stride).zip(&*tangent_vector) {
            row[..s].fill(x);
        }
        while !self.solve(T::int(4) * T::EPSILON) {
            if !self.choice.escalate() {
                return Err(Failure::Singular);
            }
            self.is_made = false;
        }
        let before = dot(&self.gradients[..n], tangent_vector);
        for (x, &sum) in tangent_vector.iter_mut().zip(self.linear.sums()) {
            *x += sum;
        }
        let changed = dot(&self.gradients[n..], tangent_vector) - before;
        for (x, &v) in tangent_vector.iter_mut().zip(&self.v) {
            *x -= v * changed;
        }
        Ok(())
    }

    /// Solves with the chosen preconditioner, to this relative error of Σ δL.
    fn solve(&mut self, tolerance: T) -> bool {
        let (at, step) = ((&self.method, &self.iterate), (&self.start, self.h));
        self.is_made = self.is_made
            || self
                .choice
                .make(at, &mut self.energy, step, &mut Counts::default());
        if !self.is_made {
            return false;
        }
        let sides = (self.r.as_slice(), self.x.as_mut_slice());
        let to_tolerance = (self.iterate.inverse_scale(), tolerance);
        let m = self.choice.operator();
        self.linear
            .solve(Held::Start, sides, to_tolerance, &self.iterate, m)
    }
}
