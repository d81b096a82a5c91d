//! The start of a small step as one kernel: gradients as foretold, L, Z, the stages, and the sizes of the components, by literal lengths.
//!
//! The same as [`Foretell`](crate::start::Foretell), [`crate::mix`] and [`Sizes`](crate::start::Sizes) one after the other, bit for bit, for
//! states as short as those of [`crate::small`].

use crate::pairs::{HALF, has_pairs};
use crate::product::{Anew, Mixes, Square};
use crate::prolongation::View;
use crate::row::{Row, literal, rows};
use crate::small::Finish;
use crate::start::{largest, likely, most_likely, resolve, see};
use crate::whole::conjugate;
use equip_scalar::{InstructionSet, Kernel, Lanes};

/// What the start of a step reads and writes beside what a sweep does.
pub(crate) struct Opening<'a, S> {
    pub(crate) sweep: S,
    pub(crate) prolongation: View<'a, f64>,
    /// L of the last step.
    pub(crate) l: &'a [f64],
    /// ∇H at the start of the step, if it is known.
    pub(crate) known: Option<&'a [f64]>,
    /// The size of the step over that of the last.
    pub(crate) ratio: f64,
    pub(crate) scale: &'a mut [f64],
    pub(crate) inverse_scale: &'a mut [f64],
}

impl<'a, S: Finish<'a>> Opening<'a, S> {
    /// Does it, if there is a kernel for these lengths. The unknown components are numbered by literals, as are the lanes.
    pub(crate) fn run(&mut self, set: InstructionSet) -> Option<()> {
        let step = self.sweep.step();
        let (unknowns, stride) = (S::WIDTH * step.hi.len() / 2, step.hb.len());
        let pairs = has_pairs::<f64>(step.s);
        macro_rules! by_literals {
            ([$($unknowns:literal)*]) => {
                match (unknowns, stride) {
                    $(
                        ($unknowns, 4) => set.run_wide(&mut OneGroup::<_, $unknowns, 4>(self)),
                        ($unknowns, 8) => set.run_wide(&mut OneGroup::<_, $unknowns, 8>(self)),
                        ($unknowns, 16) if pairs => set.run_wide(&mut Pairs::<_, $unknowns>(self)),
                    )*
                    _ => None,
                }
            };
        }
        by_literals!([1 2 3 4])
    }

    #[inline(always)]
    fn lanes<const C: usize, const G: usize, const N: usize>(&mut self, k: &impl Mixes<f64, G, N>) {
        let m = C / S::WIDTH;
        let s = self.sweep.step().s;
        let hb: Row<f64, G, N> = *literal(rows(self.sweep.step().hb).first());
        let mut slopes = [[Lanes::splat(0.0); C]; G];
        for c in 0..C {
            let (from, by_momentum) = conjugate(c, 2 * m);
            let row: &Row<f64, G, N> = literal(rows(self.l).get(from));
            let most = most_likely(row, Some(self.ratio));
            let at_start = self.known.map_or(0.0, |known| known[c]);
            let sign = if by_momentum { -1.0 } else { 1.0 };
            let gradients = self.prolongation.foretell(row, s, sign, at_start);
            for g in 0..G {
                slopes[g][c] = Lanes(likely(&gradients[g], &hb[g], most));
            }
        }
        self.sweep.finish(&slopes, k);
        let step = self.sweep.step();
        let points = step.points.as_chunks::<N>().0;
        for (c, (scale, &hi)) in self.scale.iter_mut().zip(step.hi).enumerate().take(2 * m) {
            let mut size = [hi.abs(); N];
            for g in 0..G {
                see(&mut size, &points[c * G + g]);
            }
            *scale = largest(size);
        }
        resolve(self.scale, self.inverse_scale, 0..2 * m);
    }
}

struct OneGroup<'a, S, const C: usize, const N: usize>(&'a mut S);
struct Pairs<'a, S, const C: usize>(&'a mut S);

impl<'b, S: Finish<'b>, const C: usize, const N: usize> Kernel
    for OneGroup<'_, Opening<'b, S>, C, N>
{
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let k: &'b [f64] = self.0.sweep.step().k;
        self.0.lanes::<C, 1, N>(&Square::of(k));
    }

    #[inline(always)]
    fn run_narrow(&mut self) {
        let k: &'b [f64] = self.0.sweep.step().k;
        self.0.lanes::<C, 1, N>(&Anew(Square::of(k)));
    }
}

impl<'b, S: Finish<'b>, const C: usize> Kernel for Pairs<'_, Opening<'b, S>, C> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let k: &'b [f64] = self.0.sweep.step().k;
        self.0.lanes::<C, 2, HALF>(&S::sixteen(k));
    }

    #[inline(always)]
    fn run_narrow(&mut self) {
        let k: &'b [f64] = self.0.sweep.step().k;
        self.0.lanes::<C, 2, HALF>(&Anew(S::there(k)));
    }
}
