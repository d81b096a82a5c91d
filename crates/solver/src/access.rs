//! What a run needs of a step, all in one place: everything public of [`Core`] and [`Constraint`] but
//! [`Core::new`], [`Core::step`] and [`Core::forget`].

use crate::MAX_STAGES;
use crate::constraint::Constraint;
use crate::failure::Damaged;
use crate::memory::SolverMemory;
use crate::newton::NewtonRecord;
use crate::options::{OnNoAlpha, StageSolver};
use crate::outcome::Counts;
use crate::parts::Part;
use crate::ready::ready;
use crate::springs::Springs;
use crate::state::State;
use crate::step::Core;
use crate::step_swept::Pause;
use crate::sweep_task::Rule;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_tableau::Gauss;

/// Where the step that failed last began, or the part of it that failed.
#[derive(Debug, Clone, Copy)]
pub struct FailedPart<'a, T> {
    /// y there, length n.
    pub start: &'a [T],
    /// Its time.
    pub time: T,
    /// Size of the part.
    pub step: T,
    /// How often the step might have been halved.
    pub max_halvings: u32,
}

/// What is fixed, and what has been counted.
impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// Nodes and weights.
    pub fn gauss(&self) -> &Gauss<T> {
        &self.stages.gauss
    }

    /// n = 2m.
    pub fn components(&self) -> usize {
        self.stages.n
    }

    /// H and its derivatives, for evaluations beside the steps.
    pub fn energy_mut(&mut self) -> &mut E {
        &mut self.energy
    }

    /// Work and outcomes so far; outcomes are recorded by the run.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// The same, to be added to.
    pub fn counts_mut(&mut self) -> &mut Counts {
        &mut self.counts
    }

    /// The evaluator with the counts.
    pub fn energy_and_counts(&mut self) -> (&mut E, &mut Counts) {
        (&mut self.energy, &mut self.counts)
    }

    /// hω of the stiffest spring that sweeps do not solve for, if steps are of one size.
    pub fn unresolved_spring(&self) -> Option<T> {
        self.unresolved_spring
    }
}

/// The step made last.
impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// α_1 … α_{s−1} of the step, or of its last part.
    pub fn alphas(&self) -> &[T] {
        &self.stages.alphas
    }

    /// Whether all of them are zero.
    pub fn alphas_are_zero(&self) -> bool {
        self.stages.alphas_are_zero
    }

    /// L_i = h b_i J∇H(Y_i) stage by stage, blocks of length n, and h. The L of a step that sweeps have made
    /// is copied here when it is first asked for.
    pub fn stage_derivatives(&mut self) -> (&[T], T) {
        self.fetch_l();
        self.guess.last()
    }

    /// h γ_k = Σ_i P_k(c_i) L_i for k < s into `out`, blocks of length n: u'(τ) = Σ_k γ_k P_k(τ) within the
    /// step.
    pub fn legendre_coefficients(&mut self, out: &mut [T]) {
        self.fetch_l();
        let (stages, l) = (&self.stages, self.guess.last().0);
        for (k, out) in out.chunks_exact_mut(stages.n).enumerate() {
            out.fill(T::int(0));
            let values = stages.gauss.legendre(k).iter();
            for (&p, l) in values.zip(l.chunks_exact(stages.n)) {
                out.iter_mut().zip(l).for_each(|(sum, &l)| *sum += p * l);
            }
        }
    }

    /// L component by component as sweeps have it, component c of stage i at
    /// c·[`stride_for`](crate::stride_for)(s) + i; `None` if sweeps have not made the step.
    pub fn derivatives_by_component(&self) -> Option<&[T]> {
        let sweeps = self.sweeps.as_ref()?;
        self.guess.is_swept().then_some(&*sweeps.iterate.l)
    }

    /// Z_i = Y_i − y0 stage by stage, blocks of length n, of a step from `y`.
    pub fn stage_increments(&mut self, y: &State<T>) -> &[T] {
        if let (Some(sweeps), true) = (&mut self.sweeps, self.guess.is_swept()) {
            (ready::<T>().give_z)(&mut sweeps.iterate, y, &mut self.stages.z);
        }
        &self.stages.z
    }

    /// The parts of the step in the order of time, one if it was not halved; empty unless
    /// [wanted](Self::keep_parts).
    pub fn parts(&self) -> &[Part<T>] {
        self.parts.all()
    }

    /// How the sweeps of the step contracted, if they were tried and are most of its work, as a power that
    /// goes like h.
    pub fn contraction(&self) -> Option<f64> {
        if self.rule == Rule::Newton && !self.constraints.is_empty() {
            return None;
        }
        let sweeps = self.sweeps.as_ref()?;
        let rate = sweeps.contraction.seen;
        // With the positions alone as unknowns a sweep is two.
        let contraction = match sweeps.iterate.kinetic {
            Some(_) => rate.sqrt(),
            None => rate,
        };
        (contraction > 0.0).then_some(contraction)
    }

    /// Newton iterations of the step (or part of a halved one) solved last.
    pub fn newton_history(&self) -> &[NewtonRecord<T>] {
        &self.newton.history
    }

    /// What is kept by the α's: the energy first unless it needs none, then further invariants.
    pub fn constraints(&self) -> &[Constraint<T>] {
        &self.constraints
    }

    /// Where the step that failed last began.
    pub fn failed_part(&self) -> FailedPart<'_, T> {
        FailedPart {
            start: &self.failed.0,
            time: self.failed.1,
            step: self.failed.2,
            max_halvings: self.options.max_halvings,
        }
    }
}

