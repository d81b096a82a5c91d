//! The interface of a step to a run: everything public of [`Core`] and [`Constraint`] except the
//! constructors, [`Core::step`], [`Core::complete`] and [`Core::forget`].

use crate::constraint::Constraint;
use crate::memory::SolverMemory;
use crate::outcome::failure::FailedPart;
use crate::outcome::outcome::Counts;
use crate::outcome::parts::Part;
use crate::step::core::Core;
use equip_autodiff::Evaluator;
use equip_iterate::State;
use equip_scalar::Float;
use equip_tableau::Coefficients;
use std::slice::from_mut;

/// The fixed data, and the counts.
impl<T: Float> Core<T> {
    /// The coefficients of the method.
    pub fn method(&self) -> &Coefficients<T> {
        &self.stages.method
    }

    /// Whether the initial α is zero and the energy is the only constraint.
    pub fn conserves_energy_alone(&self) -> bool {
        let is_zero = self.start_alphas.iter().all(|&alpha| alpha == T::int(0));
        is_zero && matches!(self.constraints.as_slice(), [energy] if energy.is_energy())
    }

    /// The number of components n = 2m.
    pub fn components(&self) -> usize {
        self.stages.iterate.components()
    }

    /// H and its derivatives, for evaluations outside the steps.
    pub fn energy_mut(&mut self) -> &mut Evaluator<T> {
        &mut self.energy
    }

    /// The work and outcomes so far. The run records the outcomes.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// The counts, to be increased.
    pub fn counts_mut(&mut self) -> &mut Counts {
        &mut self.counts
    }

    /// H at `y`. No evaluation is needed at the end of the last step if its energy was checked.
    pub fn energy_at(&mut self, y: &[T]) -> T {
        if self.options.check_energy && self.constraints.is_empty() && self.start == y {
            return self.start_energy;
        }
        self.counts.energies += 1;
        self.energy.compensated_value(y)
    }

    /// The evaluator and the counts.
    pub fn energy_and_counts(&mut self) -> (&mut Evaluator<T>, &mut Counts) {
        (&mut self.energy, &mut self.counts)
    }
}

/// Results of the last step.
impl<T: Float> Core<T> {
    /// α_1 … α_{s−1} of the step, or of its last part if it was halved.
    pub fn alphas(&self) -> &[T] {
        &self.alphas
    }

    /// Whether all α_k are zero.
    pub fn alphas_are_zero(&self) -> bool {
        self.alphas.iter().all(|&alpha| alpha == T::int(0))
    }

    /// L_i = h b_i J∇H(Y_i), component c of stage i at c·[`stride_for`](crate::stride_for)(s) + i.
    pub fn derivatives_by_component(&self) -> &[T] {
        self.stages.iterate.increments()
    }

    /// Writes the stages Y_i of a step from `y` to `points`, stage by stage in blocks of length n.
    pub fn stages_by_stage(&mut self, y: &State<T>, points: &mut [T]) {
        let iterate = &mut self.stages.iterate;
        iterate.keep_momenta(y);
        let (n, stride) = (iterate.components(), iterate.stride());
        for (i, point) in points.chunks_exact_mut(n).enumerate() {
            for (c, x) in point.iter_mut().enumerate() {
                *x = iterate.points()[c * stride + i];
            }
        }
    }

    /// Writes h γ_k = Σ_i P_k(c_i) L_i for k below the degree to `out`, in blocks of length n; further blocks
    /// are 0. Within the step u'(τ) = Σ_k γ_k P_k(τ).
    pub fn legendre_coefficients(&self, out: &mut [T]) {
        let (method, iterate) = (&self.stages.method, &self.stages.iterate);
        out.fill(T::int(0));
        let all = out.chunks_exact_mut(iterate.components());
        for (k, out) in all.enumerate().take(method.degree()) {
            let rows = iterate.increments().chunks_exact(iterate.stride());
            for (out, row) in out.iter_mut().zip(rows) {
                let terms = method.legendre(k).iter().zip(row);
                *out = terms.fold(T::int(0), |sum, (&p, &l)| sum + p * l);
            }
        }
    }

    /// The parts of the step in the order of time: one if the step was not halved, none unless
    /// [requested](Self::keep_parts).
    pub fn parts(&self) -> &[Part<T>] {
        self.parts.all()
    }

    /// The mean contraction of the fixed-point iteration of the step, scaled to be proportional to h. `None`
    /// if the iteration was preconditioned.
    pub fn contraction(&self) -> Option<f64> {
        let rate = self.stages.contraction.mean();
        // If the positions alone are unknowns, one iteration has the effect of two.
        let contraction = if self.stages.iterate.is_twofold() {
            rate.sqrt()
        } else {
            rate
        };
        (self.stages.choice.is_identity() && contraction > 0.0).then_some(contraction)
    }

    /// Whether the iteration of the step was preconditioned. Without a preconditioner its contraction is
    /// about hω/(1.33 s + 0.7) (docs/adr/0005).
    pub fn is_preconditioned(&self) -> bool {
        !self.stages.choice.is_identity()
    }

    /// The constraints for which α is solved: the energy first unless H is at most quadratic, then further
    /// invariants.
    pub fn constraints(&self) -> &[Constraint<T>] {
        &self.constraints
    }

    /// The part that failed last.
    pub fn failed_part(&self) -> &FailedPart<T> {
        &self.failed
    }

    /// The end point of the failed part according to the last iteration, length n.
    pub fn failed_end(&self) -> Vec<T> {
        let rows = (self.stages.iterate.increments()).chunks_exact(self.stages.iterate.stride());
        let sum = |row: &[T]| row.iter().fold(T::int(0), |sum, &l| sum + l);
        (self.failed.start.iter().zip(rows))
            .map(|(&y, row)| y + sum(row))
            .collect()
    }
}

