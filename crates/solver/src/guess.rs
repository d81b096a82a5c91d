//! Initial guess of the stages: the polynomial of the last step's stage derivatives, prolonged.
//!
//! The derivatives of the last step, f(Y_i) at the nodes c_i, define u'(τ) = Σ_k γ_k P_k(τ) with
//! γ_k = Σ_i b_i P_k(c_i) f(Y_i). The new stages are guessed as
//!
//! $$ Z_i = h_{old} \int_1^{1 + r c_i} u'(\tau) d\tau, \qquad r = h / h_{old} . $$

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
    /// Whether the L_i are not here but with the sweeps.
    elsewhere: bool,
    /// Σ_k (∫_1^{1+r c_i} P_k) P_k(c_j), row by row, and the ratio r it was made for.
    matrix: Vec<T>,
    ratio: T,
}

impl<T: Float> Guess<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        let zero = T::int(0);
        Guess {
            l: vec![zero; s * n],
            h: zero,
            elsewhere: false,
            matrix: vec![zero; s * s],
            ratio: zero,
        }
    }

    /// Remembers an accepted step.
    pub(crate) fn remember(&mut self, l: &[T], h: T) {
        self.l.copy_from_slice(l);
        self.h = h;
        self.elsewhere = false;
    }

    /// Remembers the size of an accepted step whose L_i are kept elsewhere.
    pub(crate) fn remember_size(&mut self, h: T) {
        self.h = h;
        self.elsewhere = true;
    }

    /// h over the size of the last step, if there is one.
    pub(crate) fn ratio_to(&self, h: T) -> Option<T> {
        (self.h != T::int(0)).then(|| h / self.h)
    }

    /// Whether the next guess prolongs the last step.
    pub(crate) fn is_from_last_step(&self) -> bool {
        self.h != T::int(0)
    }

    /// Forgets it, so that the next guess starts from the state alone.
    pub(crate) fn forget(&mut self) {
        self.h = T::int(0);
    }

    /// Fills `stages.z`; with nothing to prolong it is zero, from where full Newton is at its safest.
    pub(crate) fn make(&mut self, stages: &mut Stages<T>, h: T) {
        let n = stages.n;
        if self.h == T::int(0) || self.elsewhere {
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
        fill_prolongation(gauss, ratio, |i, j, e| self.matrix[i * s + j] = e);
        self.ratio = ratio;
    }
}

/// Gives the entries (i, j) of Σ_k (∫_1^{1+r c_i} P_k) P_k(c_j) to `set`.
pub(crate) fn fill_prolongation<T: Float>(
    gauss: &Gauss<T>,
    ratio: T,
    mut set: impl FnMut(usize, usize, T),
) {
    let s = gauss.stages();
    // One scratch row: the integrals of P_0 … P_{s−1} from 0; from 0 to 1 only that of P_0 is not zero.
    let mut integrals = [T::int(0); crate::MAX_STAGES];
    let integrals = &mut integrals[..s];
    for (i, &c) in gauss.nodes().iter().enumerate() {
        legendre_integrals_at(T::int(1) + ratio * c, integrals);
        integrals[0] -= T::int(1);
        for j in 0..s {
            let terms = integrals.iter().enumerate();
            let e = terms.fold(T::int(0), |sum, (k, &x)| sum + x * gauss.legendre(k)[j]);
            set(i, j, e);
        }
    }
}
