//! The choice of the preconditioner: the least expensive one that contracts.
//!
//! A step begins with the preconditioner of the last step. If its iteration does not contract, the
//! preconditioner is recomputed at the present state, then the next more expensive one is tried: 1 → stiff
//! modes → one ∇²H → ∇²H at all stages. A less expensive one that has failed is tried again after 1, 2, 4, …
//! steps.

use crate::memory::SolverMemory;
use crate::options::step_options::Preconditioner as Wanted;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Counts;
use crate::policy::{LONGEST_WAIT, MOST_DENSE};
use crate::precondition::diagonal::Diagonal;
use crate::precondition::frozen::Frozen;
use crate::precondition::full::Full;
use equip_autodiff::{Evaluator, Structure};
use equip_iterate::{Iterate, Preconditioner, State};
use equip_scalar::Float;
use equip_tableau::Coefficients;
use std::slice::from_mut;

/// The preconditioners, from the least expensive one on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Identity,
    Diagonal,
    Frozen,
    Full,
}

const KINDS: [Kind; 4] = [Kind::Identity, Kind::Diagonal, Kind::Frozen, Kind::Full];

/// The preconditioner of the first step.
fn first(wanted: Wanted) -> Kind {
    match wanted {
        Wanted::Automatic | Wanted::Identity => Kind::Identity,
        Wanted::Diagonal => Kind::Diagonal,
        Wanted::Frozen => Kind::Frozen,
        Wanted::Full => Kind::Full,
    }
}

/// The preconditioners of a method, and the active one.
#[derive(Debug)]
pub(crate) struct Choice<T: Float> {
    wanted: Wanted,
    active: Kind,
    /// Steps before a less expensive one is tried again, and the number of steps after the next failure.
    left: u64,
    wait: u64,
    /// The step size for which the active one was computed; zero if it was not.
    made_for: T,
    /// Whether the active one was computed in the present step.
    is_fresh: bool,
    /// The factor by which it amplifies rounding compared with M = 1; not finite if not measured.
    amplification: f64,
    diagonal: Option<Diagonal>,
    frozen: Option<Frozen>,
    full: Option<Full>,
    can_be_dense: bool,
    /// The state at which ∇²H is evaluated, and its entries; no entries before the first evaluation.
    state: Vec<T>,
    hessian: Vec<T>,
    structure: Structure,
}

impl<T: Float> Choice<T> {
    pub(crate) fn new(
        wanted: Wanted,
        (method, iterate): (&Coefficients<T>, &Iterate<T>),
        structure: &Structure,
    ) -> Self {
        Choice {
            wanted,
            active: first(wanted),
            left: 0,
            wait: 1,
            made_for: T::int(0),
            is_fresh: false,
            amplification: f64::INFINITY,
            // Preconditioners that may never be needed are allocated on first use.
            diagonal: (wanted == Wanted::Diagonal).then(|| Diagonal::new(method, iterate)),
            frozen: (wanted == Wanted::Frozen)
                .then(|| Frozen::new(method, iterate, structure))
                .flatten(),
            full: (wanted == Wanted::Full)
                .then(|| Full::new(method, iterate, structure.hessian.to_pattern())),
            can_be_dense: iterate.stages() * iterate.unknowns() <= MOST_DENSE,
            state: vec![T::int(0); iterate.components()],
            hessian: match wanted {
                Wanted::Automatic | Wanted::Identity => Vec::new(),
                _ => vec![T::int(0); structure.hessian.len()],
            },
            structure: structure.clone(),
        }
    }

    /// Begins a step, perhaps with a less expensive preconditioner than the last.
    pub(crate) fn begin_step(&mut self) {
        self.is_fresh = false;
        if self.follows_stages() {
            self.made_for = T::int(0);
        }
        if self.wanted == Wanted::Diagonal {
            // The last step may have found no stiff modes and used M = 1.
            self.active = Kind::Diagonal;
        }
        if self.wanted == Wanted::Automatic && self.active != Kind::Identity {
            if self.left == 0 {
                (self.active, self.made_for) = (Kind::Identity, T::int(0));
            } else {
                self.left -= 1;
            }
        }
    }

    /// Ends an accepted step.
    pub(crate) fn end_step(&mut self) {
        if self.active == Kind::Identity {
            self.wait = 1;
        }
    }

    /// Whether M = 1.
    pub(crate) fn is_identity(&self) -> bool {
        self.active == Kind::Identity
    }