/// The start of a run.
impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// A run begins at `y`, length n, where the energy is `h_ref`, with steps of one size `h` or of any: the
    /// steps from here on are those of a new solver. Counts stay. Costs at most one Hessian; only stiff
    /// springs, when they are first found, take room that was not there.
    pub fn begin(&mut self, h_ref: T, y: &[T], h: Option<T>) {
        self.forget();
        self.parts.clear();
        self.newton.history.clear();
        let zeros = [T::int(0); MAX_STAGES];
        self.stages.set_alphas(&zeros[..self.start_alphas.len()]);
        self.start.y.fill(T::NAN);
        for constraint in &mut self.constraints {
            constraint.begin(h_ref, y);
        }
        self.unresolved_spring = None;
        match (h, &mut self.sweeps) {
            (Some(h), _) => self.find_springs((y, h)),
            (None, Some(sweeps)) => sweeps.set_springs(None),
            (None, None) => {}
        }
    }
}

/// What the next step is to do.
impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// Keep the parts of every step from the next on.
    pub fn keep_parts(&mut self) {
        self.parts.wanted = true;
    }

    /// The step made last is refused: the next one starts where it did, and is guessed from it.
    pub fn refuse(&mut self) {
        self.guess.refuse();
    }

    /// The next step is guessed from these L, stage by stage, of a step of size `h` from the same state, and
    /// from nothing else.
    pub fn guess_from(&mut self, l: &[T], h: T) {
        self.forget();
        self.guess.remember(l, h);
        self.guess.refuse();
    }

    /// What becomes of a step without an admissible α; with `last_resort` it is tried with fewer of them
    /// before.
    pub fn set_on_no_alpha(&mut self, choice: OnNoAlpha, last_resort: bool) {
        self.options.on_no_alpha = choice;
        self.last_resort = last_resort;
    }

    /// Steps are to be made backwards as well: Newton's α's are the same then to the last few bits, those by
    /// sweeps to 1e-16 … 1e-14.
    pub fn make_reversible(&mut self) {
        if self.options.stage_solver != StageSolver::Sweeps {
            self.rule = Rule::Newton;
        }
    }

    /// Puts other constraints in the place of those there are, which are returned. Without any the α's stay
    /// where they are.
    pub fn replace_constraints(&mut self, constraints: Vec<Constraint<T>>) -> Vec<Constraint<T>> {
        std::mem::replace(&mut self.constraints, constraints)
    }

    /// Divides what floors the constraints have inherited from earlier steps, where a defect they excuse can
    /// be repaired.
    pub fn fade_inherited_floors(&mut self, divisor: i64) {
        if self.can_repair() {
            for constraint in &mut self.constraints {
                constraint.inherited /= T::int(divisor);
            }
        }
    }
}

impl<T: Float> Constraint<T> {
    /// I at the start of the run.
    pub fn reference(&self) -> T {
        self.reference
    }

