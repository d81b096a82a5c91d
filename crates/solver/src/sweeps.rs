//! System (7) by sweeps Z ← K(α) L(Z), α's moved while the sweeps contract: no factorisation.
//!
//! As soon as what the sweeps have left ([`crate::contraction`]) is well below what the energy residual g of the last step was, g is evaluated and
//! the α's move by t = −g/(dg/dt) along a direction; later moves use the slope observed. Sweeps go on until Z and g are at round-off.
//! Until then, and while g is not looked at, they are drafts ([`crate::draft`]). Two rules for the direction:
//!
//! * *Response* ([`crate::response`]): towards the exact flow, as Newton's. Z follows by the linearised response, so moves cost no sweep.
//!   Slight defects are removed by slopes where that moves the end point little ([`crate::slight`]).
//! * *Slopes* ([`crate::slopes`]): from Legendre coefficients, without any Hessian. The first move is followed by K L formed
//!   anew, further ones by the observed change of Z.
//!
//! *Start.* The polynomial of the last step's stage derivatives, prolonged as far as that is likely ([`crate::start`]); else, or where sweeps from
//! there do not contract, Z = 0.
//! *End.* The stages have settled, and |g| is at its floor, or stalls near it, or with α = 0 or slopes is within 4 floors and not worth more, or
//! within 7 and dear to remove ([`crate::dear`]).
//! *Not for this iteration:* sweeps that do not contract, α's beyond their bound, responses not found, slopes that move the end point too far
//! ([`crate::displaced`]). What comes then is [`crate::step_swept::Then`].
//!
//! Cost: [`crate::sweep`] times the sweeps; a gradient for each evaluation of g, two or three in a step, with slopes H alone for most; that of the direction.

mod memory;

use crate::ahead::{Drafts, SHORT_STAGES};
use crate::constraint::{Constraint, MANY};
use crate::contraction::Contraction;
use crate::dear::Dear;
use crate::displaced::Displaced;
use crate::moves::Moves;
use crate::newton::ENERGY_STAGNATED;
use crate::one_more::OneMore;
use crate::outcome::Counts;
use crate::prolongation::Prolongation;
use crate::ready::ready;
use crate::response::Response;
use crate::slight::Slight;
use crate::slopes::Slopes;
use crate::springs::Springs;
use crate::state::State;
use crate::sweep::Iterate;
use crate::sweep_task::{Rule, SweepTask, Trouble};
use equip_autodiff::{Evaluate, HessianPattern, Kinetic};
use equip_scalar::Float;
use equip_tableau::Gauss;

/// Sweeps allowed in a step, and as many after each time that directions are taken again.
const MAX_SWEEPS: u32 = 80;
/// Stages that no longer come nearer with changes above this many ε are for Newton, if he may be asked: quadratic invariants would leak as much.
const BLOWN_UP: i64 = 16;
/// When the α's have moved along slopes 1 over this of g or less is expected to remain, and g is looked at when it is known that well.
const REMAINS: i64 = 64;
/// Errors above so many times what g is looked at for leave drafts to come; of many components, where a sweep by K costs three times as much, all above it.
const DRAFTED: i64 = 16;
/// Before directions are taken g is to be known this well: they are taken from the stages as they are then.
const CLEAR: i64 = 1024;
/// … and the stages to so many ε: the local error aimed at is the difference of two ends, and as wrong as they are.
const THERE: i64 = 4;

/// Legendre coefficients that are prolonged where the motion on stiff springs is too fast to be foretold by all.
const UNRESOLVED: usize = 2;

#[derive(Debug)]
pub(crate) struct Sweeps<T: Float> {
    pub(crate) iterate: Iterate<T>,
    pub(crate) slopes: Slopes<T>,
    /// Made when the α's are to move by it.
    pub(crate) response: Option<Response<T>>,
    /// α of the step solved last.
    pub(crate) alphas: Vec<T>,
    /// Those that the directions begin from.
    pub(crate) origin: Vec<T>,
    /// Their last move.
    pub(crate) delta: Vec<T>,
    /// Sweeps of that step.
    made: u32,
    pub(crate) contraction: Contraction<T>,
    /// Remembered from step to step: |g| before the α's moved, and what a relative change of the state is worth in g, the same for all
    /// components or for none like for another.
    defect: T,
    scale: T,
    spread: T,
    prolongation: Prolongation<T>,
    dear: Dear<T>,
    /// What removes slight defects where others are left to responses.
    pub(crate) slight: Slight<T>,
    /// What α's by slopes do to the end point, if they are not the only ones there are.
    displaced: Option<Displaced<T>>,
}