    /// Whether M exists for steps of size `h`; for M at all stages, whether it was computed in this step.
    pub(crate) fn is_made_for(&self, h: T) -> bool {
        self.is_identity() || self.made_for == h
    }

    /// Computes M for a step of size `h` from `y`, at the present stages, unless it exists. Returns whether M
    /// exists.
    pub(crate) fn make(
        &mut self,
        (method, iterate): (&Coefficients<T>, &Iterate<T>),
        energy: &mut Evaluator<T>,
        (y, h): (&State<T>, T),
        counts: &mut Counts,
    ) -> bool {
        let is_made = self.made_for == h;
        match self.active {
            Kind::Identity => true,
            Kind::Full => {
                self.amplification = f64::INFINITY;
                self.hessian.resize(self.structure.hessian.len(), T::int(0));
                counts.add_hessians(iterate.stages(), energy);
                counts.factorisations += 1;
                let pattern = &self.structure.hessian;
                let full = self
                    .full
                    .get_or_insert_with(|| Full::new(method, iterate, pattern.to_pattern()));
                let room = (&mut self.state[..], &mut self.hessian[..]);
                (self.is_fresh, self.made_for) = (true, h);
                full.linearise(iterate, energy, (y, h), room).is_ok()
            }
            _ if is_made => true,
            kind => {
                counts.add_hessians(1, energy);
                self.hessian.resize(self.structure.hessian.len(), T::int(0));
                self.mean(method, iterate, y);
                energy.hessian(&self.state, &mut self.hessian);
                let is_made = if kind == Kind::Diagonal {
                    self.make_diagonal(method, iterate, h)
                } else {
                    self.make_frozen((method, iterate), h, counts)
                };
                self.made_for = if is_made { h } else { T::int(0) };
                self.amplification = f64::INFINITY;
                self.is_fresh = true;
                if !is_made && self.wanted == Wanted::Diagonal {
                    self.active = Kind::Identity;
                    return true;
                }
                is_made
            }
        }
    }

    /// Why M could not be computed.
    pub(crate) fn failure<U>(&self) -> Failure<U> {
        let is_finite = match (self.active, &self.full) {
            (Kind::Full, Some(full)) => full.is_finite(),
            _ => self.hessian.iter().all(|x| x.is_finite()),
        };
        if is_finite {
            Failure::Singular
        } else {
            Failure::NotFinite
        }
    }

    fn make_diagonal(&mut self, method: &Coefficients<T>, iterate: &Iterate<T>, h: T) -> bool {
        let Some(w) = iterate.inverse_masses() else {
            return false;
        };
        let diagonal = self
            .diagonal
            .get_or_insert_with(|| Diagonal::new(method, iterate));
        diagonal.find((&self.structure.hessian, &self.hessian), w, h)
    }

    fn make_frozen(
        &mut self,
        (method, iterate): (&Coefficients<T>, &Iterate<T>),
        h: T,
        counts: &mut Counts,
    ) -> bool {
        if self.frozen.is_none() {
            self.frozen = Frozen::new(method, iterate, &self.structure);
        }
        let Some(frozen) = &mut self.frozen else {
            return false;
        };
        let factored = frozen.factor(&self.hessian, h, iterate.scale());
        counts.simplified_factorisations += factored.unwrap_or(0);
        factored.is_ok()
    }

    /// The mean Σ_i b_i Y_i. Momenta that are not unknowns do not enter ∇²U; those of the start are used.
    fn mean(&mut self, method: &Coefficients<T>, iterate: &Iterate<T>, y: &State<T>) {
        let unknown = iterate.unknowns();
        let rows = iterate.points().chunks_exact(iterate.stride());
        for (c, (mean, row)) in self.state.iter_mut().zip(rows).enumerate() {
            let terms = row.iter().zip(method.weights());
            *mean = if c < unknown {
                terms.fold(T::int(0), |sum, (&x, &b)| sum + b * x)
            } else {
                y.hi[c]
            };
        }
    }

    /// M, unless M = 1.
    pub(crate) fn operator(&mut self) -> Option<&mut (dyn Preconditioner<T> + '_)> {
        match self.active {
            Kind::Identity => None,
            Kind::Diagonal => self
                .diagonal
                .as_mut()
                .map(|m| m as &mut dyn Preconditioner<T>),
            Kind::Frozen => self
                .frozen
                .as_mut()
                .map(|m| m as &mut dyn Preconditioner<T>),
            Kind::Full => self.full.as_mut().map(|m| m as &mut dyn Preconditioner<T>),
        }
    }

