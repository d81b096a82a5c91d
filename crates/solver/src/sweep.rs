//! One sweep of the stage equations, all stages at once: Z ← K(α) L(Z).
//!
//! Component c of stage i stands at `c·stride + i`, so that the stages lie side by side in SIMD registers; the places from s to
//! `stride` are padding. Three forms, [`crate::whole`], [`crate::half`] and [`crate::draft`]:
//!
//! | H | unknowns | one sweep |
//! |---|---|---|
//! | any | Z of all 2m components | ∇H at the stages; Z ← K L |
//! | T(p) + U(q), T = ½ Σ w_c p_c² + b·p | Z of the m positions | ∇U at the stages; P ← p + K L_p; L_q = h b ∇T(P); Z_q ← K L_q |
//! | the same, while Z is far from the last | Z of the m positions | ∇U at the stages; Z_q ← Z_q + h M⁻¹ K B K ΔL_p |
//!
//! The second takes half the sweeps and only the derivative of U: with M⁻¹ known, ∇T needs no differentiation. Nothing is multiplied out:
//! K enters as K, with K_ij + K_ji = 1 to the last bit, so quadratic invariants are kept to rounding.
//!
//! How they are gone through: for any system in [`crate::mix`]; for short states whose H is compiled, as one kernel with it, in
//! [`crate::small`]; the product by pairs of stages in [`crate::pairs`]. How a step begins: `begin`. What moves with the α's: `moved`. In Newton's order: `stage_by_stage`. On stiff springs gradients are foreseen
//! ([`crate::springs`]): `sprung`.
//!
//! Cost of a sweep: s gradients (of H, or of U) and 2m s² products. Nothing is allocated. Kepler, with AVX-512: 200 cycles
//! with s = 16, a draft 155.

mod begin;
mod moved;
mod sprung;
mod stage_by_stage;

use crate::ahead::{Again, InDoubles, Once};
use crate::aligned::{Aligned, Places};
use crate::columns::{Columns, length_of};
use crate::constraint::MANY;
use crate::contraction::FAR;
use crate::draft::Draft;
use crate::half::Half;
use crate::mix::Step;
use crate::pairs::{HALF, has_pairs};
use crate::ready::ready;
use crate::row::{by_lanes, groups_of, placed, stride_for};
use crate::small::{OneGroup, TwoGroups};
use crate::springs::Springs;
use crate::state::State;
use crate::twice::Twice;
use crate::whole::Whole;
use equip_autodiff::{Evaluate, Kinetic};
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Gauss;
use std::marker::PhantomData;