    /// g = I(y1) − I_ref at the end of the step.
    pub fn defect(&self) -> T {
        self.defect
    }

    /// Below this g is round-off of this step.
    pub fn floor(&self) -> T {
        self.floor
    }
}

/// What is remembered between steps.
impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// Everything the next step depends on besides state, time, size and counts.
    pub fn memory(&mut self) -> SolverMemory<T> {
        self.fetch_l();
        let mut memory = SolverMemory::from_parts(Vec::new());
        let (l, h) = self.guess.last();
        memory.put("guess", std::iter::once(h).chain(l.iter().copied()));
        memory.put("alphas", self.stages.alphas.iter().copied());
        let references = self.constraints.iter().map(|c| c.reference);
        memory.put("references", references);
        memory.put("floors", self.constraints.iter().map(|c| c.inherited));
        let pauses = std::iter::once(&self.pause).chain(&self.halved);
        memory.put_counts("pauses", pauses.flat_map(Pause::memory).map(u64::from));
        if !self.constraints.is_empty() {
            let start = self.start.y.iter().chain(&self.start.gradient);
            memory.put("gradient", start.copied());
        }
        self.newton.save(&mut memory);
        if let Some(sweeps) = &self.sweeps {
            sweeps.save(&mut memory);
            if let Some(springs) = &sweeps.iterate.springs {
                springs.save(&mut memory);
            }
        }
        memory.put("unresolved spring", self.unresolved_spring);
        memory
    }

    /// Takes over what another solver of the same system and options has remembered.
    ///
    /// # Errors
    /// When something is missing or does not fit; the solver is then to be thrown away.
    pub fn restore(&mut self, memory: &SolverMemory<T>) -> Result<(), Damaged> {
        let mut guess = vec![T::int(0); 1 + self.guess.last().0.len()];
        memory.read("guess", &mut guess)?;
        self.guess.remember(&guess[1..], guess[0]);
        let mut alphas = vec![T::int(0); self.stages.alphas.len()];
        memory.read("alphas", &mut alphas)?;
        self.stages.set_alphas(&alphas);
        let mut numbers = vec![T::int(0); self.constraints.len()];
        memory.read("references", &mut numbers)?;
        for (constraint, &reference) in self.constraints.iter_mut().zip(&numbers) {
            constraint.reference = reference;
        }
        memory.read("floors", &mut numbers)?;
        for (constraint, &floor) in self.constraints.iter_mut().zip(&numbers) {
            constraint.inherited = floor;
        }
        let mut pauses = vec![T::int(0); 2 * (1 + self.halved.len())];
        memory.read("pauses", &mut pauses)?;
        let all = std::iter::once(&mut self.pause).chain(&mut self.halved);
        for (pause, stored) in all.zip(pauses.chunks_exact(2)) {
            *pause = Pause::of([0, 1].map(|i| stored[i].to_f64() as u32));
        }
        if !self.constraints.is_empty() {
            let n = self.start.y.len();
            let mut start = vec![T::int(0); 2 * n];
            memory.read("gradient", &mut start)?;
            self.start.y.copy_from_slice(&start[..n]);
            self.start.gradient.copy_from_slice(&start[n..]);
        }
        self.newton.restore(memory)?;
        if let Some(sweeps) = &mut self.sweeps {
            sweeps.restore(memory)?;
            let found = match sweeps.iterate.kinetic.as_ref().and_then(|k| k.diagonal()) {
                Some(w) => {
                    Springs::from_memory((&self.newton.linearised.hessians.pattern, w), memory)?
                }
                None => None,
            };
            sweeps.set_springs(found);
        }
        self.unresolved_spring = memory
            .find("unresolved spring")
            .and_then(|x| x.first().copied());
        Ok(())
    }
}

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// Sees to it that L of the step made last stands in the stages and in the guess: sweeps keep it in their
    /// own order.
    pub(crate) fn fetch_l(&mut self) {
        let Some(sweeps) = &self.sweeps else {
            return;
        };
        if self.guess.is_swept() {
            self.guess.fetch(|l| sweeps.iterate.give_l(l));
            self.stages.l.copy_from_slice(self.guess.last().0);
        }
    }
}
