//! Explicit symmetric compositions of Störmer–Verlet for H = Σ p_i²/(2m_i) + U(q).
//!
//! One step of size h is Φ_{γ_1 h} ∘ … ∘ Φ_{γ_r h}, Φ_h: q += h p/(2m), p −= h ∇U(q), q += h p/(2m), γ_i =
//! γ_{r+1−i}. One gradient for each γ; neighbouring half drifts are made as one. The updates are compensated
//! like those of the library's own methods.

use super::flow::Flow;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_tableau::composition::Composition as Scheme;

/// A run of a composition.
#[derive(Debug)]
pub(crate) struct Composition<T: Float, E> {
    flow: Flow<T, E>,
    inverse_masses: Vec<T>,
    /// γ_i h, and the drifts between the kicks.
    kicks: Vec<T>,
    drifts: Vec<T>,
    pub(crate) y: Vec<T>,
    lost: Vec<T>,
    slope: Vec<T>,
    pub(crate) gradients: u64,
}

impl<T: Float, E: Evaluate<T>> Composition<T, E> {
    /// A run of `scheme` from `y` with step `h`.
    pub(crate) fn new(
        scheme: &Scheme,
        flow: Flow<T, E>,
        inverse_masses: Vec<T>,
        y: Vec<T>,
        h: T,
    ) -> Self {
        let kicks: Vec<T> = scheme
            .gammas::<T>()
            .into_iter()
            .map(|gamma| gamma * h)
            .collect();
        let half = T::ratio(1, 2);
        let zero = T::int(0);
        let drifts = (0..=kicks.len()).map(|i| {
            let before = if i > 0 { kicks[i - 1] } else { zero };
            half * (before + kicks.get(i).copied().unwrap_or(zero))
        });
        Composition {
            drifts: drifts.collect(),
            flow,
            inverse_masses,
            kicks,
            lost: vec![zero; y.len()],
            slope: y.clone(),
            y,
            gradients: 0,
        }
    }

    /// One step.
    pub(crate) fn advance(&mut self) {
        let m = self.inverse_masses.len();
        for i in 0..self.drifts.len() {
            for k in 0..m {
                let by = self.drifts[i] * (self.inverse_masses[k] * self.y[m + k]);
                self.add(k, by);
            }
            let Some(&kick) = self.kicks.get(i) else {
                break;
            };
            self.flow.derivative(&self.y, &mut self.slope);
            self.gradients += 1;
            for k in m..2 * m {
                self.add(k, kick * self.slope[k]);
            }
        }
    }

    /// y_k += `by`, with what rounding loses kept for the next time.
    #[inline(always)]
    fn add(&mut self, k: usize, by: T) {
        let (sum, lost) = T::two_sum(self.y[k], by + self.lost[k]);
        self.y[k] = sum;
        self.lost[k] = lost;
    }
}

#[cfg(test)]
mod tests {
    use super::{Composition, Flow, Scheme};
    use equip_scalar::{DoubleDouble, Float};
    use equip_tableau::composition::{KAHAN_LI, SOFRONIOU_SPALETTA, VERLET};

    type D = DoubleDouble;

    /// Error of the pendulum's state at t = 2 with so many steps, in double-double.
    fn error(scheme: &Scheme, steps: i64) -> f64 {
        let pendulum = equip_scenes::find("pendulum")
            .unwrap()
            .instance(&[])
            .unwrap();
        let (q, p) = pendulum.initial::<D>();
        let y = [q, p].concat();
        let masses = Flow::inverse_masses(pendulum.hamiltonian(), &y).unwrap();
        let h = D::int(2) / D::int(steps);
        let mut run = Composition::new(scheme, Flow::new(pendulum.hamiltonian()), masses, y, h);
        (0..steps).for_each(|_| run.advance());
        let (q, p) = pendulum.exact(D::int(2)).unwrap();
        let far = |(x, y): (&D, &D)| (*x - *y).to_f64().abs();
        run.y
            .iter()
            .zip([q, p].concat().iter())
            .map(far)
            .fold(0.0, f64::max)
    }

    #[test]
    fn every_scheme_has_its_order() {
        for (scheme, steps) in [(VERLET, 64), (KAHAN_LI, 16), (SOFRONIOU_SPALETTA, 12)] {
            let (coarse, fine) = (error(&scheme, steps), error(&scheme, 2 * steps));
            let order = (coarse / fine).log2();
            // Measured 2.0001, 8.006 and 10.04; headroom of 2.
            assert!(
                (order - f64::from(scheme.order)).abs() < 0.09,
                "{}: {order:.2} from {coarse:e}, {fine:e}",
                scheme.name
            );
        }
    }

    #[test]
    fn only_separable_energies_with_masses_are_taken() {
        let scene = equip_scenes::find("double-pendulum")
            .unwrap()
            .instance(&[])
            .unwrap();
        let (q, p) = scene.initial::<f64>();
        assert!(Flow::inverse_masses(scene.hamiltonian(), &[q, p].concat()).is_none());
    }
}
