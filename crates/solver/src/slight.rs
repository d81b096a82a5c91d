//! Slight defects, of 1 to 8 floors, removed by [`crate::slopes`] in steps whose α's are else moved by [`crate::response`].
//!
//! Of such a defect the local error is rounding, and all that is asked is to move the end point little. Slopes cost one move and one or two
//! sweeps, a response as much as some 30. But the bounds w_k, by which they choose, are bounds of what the *energy* does, and the end
//! point may move much further: with v_k and w_k of slopes a defect of one floor takes at least
//!
//! $$ D = \frac{\sum_k |v_k| / w_k}{\sum_k v_k^2 / w_k^2} $$
//!
//! floors of displacement, of which the end point in fact makes r D, relative to the sizes of its components. For Kepler's problem at the
//! pericentre r is 4 and D 1.6, as good as least displacement; for Hénon–Heiles r is 10 to 20, for the outer planets 70 to 400.
//!
//! So r is measured, after one sweep with the α's moved: if the end point is [`FAR`] times as far off as the defect was
//! large, everything is put back, and the step goes on as if nothing had been tried. r is remembered: while r D is above [`FAR`] nothing is
//! tried, and r forgotten by degrees; D is 1 at least, so while r alone is above it D is not asked for. Where sweeps contract badly one of them does not show how far the end point moves, and nothing is
//! tried either.
//!
//! Cost: where nothing is tried at most that of the slopes; else a product K L, one sweep, and those that settle the stages.

use crate::ahead::Once;
use crate::moves::Moves;
use crate::outcome::Counts;
use crate::ready::ready;
use crate::state::State;
use crate::sweep_task::{Rule, SweepTask};
use crate::sweeps::Sweeps;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// Defects of more floors are for responses. With 64 Hénon–Heiles, where the end point moves far for a floor, came back from 250 steps ten times
/// as far off as by responses: whether slopes may is told by earlier steps, and those of the way back are others.
const SLIGHT: i64 = 8;
/// Displacements of the end point, in ε of its sizes, for each floor of the defect. Least displacement makes 3 to 9.
const FAR: i64 = 16;
/// Contraction, as 1 over this, above which one sweep does not show the displacement: at 1/5 it shows a tenth of it.
const CONTRACTS: f64 = 20.0;
/// α's larger than 1 over this are not for slight defects.
const SMALL: i64 = 128;
/// r before it has been measured, and the most that is remembered.
const REACH: i64 = 4;
const MOST_REACH: i64 = 1 << 20;

/// What removes slight defects.
#[derive(Debug)]
pub(crate) struct Slight<T> {
    /// r, remembered from step to step.
    pub(crate) reach: T,
    /// Z, the gradients and L it was made with, the stages and the end point before the move.
    z: Vec<T>,
    gradients: Vec<T>,
    l: Vec<T>,
    points: Vec<T>,
    end: Vec<T>,
}

impl<T: Float> Slight<T> {
    /// With room for what a move changes, if it is `wanted` at all.
    pub(crate) fn new(n: usize, stride: usize, wanted: bool) -> Self {
        let zeros = |len: usize| vec![T::int(0); if wanted { len } else { 0 }];
        Slight {
            reach: T::int(REACH),
            z: zeros(n * stride),
            gradients: zeros(n * stride),
            l: zeros(n * stride),
            points: zeros(n * stride),
            end: zeros(n),
        }
    }

    pub(crate) fn forget(&mut self) {
        self.reach = T::int(REACH);
    }
}

impl<T: Float> Sweeps<T> {
    /// Moves the α's by slopes if the defect g, of so many floors and known up to the noise, is slight, and makes one sweep with them.
    /// Returns the change of Z in it; nothing if the step is as it was before.
    pub(crate) fn remove_slight<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        (g, noise, floors): (T, T, T),
        (alphas, next): (&mut Moves<T>, &mut State<T>),
        task: &SweepTask<'_, T>,
        counts: &mut Counts,
    ) -> Option<T> {
        let contracts = self.contraction.rate <= 1.0 / CONTRACTS;
        if self.response.is_none() || floors > T::int(SLIGHT) || !contracts {
            return None;
        }
        // D is no less than 1: there is no need of slopes to know it.
        if self.slight.reach > T::int(FAR) {
            self.slight.reach *= T::ratio(4, 5);
            return None;
        }
        let ready = ready::<T>();
        let taken = (ready.slopes)(&mut self.slopes, &self.iterate, task.h);
        let needed = (g / self.slopes.slope()).abs();
        if !taken || !(needed <= T::ratio(1, SMALL)) {
            // Forgotten after 7 slight defects.
            self.slight.reach = T::int(4 * FAR);
            return None;
        }
        let bound = self.slopes.displacement();
        if !(bound * self.slight.reach <= T::int(FAR)) {
            self.slight.reach *= T::ratio(4, 5);
            return None;
        }
        self.keep(next);
        alphas.by_response = false;
        let (mut change, mut moved) = (T::INFINITY, T::INFINITY);
        if (ready.move_alphas)(self, (g, noise), alphas, task) {
            change = self.iterate.sweep(energy, task.y, false, &mut Once);
            counts.sweeps += 1;
            counts.gradients += self.iterate.s as u64;
            (ready.end_point)(&self.iterate, task.y, next);
            moved = self.displaced(next) / (T::EPSILON * floors);
        }
        self.slight.reach = (moved / bound).min(T::int(MOST_REACH));
        if change.is_finite() && moved <= T::int(FAR) {
            return Some(change);
        }
        self.alphas.copy_from_slice(task.alphas);
        self.iterate.set_alphas(&self.alphas);
        self.put_back();
        (ready.end_point)(&self.iterate, task.y, next);
        *alphas = Moves::new(Rule::Response);
        None
    }

    fn keep(&mut self, next: &State<T>) {
        let (kept, now) = (&mut self.slight, &self.iterate);
        kept.z.copy_from_slice(&now.z);
        kept.gradients.copy_from_slice(&now.gradients);
        kept.l.copy_from_slice(&now.l);
        kept.points.copy_from_slice(&now.points);
        kept.end.copy_from_slice(&next.hi);
    }

    fn put_back(&mut self) {
        let (kept, now) = (&self.slight, &mut self.iterate);
        now.z.copy_from_slice(&kept.z);
        now.gradients.copy_from_slice(&kept.gradients);
        now.l.copy_from_slice(&kept.l);
        now.points.copy_from_slice(&kept.points);
        now.has_momenta = false;
    }

    /// How far the end point is from the one kept, relative to the sizes of the components.
    fn displaced(&self, next: &State<T>) -> T {
        let pairs = next.hi.iter().zip(&self.slight.end);
        let moves = pairs.zip(&self.iterate.scale);
        moves.fold(T::int(0), |most, ((&x, &before), &size)| {
            most.max((x - before).abs() / size)
        })
    }
}
