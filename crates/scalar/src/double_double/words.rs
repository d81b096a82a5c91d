//! The algorithms of arithmetic on pairs of words (hi, lo). A word is an `f64`, or one `f64` in each lane.
//!
//! The algorithms use arithmetic, the rounding error of a product, and one selection of words, so the lanes
//! have the bits of single numbers. u = 2⁻⁵³.

use super::transforms::{Word, fast_two_sum, two_prod, two_sum};

/// hi + lo.
pub(super) type Pair<W> = (W, W);

/// JMP algorithm 6, error below 3u² + 13u³. The sign of a zero is that of the leading sum.
#[inline(always)]
pub(super) fn plus<W: Word>(a: Pair<W>, b: Pair<W>) -> Pair<W> {
    let (sh, sl) = two_sum(a.0, b.0);
    let (th, tl) = two_sum(a.1, b.1);
    let (vh, vl) = fast_two_sum(sh, sl + th);
    let (hi, lo) = fast_two_sum(vh, tl + vl);
    (hi.unless_zero(hi, sh), lo)
}

/// JMP algorithm 10, error below 5u² (Muller–Rideau 2022). The sign of a zero is that of the leading product.
#[inline(always)]
pub(super) fn times<W: Word>(a: Pair<W>, b: Pair<W>) -> Pair<W> {
    let (p, e) = two_prod(a.0, b.0);
    let (hi, lo) = fast_two_sum(p, e + (a.0 * b.1 + a.1 * b.0));
    (hi.unless_zero(hi, p), lo)
}

/// JMP algorithm 7, error below 2u².
#[inline(always)]
pub(super) fn times_word<W: Word>(a: Pair<W>, b: W) -> Pair<W> {
    let (ch, cl) = two_prod(a.0, b);
    let (th, tl) = fast_two_sum(ch, a.1 * b);
    fast_two_sum(th, tl + cl)
}

/// JMP algorithm 17, error below 15u² + 56u³.
#[inline(always)]
pub(super) fn over<W: Word>(a: Pair<W>, b: Pair<W>) -> Pair<W> {
    let q = a.0 / b.0;
    let r = times_word(b, q);
    let rest = (a.0 - r.0) + (a.1 - r.1);
    fast_two_sum(q, rest / b.0)
}

/// One correction of the rounded root s of hi, s + (x − s²)/(2s) [Lefèvre, Louvet, Muller, Picot, Rideau,
/// *Accurate calculation of Euclidean norms using double-word arithmetic*, ACM TOMS 49 (2023), SQRTDWtoDW],
/// error below 25/8 u².
#[inline(always)]
pub(super) fn root<W: Word>(x: Pair<W>, s: W) -> Pair<W> {
    let (p, e) = two_prod(s, s);
    let rest = ((x.0 - p) - e) + x.1;
    fast_two_sum(s, rest / (W::word(2.0) * s))
}

/// (s, e) with s + e = a + b exactly and |e| below 2⁻¹⁰⁴ |s|: the four words are distilled by two-sums, the
/// first two are s.
#[inline(always)]
pub(super) fn distilled<W: Word>(a: Pair<W>, b: Pair<W>) -> (Pair<W>, Pair<W>) {
    let (s, sl) = two_sum(a.0, b.0);
    let (t, tl) = two_sum(a.1, b.1);
    let (m, ml) = two_sum(sl, t);
    let (p, q) = two_sum(ml, tl);
    // a + b = s + m + p + q
    let (s, m) = two_sum(s, m);
    let (m, p) = two_sum(m, p);
    let (s, m) = two_sum(s, m);
    let (p, q) = two_sum(p, q);
    let (m, p) = two_sum(m, p);
    let (p, q) = two_sum(p, q);
    let (s, m) = two_sum(s, m);
    ((s, m), (p, q))
}

/// A sum of products, its first words added without error, what they and the products lose in one word
/// beside: the error of n products is below n u² times the sum of their sizes, roughly [Ogita, Rump, Oishi,
/// *Accurate sum and dot product*, SIAM J. Sci. Comput. 26 (2005), Dot2]. Half the operations of as many
/// products and sums, and no chain of them longer than two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dot<W> {
    sum: W,
    rest: W,
}

impl<W: Word> Dot<W> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Dot {
            sum: W::word(0.0),
            rest: W::word(0.0),
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, a: Pair<W>, b: Pair<W>) {
        let (p, e) = two_prod(a.0, b.0);
        let (sum, d) = two_sum(self.sum, p);
        self.sum = sum;
        self.rest = self.rest + (d + (e + (a.0 * b.1 + a.1 * b.0)));
    }

    #[inline(always)]
    pub(super) fn total(self) -> Pair<W> {
        two_sum(self.sum, self.rest)
    }
}

/// A sum of pairs in three words: the first two are added without error, what they lose is added up in the
/// third. [Rump, Ogita, Oishi, *Accurate floating-point summation*, SIAM J. Sci. Comput. 31 (2008), SumK for
/// K = 3, the lower words entering one level below the upper ones.]
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum<W> {
    pub(super) words: [W; 3],
}

impl<W: Word> Sum<W> {
    #[inline(always)]
    pub(super) fn of((hi, lo): Pair<W>) -> Self {
        Sum {
            words: [hi, lo, W::word(0.0)],
        }
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.words, other.words);
        let (a, e) = two_sum(a, x);
        let (b, f) = two_sum(b, y);
        let (b, g) = two_sum(b, e);
        Sum {
            words: [a, b, (c + z) + (f + g)],
        }
    }

    /// The nearest pair or nearly so, and what is left.
    #[inline(always)]
    pub(super) fn total(self) -> (Pair<W>, W) {
        let [a, b, c] = self.words;
        let (a, b) = two_sum(a, b);
        let (b, c) = two_sum(b, c);
        let (a, b) = two_sum(a, b);
        ((a, b), c)
    }
}
