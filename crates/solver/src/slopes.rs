//! dg/dα_k from the Legendre coefficients of the stage derivatives: no Hessian, no linear system.
//!
//! With φ_j = Σ_i P_j(c_i) L_i = h γ_j the energy residual changes by
//!
//! $$ \frac{\partial g}{\partial\alpha_k} \approx -\frac1h \sum_{j}\bigl[\omega(k,j)\,W(k-1,j) - \omega(k-1,j)\,W(k,j)\bigr],
//! \qquad W(a,j) = \varphi_a^{p}\cdot\varphi_j^{q} - \varphi_a^{q}\cdot\varphi_j^{p}, $$
//!
//! with ω(k,j) = ∫P_k P_j' = 2√((2k+1)(2j+1)) for j > k, j − k odd, else 0 (project note, section 4; γ_a·ĝ_j = W(a,j)/h² since ĝ = −Jγ).
//! To leading order exact for k ≤ s − 2; for k = s − 1 the sum is empty, since φ_s is not resolved by s nodes: that α stays 0.
//!
//! The α's move along d_k = v_k / w_k², w_k being the same sum with norms in place of products: an upper bound of |v_k| that
//! stands for the displacement of y1. It is invariant under scaling of q against p. Under reversal of time φ_j becomes ∓φ_j, and v_k keeps
//! its ratio to the others: the direction is that of the step made backwards.
//!
//! Cost: 2m s² products for the coefficients, about m s² for the sums.

use crate::sweep::Iterate;
use equip_scalar::{Float, mix_stages};
use equip_tableau::Gauss;

/// So many α's move. The higher ones disturb the stages the more for the same displacement of y1, and with small defects their slopes
/// are small differences: with all, one sweep more at s = 8 and errors no smaller.
const LEADING: usize = 3;

#[derive(Debug)]
pub(crate) struct Slopes<T: Float> {
    /// P_j(c_i) at i·stride + j.
    legendre: Vec<T>,
    /// φ: component c of φ_j at c·stride + j.
    coefficients: Vec<T>,
    /// W(a, j) and its bound at a·s + j.
    products: Vec<T>,
    bounds: Vec<T>,
    /// ω(k, j) at k·s + j.
    omega: Vec<T>,
    /// v_k, k = 1 … s − 1.
    pub(crate) v: Vec<T>,
    /// The direction d.
    pub(crate) d: Vec<T>,
}

impl<T: Float> Slopes<T> {
    pub(crate) fn new(gauss: &Gauss<T>, iterate: &Iterate<T>) -> Self {
        let (s, stride) = (iterate.s, iterate.stride);
        let zeros = |len: usize| vec![T::int(0); len];
        let mut legendre = zeros(s * stride);
        let mut omega = zeros(s * s);
        for j in 0..s {
            for (i, &p) in gauss.legendre(j).iter().enumerate() {
                legendre[i * stride + j] = p;
            }
            for k in (0..j).filter(|k| (j - k) % 2 == 1) {
                let square = (2 * k + 1) * (2 * j + 1);
                omega[k * s + j] = T::int(2) * T::int(square as i64).sqrt();
            }
        }
        Slopes {
            legendre,
            coefficients: zeros(iterate.n * stride),
            products: zeros(s * s),
            bounds: zeros(s * s),
            omega,
            v: zeros(s - 1),
            d: zeros(s - 1),
        }
    }

    /// Slopes and direction at the current L. Returns whether there is a direction.
    pub(crate) fn take(&mut self, iterate: &Iterate<T>, h: T) -> bool {
        let (s, stride, m) = (iterate.s, iterate.stride, iterate.n / 2);
        mix_stages(
            iterate.set,
            &self.legendre,
            &iterate.l,
            &mut self.coefficients,
            s,
            stride,
        );
        self.take_products(s, stride, m);
        let zero = T::int(0);
        let mut largest = zero;
        for k in 1..s.min(LEADING + 1) {
            let (mut v, mut w) = (zero, zero);
            for j in k..s {
                let (ahead, behind) = (self.omega[k * s + j], self.omega[(k - 1) * s + j]);
                let (a, b) = ((k - 1) * s + j, k * s + j);
                v += ahead * self.products[a] - behind * self.products[b];
                w += ahead * self.bounds[a];
                if j > k {
                    w += behind * self.bounds[b];
                }
            }
            self.v[k - 1] = -v / h;
            w /= h;
            let d = self.v[k - 1] / (w * w);
            self.d[k - 1] = if d.is_finite() { d } else { zero };
            largest = largest.max(self.d[k - 1].abs());
        }
        if !(largest > zero) {
            return false;
        }
        self.d.iter_mut().for_each(|d| *d /= largest);
        true
    }

    /// W(a, j) = φ_a^p·φ_j^q − φ_a^q·φ_j^p and ‖φ_a^p‖‖φ_j^q‖ + ‖φ_a^q‖‖φ_j^p‖ for a ≤ j, j − a even.
    fn take_products(&mut self, s: usize, stride: usize, m: usize) {
        let (q, p) = self.coefficients.split_at(m * stride);
        let along = |x: &[T], a: usize, y: &[T], j: usize| {
            let (x, y) = (x.chunks_exact(stride), y.chunks_exact(stride));
            x.zip(y).fold(T::int(0), |sum, (x, y)| sum + x[a] * y[j])
        };
        let mut norms = [[T::int(0); 2]; crate::MAX_STAGES];
        for (j, norm) in norms.iter_mut().enumerate().take(s) {
            *norm = [along(q, j, q, j).sqrt(), along(p, j, p, j).sqrt()];
        }
        for a in 0..s.min(LEADING + 1) {
            for j in (a..s).step_by(2) {
                self.products[a * s + j] = along(p, a, q, j) - along(q, a, p, j);
                self.bounds[a * s + j] = norms[a][1] * norms[j][0] + norms[a][0] * norms[j][1];
            }
        }
    }

    /// Σ_k v_k d_k.
    pub(crate) fn slope(&self) -> T {
        let terms = self.v.iter().zip(&self.d);
        terms.fold(T::int(0), |sum, (&v, &d)| sum + v * d)
    }
}