/// The forms of a sweep.
enum Form<'a, T> {
    Whole(Whole<'a, T>),
    Half(Half<'a, T>),
    Draft(Draft<'a, T>),
}

/// What the next sweep of an iterate does, with all it reads and writes.
macro_rules! form {
    ($iterate:ident, $y:expr, $inverse_scale:expr) => {{
        let twice = ($iterate.twice.as_ref()).filter(|_| $iterate.is_draft);
        let twice = twice.and_then(|twice| twice.get($iterate.k_has_moved, $iterate.h));
        let step = $crate::mix::Step {
            k: twice.map_or(&*$iterate.k, |(twice, _)| twice),
            hb: &$iterate.hb,
            hi: &$y.hi,
            lo: &$y.lo,
            inverse_scale: $inverse_scale,
            gradients: &mut $iterate.gradients,
            l: &mut $iterate.l,
            folded: &mut $iterate.folded,
            z: &mut $iterate.z,
            points: &mut $iterate.points,
            s: $iterate.s,
        };
        let draft = twice.map(|(_, h)| h);
        $crate::sweep::Form::new(step, $iterate.kinetic.as_ref(), $iterate.has_momenta, draft)
    }};
}
use form;

impl<'a, T: Float> Form<'a, T> {
    #[inline(always)]
    fn new(
        step: Step<'a, T>,
        kinetic: Option<&'a Kinetic<T>>,
        keeps_momenta: bool,
        draft: Option<T>,
    ) -> Self {
        let Some(kinetic) = kinetic else {
            return Form::Whole(Whole(step));
        };
        let half = Half {
            step,
            inverse_masses: kinetic.diagonal().unwrap_or_default(),
            offset: kinetic.offset(),
            keeps_momenta,
        };
        match draft {
            None => Form::Half(half),
            Some(h) => Form::Draft(Draft { half, h }),
        }
    }
}

/// The iterate Z with its L, and what a sweep needs of the method.
#[derive(Debug)]
pub(crate) struct Iterate<T: Float> {
    pub(crate) s: usize,
    pub(crate) stride: usize,
    pub(crate) n: usize,
    /// T(p), if it is quadratic with a diagonal M⁻¹.
    pub(crate) kinetic: Option<Kinetic<T>>,
    pub(crate) set: InstructionSet,
    /// How K is made.
    columns: Columns<T>,
    /// K(α) and K of the α's a step starts from, column by column.
    pub(crate) k: Aligned<T>,
    k_start: Aligned<T>,
    /// K is not the one a step starts from.
    k_has_moved: bool,
    /// h b_i.
    pub(crate) hb: Aligned<T>,
    pub(crate) h: T,
    /// L of the last sweep.
    pub(crate) l: Aligned<T>,
    /// L of the step before.
    l_before: Aligned<T>,
    /// Room for what products read, if it is not L.
    folded: Aligned<T>,
    /// K L of the last sweep.
    pub(crate) z: Aligned<T>,
    /// Z before the α's moved.
    z_before: Aligned<T>,
    /// The stages, of momenta that are no unknowns if they are kept.
    pub(crate) points: Aligned<T>,
    pub(crate) has_momenta: bool,
    pub(crate) gradients: Aligned<T>,
    /// Size of each component over the step, and its inverse.
    pub(crate) scale: Vec<T>,
    inverse_scale: Vec<T>,
    /// K B K, if the α's a step starts from are zero; where many components are worth it of those that have moved too.
    twice: Option<Twice<T>>,
    /// Z is what K(α) makes of L_p, as drafts take it to be.
    is_of_l: bool,
    /// Components whose gradients are foreseen.
    pub(crate) springs: Option<Springs<T>>,
    /// The last sweep was a draft: L is not there.
    pub(crate) is_draft: bool,
    /// No sweep of this step has been made.
    is_first: bool,
    /// This step began from foretold gradients: all components have been measured.
    is_prolonged: bool,
    /// Components were measured on stages that were far off.
    pub(crate) was_far: bool,
    /// The next change of Z is relative to other sizes than the last.
    pub(crate) was_remeasured: bool,
}

impl<T: Float> Iterate<T> {
    /// `alphas` are those a step starts from.
    pub(crate) fn new(
        gauss: &Gauss<T>,
        n: usize,
        kinetic: Option<Kinetic<T>>,
        alphas: &[T],
    ) -> Self {
        let mut places = Places::default();
        let mut iterate = Self::start(gauss, (n, kinetic), Some(alphas), &mut places);
        if iterate.kinetic.is_some() && alphas.iter().all(|&alpha| alpha == T::int(0)) {
            let (set, k) = (iterate.set, &*iterate.k_start);
            let room = (n >= MANY, &mut places);
            iterate.twice = Some(Twice::new(set, gauss, k, room));
        }
        iterate
    }

    /// For α = 0 alone, without drafts.
    pub(crate) fn unperturbed(gauss: &Gauss<T>, n: usize, kinetic: Option<Kinetic<T>>) -> Self {
        Self::start(gauss, (n, kinetic), None, &mut Places::default())
    }

    fn start(
        gauss: &Gauss<T>,
        (n, kinetic): (usize, Option<Kinetic<T>>),
        alphas: Option<&[T]>,
        places: &mut Places,
    ) -> Self {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let set = InstructionSet::best();
        // One column for each place of L, also the padding: all zero there.
        let mut k = places.zeros(length_of::<T>(s));
        let mut k_start = places.zeros(length_of::<T>(s));
        let columns = Columns::new(gauss, alphas.is_some());
        columns.fill(set, alphas.unwrap_or_default(), &mut k_start);
        k.copy_from_slice(&k_start);
        let kinetic = kinetic.filter(|kinetic| kinetic.diagonal().is_some());
        let hb = places.zeros(stride);
        let mut rows = || places.zeros(n * stride);
        Iterate {
            s,
            stride,
            n,
            kinetic,
            set,
            columns,
            k,
            k_start,
            k_has_moved: false,
            hb,
            h: T::int(0),
            l: rows(),
            l_before: rows(),
            folded: rows(),
            z: rows(),
            z_before: rows(),
            points: rows(),
            has_momenta: false,
            gradients: rows(),
            scale: vec![T::int(0); n],
            inverse_scale: vec![T::int(0); n],
            twice: None,
            is_of_l: true,
            springs: None,
            is_draft: false,
            is_first: true,
            is_prolonged: false,
            was_far: false,
            was_remeasured: false,
        }
    }

    /// Components that are unknown: all, or the positions.
    pub(crate) fn unknowns(&self) -> usize {
        match self.kinetic {
            Some(_) => self.n / 2,
            None => self.n,
        }
    }

    /// Stages from Z.
    fn place(&mut self, y: &State<T>) {
        let unknowns = self.unknowns();
        self.set.run(&mut Place {
            hi: &y.hi[..unknowns],
            lo: &y.lo[..unknowns],
            z: &self.z,
            points: &mut self.points,
            s: self.s,
        });
    }

    /// One sweep from the step's start `y`; of drafts others as long as `again` says so of the change that each has made. Returns the last change,
    /// the largest of Z relative to the sizes of the components; not finite if anything is not. What was not known
    /// before, or on stages far off only, is measured. With `draft` by [`crate::draft`], if that can be.
    pub(crate) fn sweep<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        y: &State<T>,
        draft: bool,
        again: &mut impl Again<T>,
    ) -> T {
        let unknown = std::mem::take(&mut self.is_first) && !self.is_prolonged;
        // What was measured on stages that were far off is measured again: after the drafts, on springs at once.
        let springs = self.has_springs();
        let moved = self.k_has_moved;
        let twice = self.twice.as_ref().and_then(|t| t.get(moved, self.h));
        let follows = !moved || (self.is_of_l && !springs);
        let can_draft = twice.is_some() && follows && !unknown;
        self.is_draft = draft && can_draft && !(springs && self.was_far);
        let measures = unknown || (self.was_far && !self.is_draft);
        self.has_momenta = measures;
        let drafts = self.is_draft;
        self.is_of_l = true;
        let ready = ready::<T>();
        let fused = if T::IS_DOUBLE {
            match self.stride {
                _ if springs => None,
                4 => self.fuse::<4, E>(energy, y, again),
                8 => self.fuse::<8, E>(energy, y, again),
                16 if has_pairs::<T>(self.s) => self.fuse::<HALF, E>(energy, y, again),
                _ => None,
            }
        } else {
            None
        };
        let change = fused.unwrap_or_else(|| {
            loop {
                self.evaluate(energy);
                (ready.foresee)(self, y, unknown);
                let change = (ready.mix)(self, y);
                let leaps = springs && change > T::exact(1.0 / FAR);
                if !drafts || leaps || !again.again(change) {
                    return change;
                }
            }
        });
        if measures {
            (ready.measure)(self, y, 0..self.n);
            self.was_far = false;
        }
        self.was_remeasured = measures && (unknown || springs || self.twice.is_none());
        change
    }

    /// The whole sweep as one kernel, if there is one for this energy in this float type.
    #[inline(always)]
    fn fuse<const N: usize, E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        y: &State<T>,
        again: &mut impl Again<T>,
    ) -> Option<T> {
        let two_groups = has_pairs::<T>(self.s);
        macro_rules! fused {
            ($method:ident, $task:expr, $again:expr) => {{
                let task = $task.in_doubles()?;
                if two_groups {
                    energy.$method::<HALF, _>(&mut TwoGroups(task, $again))?
                } else {
                    energy.$method::<N, _>(&mut OneGroup(task, $again))?
                }
            }};
        }
        let change = match form!(self, y, &self.inverse_scale) {
            Form::Whole(task) => fused!(fuse_gradients, task, Once),
            Form::Half(task) => fused!(fuse_forces, task, Once),
            Form::Draft(task) => fused!(fuse_forces, task, InDoubles(again, PhantomData)),
        };
        Some(T::exact(change))
    }

    /// ∇H, or ∇U, at the stages.
    fn evaluate<E: Evaluate<T>>(&mut self, energy: &mut E) {
        let (s, stride) = (self.s, self.stride);
        let len = self.unknowns() * stride;
        let (points, gradients) = (&self.points[..len], &mut self.gradients[..len]);
        if self.kinetic.is_some() {
            energy.forces_by_component(points, gradients, stride, s);
        } else {
            energy.gradients_by_component(points, gradients, stride, s);
        }
    }

    /// L from the gradients, Z ← K L, and the stages; P and L_q on the way, where momenta are not unknowns.
    pub(crate) fn mix(&mut self, y: &State<T>) -> T {
        let set = self.set;
        match form!(self, y, &self.inverse_scale) {
            Form::Whole(mut task) => set.run(&mut task),
            Form::Half(mut task) => set.run(&mut task),
            Form::Draft(mut task) => set.run(&mut task),
        }
    }

    /// y1 = y0 + Σ L_i.
    pub(crate) fn end_point(&self, y: &State<T>, next: &mut State<T>) {
        y.advance_by_component(self.set, &self.l, self.s, next);
    }
}

/// The stages y0 + Z.
struct Place<'a, T> {
    hi: &'a [T],
    lo: &'a [T],
    z: &'a [T],
    points: &'a mut [T],
    s: usize,
}

impl<T: Float> Kernel for Place<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.s, self)
    }
}

impl<T: Float> Place<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let groups = groups_of::<T, N>(self.s);
        let points = self.points.as_chunks_mut::<N>().0.chunks_exact_mut(groups);
        let z = self.z.as_chunks::<N>().0.chunks_exact(groups);
        let starts = self.hi.iter().zip(self.lo);
        for ((points, z), (&hi, &lo)) in points.zip(z).zip(starts) {
            for (point, z) in points.iter_mut().zip(z) {
                *point = placed(hi, lo, z);
            }
        }
    }
}
