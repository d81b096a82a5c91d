//! The data of the steps of a run.

use crate::alpha::direction::Direction;
use crate::alpha::local_error::LocalError;
use crate::constraint::Constraint;
use crate::options::step_options::StepOptions;
use crate::outcome::failure::FailedPart;
use crate::outcome::outcome::{Counts, Outcome};
use crate::outcome::parts::Parts;
use crate::step::stages::Stages;
use equip_autodiff::{Evaluator, Hamiltonian};
use equip_iterate::{Kept, State};
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// The data of the steps of a run. Steps do not allocate.
#[derive(Debug)]
pub struct Core<T: Float> {
    pub(crate) energy: Evaluator<T>,
    pub(crate) options: StepOptions<T>,
    pub(crate) counts: Counts,
    /// The constraints for which the α_k are solved: the energy first, unless H is at most quadratic, then
    /// further invariants. May be empty.
    pub(crate) constraints: Vec<Constraint<T>>,
    /// The stages Z and their iteration.
    pub(crate) stages: Stages<T>,
    /// The α_k of the step, and their initial values: zero, or the fixed ones.
    pub(crate) alphas: Vec<T>,
    pub(crate) start_alphas: Vec<T>,
    /// The solver for the α_k, if any are free.
    pub(crate) alpha_solver: Option<Box<AlphaSolver<T>>>,
    /// The state at which ∇I of the constraints is known, or H if the method does not solve for H.
    pub(crate) start: Vec<T>,
    pub(crate) start_energy: T,
    /// Workspace for ∇H.
    pub(crate) gradient: Vec<T>,
    /// Whether the α_k are computed only when the step is [completed](Self::complete).
    pub(crate) is_deferred: bool,
    /// The noise of y1 that was negligible in the constraints of the last step. The iteration with α = 0 may
    /// stop at this noise if α is solved for afterwards.
    pub(crate) noise_expected: f64,
    /// The outcome of a step without constraints.
    pub(crate) unconstrained: Outcome,
    /// Whether the present attempt may be halved.
    pub(crate) may_be_halved: bool,
    /// The midpoints of halved steps, one for each level.
    pub(crate) middles: Vec<State<T>>,
    /// The parts of a step, for dense output.
    pub(crate) parts: Parts<T>,
    /// The part that failed last.
    pub(crate) failed: FailedPart<T>,
}

/// The solver for the α_k.
#[derive(Debug)]
pub(crate) struct AlphaSolver<T: Float> {
    /// The search direction.
    pub(crate) direction: Direction<T>,
    /// `None` if no method has two more stages.
    pub(crate) local_error: Option<LocalError<T>>,
    /// The stages and the end point with the initial α_k.
    pub(crate) kept: Kept<T>,
    pub(crate) unperturbed: State<T>,
    /// The bound on the change of y1 handed on by earlier steps.
    pub(crate) handed_on: [T; 2],
    /// The same at the start of the last step.
    pub(crate) handed_on_before: [T; 2],
}

impl<T: Float> AlphaSolver<T> {
    /// For the parameters from α_`first` on, counted from 1, and these constraints.
    pub(crate) fn new(
        stages: &Stages<T>,
        system: &Hamiltonian,
        (first, constraints): (usize, &[Constraint<T>]),
    ) -> Self {
        let (method, iterate) = (&stages.method, &stages.iterate);
        let of = (first, constraints.len());
        let pattern = &system.structure().hessian;
        AlphaSolver {
            direction: Direction::new(method, iterate, pattern, of, system.has_time()),
            local_error: LocalError::new(method, iterate),
            kept: Kept::new(iterate),
            unperturbed: State::new(&vec![T::int(0); iterate.components()], &[]),
            handed_on: [T::int(0); 2],
            handed_on_before: [T::int(0); 2],
        }
    }
}

impl<T: Float> Core<T> {
    /// `constraints` are those for which the α_k are solved.
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
        let mut stages = Stages::new(method, structure, kinetic, &start_alphas, preconditioner);
        if structure.is_quadratic() && energy.is_canonical() {
            (stages.iterate).assume_linear(&stages.method, &start_alphas);
        }
        let alpha_solver = free.map(|first| {
            let of = (first, constraints.as_slice());
            Box::new(AlphaSolver::new(&stages, system, of))
        });
        let zero = State::new(&vec![T::int(0); n], &[]);
        Core {
            parts: Parts::new(),
            is_deferred: false,
            noise_expected: 0.0,
            unconstrained: if options.first_alpha.is_some() {
                Outcome::Quadratic
            } else {
                Outcome::NotRequested
            },
            may_be_halved: false,
            middles: vec![zero; options.max_halvings as usize],
            start: vec![T::NAN; n],
            start_energy: T::int(0),
            gradient: vec![T::int(0); n],
            failed: FailedPart {
                start: vec![T::int(0); n],
                time: T::int(0),
                step: T::int(0),
                max_halvings: options.max_halvings,
            },
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

    /// The energy constraint, if there is one.
    pub(crate) fn energy_constraint(&self) -> Option<&Constraint<T>> {
        self.constraints.first().filter(|c| c.is_energy())
    }

    /// Forgets the last step, so that it gives no initial guess.
    pub(crate) fn forget_step(&mut self) {
        self.noise_expected = 0.0;
        if let Some(solver) = &mut self.alpha_solver {
            solver.handed_on = [T::int(0); 2];
        }
        self.stages.forget();
        self.start.fill(T::NAN);
    }

    /// Forgets all steps, so that the next step depends on the state alone.
    pub fn forget(&mut self) {
        self.forget_step();
        self.constraints.iter_mut().for_each(|c| c.late = T::int(0));
    }
}