impl<T: Float> Sweeps<T> {
    /// With room for what moves α's by this rule, errors told by the `finer` method; alone if there is no other solver.
    pub(crate) fn new(
        (gauss, finer): (&Gauss<T>, Option<&OneMore<T>>),
        n: usize,
        kinetic: Option<Kinetic<T>>,
        start: &[T],
        (rule, pattern, is_alone): (Rule, &HessianPattern, bool),
    ) -> Self {
        let responds = rule == Rule::Response;
        let iterate = Iterate::new(gauss, n, kinetic, start);
        let zero = T::int(0);
        Sweeps {
            slopes: Slopes::new(gauss, &iterate),
            response: responds.then(|| Response::new(gauss, finer, &iterate, pattern)),
            delta: vec![zero; gauss.stages() - 1],
            alphas: vec![zero; gauss.stages() - 1],
            origin: vec![zero; gauss.stages() - 1],
            made: 0,
            contraction: Contraction::new(iterate.kinetic.is_some()),
            defect: zero,
            scale: zero,
            spread: zero,
            dear: Dear::new(),
            prolongation: Prolongation::new(gauss, iterate.unknowns()),
            slight: Slight::new(n, iterate.stride, responds),
            displaced: (rule == Rule::Slopes && !is_alone)
                .then(|| Displaced::new(gauss.stages(), n)),
            iterate,
        }
    }

    /// The steps are made with these springs, or without.
    pub(crate) fn set_springs(&mut self, springs: Option<Springs<T>>) {
        if let Some(response) = &mut self.response {
            response.set_springs(springs.as_ref());
        }
        self.iterate.springs = springs;
    }

