//! Initial guess of the stages: the polynomial of the last step's stage derivatives, prolonged.
//!
//! The derivatives of the last step, f(Y_i) at the nodes c_i, define u'(τ) = Σ_k γ_k P_k(τ) with
//! γ_k = Σ_i b_i P_k(c_i) f(Y_i). The new stages are guessed as
//!
//! $$ Z_i = h_{old} \int_1^{1 + r c_i} u'(\tau) d\tau, \qquad r = h / h_{old} . $$
//!
//! After a step that was made and then refused for its size, the integral begins at 0: the new step starts where it did.

use crate::stages::Stages;
use equip_scalar::Float;
use equip_tableau::{Gauss, legendre_integrals_at};

/// What the last accepted step leaves for the next.
#[derive(Debug)]
pub(crate) struct Guess<T: Float> {
    /// L_i of the last step.
    l: Vec<T>,
    /// Its size; zero when there is none.
    h: T,
    /// Whether the new step starts where it started, not where it ended.
    refused: bool,
    /// Sweeps made that step and have its L_i.
    is_swept: bool,
    /// The L_i are here.
    is_here: bool,
    /// Whether Z stands in the stages already.
    made: bool,
    /// Σ_k (∫_1^{1+r c_i} P_k) P_k(c_j), row by row, and the ratio r it was made for; that is zero when there is none.
    matrix: Vec<T>,
    ratio: T,
}

impl<T: Float> Guess<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        let zero = T::int(0);
        Guess {
            l: vec![zero; s * n],
            h: zero,
            refused: false,
            is_swept: false,
            is_here: true,
            made: false,
            matrix: vec![zero; s * s],
            ratio: zero,
        }
    }

    /// Remembers an accepted step.
    pub(crate) fn remember(&mut self, l: &[T], h: T) {
        self.l.copy_from_slice(l);
        self.h = h;
        self.is_swept = false;
        self.is_here = true;
        self.set_refused(false);
    }

    /// L_i and h of the step made last; h is zero when there is none. Of a step made by sweeps once they are [here](Self::fetch).
    pub(crate) fn last(&self) -> (&[T], T) {
        (&self.l, self.h)
    }

    /// The step made last is refused: the next starts where it did.
    pub(crate) fn refuse(&mut self) {
        self.set_refused(true);
    }

    fn set_refused(&mut self, refused: bool) {
        if self.refused != refused {
            self.refused = refused;
            self.ratio = T::int(0);
        }
    }

    /// Whether the next guess prolongs the last step.
    pub(crate) fn is_from_last_step(&self) -> bool {
        self.h != T::int(0)
    }

    /// Forgets it, so that the next guess starts from the state alone.
    pub(crate) fn forget(&mut self) {
        self.made = false;
        self.h = T::int(0);
    }

    /// Fills `stages.z`; with nothing to prolong it is zero, from where full Newton is at its safest.
    pub(crate) fn make(&mut self, stages: &mut Stages<T>, h: T) {
        let n = stages.n;
        if std::mem::take(&mut self.made) {
            return;
        }
        if self.h == T::int(0) {
            stages.z.fill(T::int(0));
            return;
        }
        let ratio = h / self.h;
        if ratio != self.ratio {
            self.fill_matrix(&stages.gauss, ratio);
        }
        let s = stages.count();
        for i in 0..s {
            let z = &mut stages.z[i * n..][..n];
            z.fill(T::int(0));
            for (j, l) in self.l.chunks_exact(n).enumerate() {
                let e = self.matrix[i * s + j];
                z.iter_mut().zip(l).for_each(|(sum, &x)| *sum += e * x);
            }
        }
    }

    fn fill_matrix(&mut self, gauss: &Gauss<T>, ratio: T) {
        let s = gauss.stages();
        let start = self.start();
        // One scratch row: the integrals of P_0 … P_{s−1} from 0; from 0 to 1 only that of P_0 is not zero.
        let mut integrals = [T::int(0); crate::MAX_STAGES];
        let integrals = &mut integrals[..s];
        for (i, &c) in gauss.nodes().iter().enumerate() {
            legendre_integrals_at(start + ratio * c, integrals);
            integrals[0] -= start;
            for j in 0..s {
                let terms = integrals.iter().enumerate();
                let e = terms.fold(T::int(0), |sum, (k, &x)| sum + x * gauss.legendre(k)[j]);
                self.matrix[i * s + j] = e;
            }
        }
        self.ratio = ratio;
    }

    /// Where the new step starts, in the step made last: 1, or 0 after it was refused.
    fn start(&self) -> T {
        T::int(i64::from(!self.refused))
    }

    /// Where the new step starts in the step made last, its size over that of it, and that, if there is one.
    pub(crate) fn prolongation(&self, h: T) -> Option<[T; 3]> {
        (self.h != T::int(0)).then(|| [self.start(), h / self.h, self.h])
    }

    /// Remembers an accepted step that sweeps have made, who keep its L in their own order until it is fetched.
    pub(crate) fn remember_swept(&mut self, h: T) {
        self.h = h;
        (self.is_swept, self.is_here) = (true, false);
        self.set_refused(false);
    }

    /// Whether sweeps have its L.
    pub(crate) fn is_swept(&self) -> bool {
        self.is_swept
    }

    /// Sees to it that the L_i are here; `give` writes them.
    pub(crate) fn fetch(&mut self, give: impl FnOnce(&mut [T])) {
        if !std::mem::replace(&mut self.is_here, true) {
            give(&mut self.l);
        }
    }

    /// Sweeps have begun another step, which they did not finish: what they have is no use.
    pub(crate) fn is_lost(&mut self) {
        self.is_swept = false;
    }

    /// The Z that is in the stages already is the guess of this step.
    pub(crate) fn is_made(&mut self) {
        self.made = true;
    }
}