    /// The factor by which M⁻¹ amplifies rounding compared with M = 1. It is not measured for M at all
    /// stages.
    pub(crate) fn amplification(&mut self, iterate: &mut Iterate<T>) -> f64 {
        if self.active == Kind::Identity {
            return 1.0;
        }
        if self.amplification.is_finite() {
            return self.amplification;
        }
        if let Some(m) = self.operator() {
            self.amplification = iterate.amplification(m);
        }
        self.amplification
    }

    /// Whether M must be recomputed in every iteration.
    pub(crate) fn follows_stages(&self) -> bool {
        self.active == Kind::Full
    }

    /// Called if the iteration does not contract. Returns whether the step can be restarted with another M.
    pub(crate) fn escalate(&mut self) -> bool {
        if matches!(self.active, Kind::Diagonal | Kind::Frozen) && !self.is_fresh {
            self.made_for = T::int(0);
            return true;
        }
        if self.wanted != Wanted::Automatic {
            return false;
        }
        let Some(&next) = KINDS
            .iter()
            .find(|&&kind| kind > self.active && self.is_possible(kind))
        else {
            return false;
        };
        if self.active == Kind::Identity {
            self.left = self.wait;
            self.wait = (2 * self.wait).min(LONGEST_WAIT);
        }
        (self.active, self.made_for, self.is_fresh) = (next, T::int(0), false);
        true
    }

    fn is_possible(&self, kind: Kind) -> bool {
        match kind {
            Kind::Full => self.can_be_dense,
            _ => true,
        }
    }

    /// Forgets earlier steps.
    pub(crate) fn forget(&mut self) {
        self.made_for = T::int(0);
        (self.left, self.wait) = (0, 1);
        self.active = first(self.wanted);
    }

    /// Writes everything on which the next step depends, or restores it.
    pub(crate) fn remember(
        &mut self,
        (method, iterate): (&Coefficients<T>, &Iterate<T>),
        memory: &mut dyn SolverMemory<T>,
    ) {
        let what = "preconditioner";
        let mut counts = [self.active as u64, self.left, self.wait].map(|x| T::exact(x as f64));
        memory.numbers(what, &mut counts);
        let counts = counts.map(|x| x.to_f64());
        let are_whole = counts.iter().all(|x| *x >= 0.0 && x.fract() == 0.0);
        let [active, left, wait] = counts.map(|x| x as u64);
        memory.check_that(are_whole && active < KINDS.len() as u64, what);
        self.active = KINDS.get(active as usize).copied().unwrap_or(self.active);
        (self.left, self.wait) = (left.min(LONGEST_WAIT), wait.clamp(1, LONGEST_WAIT));
        memory.numbers("preconditioner made for", from_mut(&mut self.made_for));
        memory.double("preconditioner amplification", &mut self.amplification);
        let what = "preconditioner made of";
        let made_of: Vec<f64> = match (self.active, &self.diagonal, &self.frozen) {
            (Kind::Diagonal, Some(diagonal), _) => diagonal.memory().collect(),
            (Kind::Frozen, _, Some(frozen)) => frozen.memory().collect(),
            _ => Vec::new(),
        };
        let mut made_of: Vec<T> = made_of.into_iter().map(T::exact).collect();
        memory.list(what, &mut made_of);
        if memory.is_read() && self.made_for != T::int(0) && !made_of.is_empty() {
            let made_of: Vec<f64> = made_of.iter().map(|x| x.to_f64()).collect();
            let is_made = self.make_again((method, iterate), &made_of);
            memory.check_that(is_made, what);
        }
    }

    /// Makes M of its memory. Returns whether that is possible.
    fn make_again(
        &mut self,
        (method, iterate): (&Coefficients<T>, &Iterate<T>),
        made_of: &[f64],
    ) -> bool {
        match self.active {
            Kind::Diagonal if made_of.len().is_multiple_of(2) => {
                let diagonal = self
                    .diagonal
                    .get_or_insert_with(|| Diagonal::new(method, iterate));
                diagonal.restore(made_of);
                true
            }
            Kind::Frozen
                if made_of.len() == self.structure.hessian.len() + iterate.components() =>
            {
                if self.frozen.is_none() {
                    self.frozen = Frozen::new(method, iterate, &self.structure);
                }
                let frozen = self.frozen.as_mut();
                frozen.is_some_and(|frozen| frozen.restore(made_of).is_ok())
            }
            _ => false,
        }
    }
}
