//! What a step works with, made once for all steps of a run.

use crate::alpha::direction::Direction;
use crate::alpha::local_error::LocalError;
use crate::equations::constraint::Constraint;
use crate::options::step_options::StepOptions;
use crate::outcome::outcome::{Counts, Outcome};
use crate::outcome::parts::Parts;
use crate::step::stages::Stages;
use equip_autodiff::{Evaluator, Hamiltonian, Structure};
use equip_iterate::{Kept, State};
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// Everything a step works with; no allocation after it is made.
#[derive(Debug)]
pub struct Core<T: Float> {
    pub(crate) energy: Evaluator<T>,
    pub(crate) options: StepOptions<T>,
    pub(crate) counts: Counts,
    /// What the α_k are solved for: the energy first, if it needs any, then further invariants; empty if
    /// there is nothing.
    pub(crate) constraints: Vec<Constraint<T>>,
    /// The stages Z, and what finds them.
    pub(crate) stages: Stages<T>,
    /// α_k, and those that a step starts from: zero, or the fixed ones.
    pub(crate) alphas: Vec<T>,
    pub(crate) start_alphas: Vec<T>,
    /// What they are solved with, if any are free.
    pub(crate) alpha_solver: Option<Box<AlphaSolver<T>>>,
    /// Where ∇I at the start of a step was evaluated, or H, of a method that does not solve for it.
    pub(crate) start: Vec<T>,
    pub(crate) start_energy: T,
    /// Room for ∇H.
    pub(crate) gradient: Vec<T>,
    /// Whether the α_k of a step wait until it is [completed](Self::complete).
    pub(crate) is_deferred: bool,
    /// The noise of y1 that is not seen in the constraints, as the last step had it: the stages with α = 0
    /// need not be solved further where α follows.
    pub(crate) noise_expected: f64,
    /// Outcome of a step without constraints.
    pub(crate) unconstrained: Outcome,
    /// Whether the step that is attempted may be halved.
    pub(crate) may_be_halved: bool,
    /// Mid points of halved steps, one for each level.
    pub(crate) middles: Vec<State<T>>,
    /// What dense output needs of the parts of a step.
    pub(crate) parts: Parts<T>,
    /// State, time and size of the part that failed last.
    pub(crate) failed: (Vec<T>, T, T),
}

/// What the α_k are solved with, if any are free.
#[derive(Debug)]
pub(crate) struct AlphaSolver<T: Float> {
    /// Which way the α_k move.
    pub(crate) direction: Direction<T>,
    /// `None` if no method has two stages more.
    pub(crate) local_error: Option<LocalError<T>>,
    /// The stages and the end point with the α_k that a step starts from.
    pub(crate) kept: Kept<T>,
    pub(crate) unperturbed: State<T>,
    /// The bound on the change of y1 that earlier steps hand on.
    pub(crate) handed_on: [T; 2],
}

impl<T: Float> AlphaSolver<T> {
    /// For α_`first` and those after it, from 1, and these constraints.
    pub(crate) fn new(
        stages: &Stages<T>,
        structure: &Structure,
        (first, constraints): (usize, &[Constraint<T>]),
    ) -> Self {
        let (method, iterate) = (&stages.method, &stages.iterate);
        let of = (first, constraints.len());
        AlphaSolver {
            direction: Direction::new(method, iterate, &structure.hessian, of),
            local_error: LocalError::new(method, iterate),
            kept: Kept::new(iterate),
            unperturbed: State::new(&vec![T::int(0); iterate.components()], &[]),
            handed_on: [T::int(0); 2],
        }
    }
}

impl<T: Float> Core<T> {
    /// `constraints` holds what the α_k are to be solved for.
    pub fn new(
        system: &Hamiltonian,
        mut energy: Evaluator<T>,
        options: StepOptions<T>,
        method: Coefficients<T>,
        constraints: Vec<Constraint<T>>,
    ) -> Self {
        let n = 2 * system.degrees_of_freedom();
        let structure = system.structure();
        let mut start_alphas = vec![T::int(0); method.alphas()];
        if let (Some(alpha), Some(last)) = (options.fixed_alpha, start_alphas.last_mut()) {
            *last = alpha;
        }
        let kinetic = energy.kinetic();
        let preconditioner = options.preconditioner;
        let free = options.first_alpha.filter(|_| !constraints.is_empty());
        let stages = Stages::new(method, structure, kinetic, &start_alphas, preconditioner);
        let alpha_solver = free.map(|first| {
            let of = (first, constraints.as_slice());
            Box::new(AlphaSolver::new(&stages, structure, of))
        });
        let zero = State::new(&vec![T::int(0); n], &[]);
        Core {
            parts: Parts::new(),
            is_deferred: false,
            noise_expected: 0.0,
            unconstrained: if options.first_alpha.is_some() {
                Outcome::Quadratic
            } else {
                Outcome::NotAsked
            },
            may_be_halved: false,
            middles: vec![zero; options.max_halvings as usize],
            start: vec![T::NAN; n],
            start_energy: T::int(0),
            gradient: vec![T::int(0); n],
            failed: (vec![T::int(0); n], T::int(0), T::int(0)),
            alphas: start_alphas.clone(),
            start_alphas,
            counts: Counts::default(),
            energy,
            options,
            constraints,
            stages,
            alpha_solver,
        }
    }

    /// The energy, if α_k are solved for it.
    pub(crate) fn energy_constraint(&self) -> Option<&Constraint<T>> {
        self.constraints.first().filter(|c| c.is_energy())
    }

    /// Forgets how the last step was made, which the next is not to be guessed from.
    pub(crate) fn forget_step(&mut self) {
        self.noise_expected = 0.0;
        if let Some(solver) = &mut self.alpha_solver {
            solver.handed_on = [T::int(0); 2];
        }
        self.stages.forget();
        self.start.fill(T::NAN);
    }

    /// Forgets all steps, so that the next depends on the state alone.
    pub fn forget(&mut self) {
        self.forget_step();
        self.constraints.iter_mut().for_each(|c| c.late = T::int(0));
    }
}
