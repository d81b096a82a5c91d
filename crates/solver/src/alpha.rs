//! The α part: how the free α's move to bring g to zero with the least displacement of the end point.
//!
//! One equation for up to s − 1 unknowns. With slopes v_k = dg/dα_k and displacements u_k = dy1/dα_k,
//! w_k = 1/‖u_k‖, the smallest (δα_k/w_k) is (project note, section 3)
//!
//! $$ \delta\alpha_k = - g_{lin} \frac{w_k^2 v_k}{\sum_j w_j^2 v_j^2} . $$
//!
//! It does not change when an α is rescaled, and an α whose slope vanishes costs nothing while another's does not.

use equip_scalar::Float;

/// Slopes and displacements of the free α's, and the move they make.
#[derive(Debug)]
pub(crate) struct AlphaMove<T> {
    /// v_k, per free α.
    pub(crate) slopes: Vec<T>,
    /// ‖u_k‖, relative to the state, per free α.
    pub(crate) displacements: Vec<T>,
    /// δα for all of α_1 … α_{s−1}.
    pub(crate) delta: Vec<T>,
}

/// What came of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moved {
    /// As wanted.
    Fully,
    /// Shortened to stay within the bound.
    ToBound,
    /// All slopes vanish.
    NotAtAll,
}

impl<T: Float> AlphaMove<T> {
    pub(crate) fn new(alphas: usize) -> Self {
        let zeros = || vec![T::int(0); alphas];
        AlphaMove {
            slopes: zeros(),
            displacements: zeros(),
            delta: zeros(),
        }
    }

    /// Computes δα for the free α's (numbers `first`..=s − 1, counted from 1), given that g is predicted to be
    /// `g` with the present `alphas`; |α_k| stays at most `bound`.
    pub(crate) fn least_displacement(
        &mut self,
        g: T,
        alphas: &[T],
        first: usize,
        bound: T,
    ) -> Moved {
        self.delta.fill(T::int(0));
        let free = first - 1..alphas.len();
        // Ratios v_k / ‖u_k‖ against the largest of them: no square overflows, whatever the units of H.
        let pull = |k: usize| {
            if self.displacements[k] > T::int(0) {
                self.slopes[k] / self.displacements[k]
            } else {
                T::int(0)
            }
        };
        let largest = free.clone().fold(T::int(0), |a, k| a.max(pull(k).abs()));
        if !(largest > T::int(0)) || !largest.is_finite() {
            return Moved::NotAtAll;
        }
        let sum = free.clone().fold(T::int(0), |sum, k| {
            let x = pull(k) / largest;
            sum + x * x
        });
        let mut shorten = T::int(1);
        for k in free.clone() {
            if self.displacements[k] > T::int(0) {
                let d = -(g / largest) * (pull(k) / largest) / sum / self.displacements[k];
                self.delta[k] = d;
                let room = if d > T::int(0) {
                    bound - alphas[k]
                } else {
                    bound + alphas[k]
                };
                if d.abs() > room {
                    shorten = shorten.min(room / d.abs());
                }
            }
        }
        if !shorten.is_finite() || self.delta.iter().any(|d| Float::is_nan(*d)) {
            self.delta.fill(T::int(0));
            return Moved::NotAtAll;
        }
        if shorten < T::int(1) {
            self.delta.iter_mut().for_each(|d| *d *= shorten);
            return Moved::ToBound;
        }
        Moved::Fully
    }
}
