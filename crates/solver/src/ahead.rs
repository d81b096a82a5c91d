//! Which sweeps are drafts ([`crate::draft`]): those that leave others to come. By the contraction seen they change Z by more than round-off, and g
//! will not be looked at after them. Short states have rows of them in one kernel ([`crate::small`]), which asks here whether to go on.

use crate::contraction::Contraction;
use equip_scalar::Float;

/// Sweeps that are expected to change Z by more than so many ε are drafts.
const DRAFT: f64 = 64.0;
/// The same of short states with more stages than [`SHORT_STAGES`], where the contraction is between [`CONTRACTIONS`]: they take 2 to 7 % less time. Where
/// it is better sweeps often change Z by less than expected, where it is worse the last are not like the first.
const DRAFT_OF_SHORT: f64 = 2.0;
pub(crate) const SHORT_STAGES: usize = 8;
const CONTRACTIONS: [f64; 2] = [1.0 / 50.0, 1.0 / 3.0];

/// Whether sweeps of a row go on.
pub(crate) trait Again<T> {
    /// After one that has changed Z by `change`. Mark it `#[inline(always)]`: it is asked in the midst of a kernel.
    fn again(&mut self, change: T) -> bool;
}

/// One sweep.
pub(crate) struct Once;

impl<T> Again<T> for Once {
    #[inline(always)]
    fn again(&mut self, _change: T) -> bool {
        false
    }
}

/// What is asked for any float, asked by doubles.
pub(crate) struct InDoubles<'a, A, T>(pub(crate) &'a mut A, pub(crate) std::marker::PhantomData<T>);

/// A row of drafts and what is seen of them.
pub(crate) struct Drafts<'a, T> {
    contraction: &'a mut Contraction<T>,
    is_short: bool,
    /// What an error of the end point is worth in g, and below what that is looked at early, if it may be.
    look: Option<(f64, f64)>,
    /// The last has been seen.
    pub(crate) seen: bool,
    pub(crate) made: u32,
}

impl<'a, T: Float> Drafts<'a, T> {
    pub(crate) fn new(
        contraction: &'a mut Contraction<T>,
        is_short: bool,
        look: Option<(T, T)>,
    ) -> Self {
        Drafts {
            contraction,
            is_short,
            look: look.map(|(worth, least)| (worth.to_f64(), least.to_f64())),
            seen: false,
            made: 1,
        }
    }

    /// Whether the next sweep leaves others to come.
    #[inline(always)]
    pub(crate) fn are_next(&mut self) -> bool {
        let contraction = &mut *self.contraction;
        let rate = contraction.rate;
        let [best, worst] = CONTRACTIONS;
        let is_even = self.is_short & (rate > best) & (rate < worst);
        let most = if is_even { DRAFT_OF_SHORT } else { DRAFT } * T::EPSILON.to_f64();
        let is_seen = |contraction: &mut Contraction<T>, (worth, least)| {
            contraction.next_error() * worth < least
        };
        contraction.next_change() > most
            && !self.look.is_some_and(|look| is_seen(contraction, look))
    }
}

impl<T: Float> Again<T> for Drafts<'_, T> {
    #[inline(always)]
    fn again(&mut self, change: T) -> bool {
        self.seen = self.contraction.see_plain(change.to_f64());
        let again = self.seen && self.are_next();
        self.made += u32::from(again);
        again
    }
}

impl<T: Float, A: Again<T>> Again<f64> for InDoubles<'_, A, T> {
    #[inline(always)]
    fn again(&mut self, change: f64) -> bool {
        self.0.again(T::exact(change))
    }
}