/// Initialisation of a run.
impl<T: Float> Core<T> {
    /// Begins a run at `y`, length n, with the energy `h_ref`. The following steps are those of a new solver.
    /// The counts are preserved. Allocates nothing.
    pub fn begin(&mut self, h_ref: T, y: &[T]) {
        self.forget();
        self.parts.clear();
        self.alphas.copy_from_slice(&self.start_alphas);
        for constraint in &mut self.constraints {
            constraint.begin(h_ref, y);
        }
        if self.constraints.is_empty() {
            self.start.copy_from_slice(y);
            self.start_energy = h_ref;
        }
    }
}

/// Requests for the next steps.
impl<T: Float> Core<T> {
    /// Stores the parts of every step from the next on.
    pub fn keep_parts(&mut self) {
        self.parts.wanted = true;
    }

    /// From the next step on the α_k are computed by [`complete`](Core::complete) only. A step that the step
    /// controller rejects because of its stages then needs none. For steps that are never halved.
    pub fn defer_alphas(&mut self) {
        self.is_deferred = true;
    }

    /// Whether the α_k of a step are computed by [`complete`](Core::complete).
    pub fn defers_alphas(&self) -> bool {
        self.is_deferred
    }

    /// Whether the last step has changed a constraint by more than its round-off level.
    pub fn has_made_errors(&self) -> bool {
        self.constraints.iter().any(Constraint::has_changed)
    }

    /// Called if the last step is rejected: the next step has the same start, and its initial guess follows
    /// from the rejected one.
    pub fn refuse(&mut self) {
        if let Some((start, _)) = &mut self.stages.last {
            *start = T::int(0);
        }
        self.start.fill(T::NAN);
        self.constraints.iter_mut().for_each(Constraint::restore);
        if let Some(solver) = &mut self.alpha_solver {
            solver.handed_on = solver.handed_on_before;
        }
    }

    /// The initial guess of the next step follows only from these L, stage by stage, of a step of size `h`
    /// from the same state.
    pub fn guess_from(&mut self, l: &[T], h: T) {
        self.forget();
        self.stages.iterate.set_increments(l);
        self.stages.last = Some((T::int(0), h));
    }

    /// Replaces the constraints, and returns the previous ones. Without constraints the α_k have their
    /// initial values.
    pub fn replace_constraints(&mut self, constraints: Vec<Constraint<T>>) -> Vec<Constraint<T>> {
        self.start.fill(T::NAN);
        std::mem::replace(&mut self.constraints, constraints)
    }
}

impl<T: Float> Constraint<T> {
    /// I at the initial state of the run.
    pub fn reference(&self) -> T {
        self.reference
    }

    /// g = I(y1) − I_ref at the end of the step.
    pub fn residual(&self) -> T {
        self.residual
    }

    /// ∇I at the end of the step, length n.
    pub fn gradient(&self) -> &[T] {
        &self.gradient
    }

    /// g is round-off if |g| is at most this: the largest recent round-off level.
    pub fn round_off(&self) -> T {
        self.round_off.max(self.late)
    }

    /// The round-off level of g at the end of this step.
    pub fn momentary_round_off(&self) -> T {
        self.round_off
    }

    /// |g| in multiples of the largest recent round-off level.
    pub fn in_late_levels(&self) -> T {
        self.residual.abs() / self.round_off()
    }
}

/// The state of the solver between steps.
impl<T: Float> Core<T> {
    /// Writes everything on which the next step depends, apart from state, time, size and counts, or restores
    /// the memory of another solver of the same system and options.
    pub fn remember(&mut self, memory: &mut dyn SolverMemory<T>) {
        let (iterate, zero) = (&mut self.stages.iterate, T::int(0));
        let n = iterate.components();
        let (start, h) = self.stages.last.unwrap_or((zero, zero));
        let mut guess = vec![zero; 2 + iterate.stages() * n];
        (guess[0], guess[1]) = (start, h);
        iterate.increments_by_stage(&mut guess[2..]);
        memory.numbers("guess", &mut guess);
        iterate.set_increments(&guess[2..]);
        self.stages.last = (guess[1] != zero).then_some((guess[0], guess[1]));
        memory.numbers("alphas", &mut self.alphas);
        for (name, number) in [
            (
                "references",
                (|c| &mut c.reference) as fn(&mut Constraint<T>) -> &mut T,
            ),
            ("round-off levels", |c| &mut c.late),
            ("start errors", |c| &mut c.start_error),
        ] {
            let mut numbers: Vec<T> = self.constraints.iter_mut().map(|c| *number(c)).collect();
            memory.numbers(name, &mut numbers);
            for (constraint, &x) in self.constraints.iter_mut().zip(&numbers) {
                *number(constraint) = x;
            }
        }
        let mut gradients = self.start.clone();
        gradients.extend(self.constraints.iter().flat_map(|c| &c.start_gradient));
        memory.numbers("gradients", &mut gradients);
        let (start, gradients) = gradients.split_at(n);
        self.start.copy_from_slice(start);
        for (constraint, gradient) in self.constraints.iter_mut().zip(gradients.chunks_exact(n)) {
            constraint.start_gradient.copy_from_slice(gradient);
        }
        memory.numbers("energy", from_mut(&mut self.start_energy));
        match &mut self.alpha_solver {
            Some(solver) => memory.numbers("handed on", &mut solver.handed_on),
            None => memory.numbers("handed on", &mut []),
        }
        memory.double("noise", &mut self.noise_expected);
        let mut rate = self.stages.contraction.rate();
        memory.double("contraction", &mut rate);
        self.stages.contraction.set_rate(rate);
        let at = (&self.stages.method, &self.stages.iterate);
        self.stages.choice.remember(at, memory);
    }
}