    /// Solves for Z, and for the α's if there is a constraint; on success `next` is the end point.
    pub(crate) fn solve<E: Evaluate<T>>(
        &mut self,
        gauss: &Gauss<T>,
        energy: &mut E,
        mut constraint: Option<&mut Constraint<T>>,
        (next, task): (&mut State<T>, &SweepTask<'_, T>),
        counts: &mut Counts,
    ) -> Result<(), Trouble> {
        self.iterate
            .begin_springs(gauss, energy, (task.y, task.h), counts);
        let reborrowed = constraint.as_deref_mut();
        let mut solved = self.try_once(gauss, energy, reborrowed, (&mut *next, task), counts);
        let Some(springs) = &mut self.iterate.springs else {
            return solved;
        };
        if solved == Err(Trouble::Slow) {
            if !springs.has_failed(gauss) {
                return solved;
            }
            solved = self.try_once(gauss, energy, constraint, (next, task), counts);
        }
        if let (Ok(()), Some(springs)) = (solved, &mut self.iterate.springs) {
            let are_at_start = self.alphas == task.alphas;
            springs.has_made(are_at_start.then_some(T::exact(self.contraction.seen)));
        }
        solved
    }

    fn try_once<E: Evaluate<T>>(
        &mut self,
        gauss: &Gauss<T>,
        energy: &mut E,
        mut constraint: Option<&mut Constraint<T>>,
        (next, task): (&mut State<T>, &SweepTask<'_, T>),
        counts: &mut Counts,
    ) -> Result<(), Trouble> {
        let ready = ready::<T>();
        (ready.begin)(self, gauss, task);
        let mut prolonged = task.last.is_some();
        let (zero, one, eps) = (T::int(0), T::int(1), T::EPSILON);
        let mut last_out = T::INFINITY;
        // Where g was at its floor, as it mostly is, it is looked at when the stages are there.
        let mut threshold = self.defect;
        if threshold <= self.scale * eps {
            threshold = zero;
        }
        let removes_all = task.rule == Rule::Slopes && self.displaced.is_none();
        let mut alphas = Moves::new(task.rule);
        let drafted = T::int(if self.iterate.n < MANY { DRAFTED } else { 1 });
        let is_short = self.iterate.s > SHORT_STAGES && !self.is_uneven();
        while self.made < MAX_SWEEPS * (1 + alphas.repeats) {
            let spread = self.spread;
            let looks_early = constraint.is_some() && task.rule == Rule::Slopes;
            let look = looks_early.then_some((spread, drafted * threshold));
            self.iterate.was_far |= std::mem::take(&mut self.contraction.is_far);
            let mut drafts = Drafts::new(&mut self.contraction, is_short, look);
            let draft = drafts.are_next();
            let change = self.iterate.sweep(energy, task.y, draft, &mut drafts);
            let Drafts { seen, made, .. } = drafts;
            counts.sweeps += u64::from(made);
            counts.gradients += u64::from(made) * self.iterate.s as u64;
            self.made += made;
            let (remeasured, alone) = (self.iterate.was_remeasured, alphas.moves == 0);
            if !seen && !self.contraction.see(change.to_f64(), remeasured, alone) {
                // Prolonged too far, perhaps.
                if !alone || !std::mem::take(&mut prolonged) {
                    return Err(Trouble::Slow);
                }
                (ready.begin_from_nothing)(&mut self.iterate, gauss, (task.y, task.h));
                self.contraction.begin_from_nothing();
                if let Some(springs) = &mut self.iterate.springs {
                    springs.was_misled();
                }
                continue;
            }
            if self.iterate.is_draft {
                continue;
            }
            let settled = self.contraction.is_settled();
            let stands_still = self.contraction.stands_still() && task.rule != Rule::Slopes;
            if stands_still && change > self.most_rounding() {
                return Err(Trouble::Slow);
            }
            let Some(constraint) = constraint.as_deref_mut() else {
                if settled {
                    (ready.end_point)(&self.iterate, task.y, next);
                    return Ok(());
                }
                continue;
            };
            let error = T::exact(self.contraction.error());
            let uncertain = match task.rule {
                Rule::Slopes => error * self.spread,
                _ => error * self.scale,
            };
            let early = match task.rule {
                Rule::Slopes => uncertain <= threshold,
                Rule::Response if alphas.moves > 0 => alphas.by_response,
                Rule::Response => self.is_near(error, threshold),
                Rule::Newton => false,
            };
            if !settled && (!early || self.scale == zero) {
                continue;
            }
            (ready.end_point)(&self.iterate, task.y, next);
            let gradient = settled || alphas.moves == 0 || task.rule != Rule::Slopes;
            if !self.look(energy, constraint, (next, gradient), counts) {
                return Err(Trouble::Slow);
            }
            if settled {
                constraint.add_noise(T::exact(self.contraction.noise()));
            }
            let (g, out) = (constraint.defect, constraint.in_floors());
            let floors = constraint.in_judging_floors();
            let at_floor = self.dear.leaves(floors);
            let is_left = at_floor && alphas.moves == 0 && !removes_all;
            if alphas.moves == 0 {
                let is_nothing = is_left && task.rule == Rule::Slopes;
                self.defect = if is_nothing { zero } else { g.abs() };
                constraint.without_alpha = g;
            }
            threshold = match task.rule {
                // It is there, and is looked at when the stages are there too.
                Rule::Slopes if out <= one || is_left => zero,
                _ => g.abs(),
            };
            if settled
                && (out <= one || (out <= T::int(ENERGY_STAGNATED) && out > last_out / T::int(2)))
            {
                if let (Some(displaced), Some(_), 1..) =
                    (&mut self.displaced, task.most_errors, alphas.moves)
                    && displaced.is_too_far(next)
                {
                    // What an earlier step has left is the same in halves.
                    let is_old = constraint.without_alpha_in_floors() <= T::int(ENERGY_STAGNATED);
                    return Err(if is_old {
                        Trouble::NoAlpha
                    } else {
                        Trouble::Slow
                    });
                }
                if task.is_to_return
                    && alphas.moves > 0
                    && self.repeat_directions(energy, constraint, &mut alphas, task, counts)?
                {
                    last_out = T::INFINITY;
                    continue;
                }
                return Ok(());
            }
            if task.rule == Rule::Response && (settled || self.is_near(error, g.abs())) {
                let by_slopes = !alphas.by_response;
                if by_slopes && out > last_out / T::int(2) {
                    return at_floor.then_some(()).ok_or(Trouble::StagesOnly);
                }
                let seen = (g, uncertain + constraint.floor, out);
                if alphas.moves == 0
                    && out > one
                    && let Some(change) =
                        self.remove_slight(energy, seen, (&mut alphas, next), task, counts)
                {
                    self.contraction.jump(change.to_f64());
                    last_out = out;
                    continue;
                }
            }
            if settled && alphas.moves == 0 {
                if is_left {
                    self.dear.has_left(floors);
                    return Ok(());
                }
                if task.rule == Rule::Newton {
                    return Err(Trouble::StagesOnly);
                }
            }
            if settled {
                last_out = out;
            }
            // Where the stages follow the α's a move too early costs nothing, if it is not all noise.
            let stands_out = match task.rule {
                Rule::Response if alphas.moves > 0 => T::int(2) * g.abs() > uncertain,
                Rule::Response => !is_left && self.is_near(error, g.abs()),
                _ => g.abs() > uncertain && !is_left,
            };
            if out > one && (stands_out || settled) {
                if alphas.moves == 0
                    && let (Rule::Response, Some(response)) = (task.rule, &mut self.response)
                {
                    if let Some(known) = task.known {
                        constraint.start_gradient.copy_from_slice(known);
                    }
                    (ready.keep_momenta)(&mut self.iterate, task.y);
                    let step = (task.y, task.h);
                    if !response.take(&self.iterate, energy, step, constraint, counts) {
                        return Err(Trouble::StagesOnly);
                    }
                    let far = response.displacement(g) * constraint.worth / g.abs();
                    // On springs moves of the stiff motion, which are as large, are meant.
                    if !self.iterate.has_springs() && self.dear.is_too_far(floors, far) {
                        if settled {
                            return Ok(());
                        }
                        continue;
                    }
                }
                let noise = uncertain + constraint.floor;
                if !(ready.move_alphas)(self, (g, noise), &mut alphas, task) {
                    if alone && settled && at_floor {
                        // No α is worth this.
                        self.alphas.copy_from_slice(task.alphas);
                        return Ok(());
                    }
                    return Err(Trouble::NoAlpha);
                }
                if let (Some(displaced), Some(errors), true) =
                    (&mut self.displaced, task.most_errors, alone)
                {
                    displaced.begin(&self.slopes, next, (out, errors));
                }
                match task.rule {
                    Rule::Slopes => {
                        threshold = (g.abs() / T::int(REMAINS)).max(constraint.floor);
                        self.contraction.renew();
                    }
                    _ => self.contraction.disturb(),
                }
            }
        }
        Err(Trouble::Slow)
    }

    /// Evaluates g at the end point, with ∇H or alone. What the state is worth is seen in the first look at a step, and whether it is done in the
    /// last; while the α's move along slopes g alone is needed. Returns whether it is finite.
    fn look<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        constraint: &mut Constraint<T>,
        (next, with_gradient): (&State<T>, bool),
        counts: &mut Counts,
    ) -> bool {
        if !with_gradient {
            counts.energies += 1;
            return constraint.glance(energy, next);
        }
        counts.gradients += 1;
        let is_finite = constraint.evaluate(energy, next, &self.iterate.scale);
        (self.scale, self.spread) = (constraint.scale, constraint.spread);
        is_finite
    }

    /// On stiff springs and of many components not all of Z is known alike.
    fn is_uneven(&self) -> bool {
        self.iterate.has_springs() || self.iterate.n >= MANY
    }

    /// Changes of Z that are rounding and no more: that of stiff forces is in the stages, whoever solves for them, and so is that of the forces
    /// between many components where one is small beside its neighbours.
    fn most_rounding(&self) -> T {
        let times = if self.is_uneven() { BLOWN_UP } else { 1 };
        T::int(times * BLOWN_UP) * T::EPSILON
    }

    /// Whether stages with this `error` are near enough to take directions from, for a defect of `g`: g stands out, and the error of
    /// the directions, some 1000 times that of the stages, times what they are to move, up to some 1000 times g, is round-off.
    fn is_near(&self, error: T, g: T) -> bool {
        let eps = T::EPSILON;
        let exact = T::int(1 << 20) * error * g <= eps * self.scale;
        exact && error <= T::int(THERE) * eps && T::int(CLEAR) * error * self.scale <= g
    }

    pub(crate) fn begin(&mut self, gauss: &Gauss<T>, task: &SweepTask<'_, T>) {
        self.alphas.copy_from_slice(task.alphas);
        self.origin.copy_from_slice(task.alphas);
        self.made = 0;
        self.contraction.begin(self.iterate.has_springs());
        let step = (task.y, task.h);
        match task.last {
            Some(last) => {
                let whole = (self.iterate.springs.as_ref()).is_none_or(Springs::foretells);
                let degree = if whole { gauss.stages() } else { UNRESOLVED };
                self.prolongation.set_degree(degree);
                (self.prolongation).make(self.iterate.set, last, task.known.is_some());
                let (foretold, known) = (&self.prolongation, task.known);
                let step = (task.y, task.h, last[1]);
                self.iterate.begin_from_last(gauss, step, foretold, known);
            }
            None => self.iterate.begin(gauss, step),
        }
    }
}
