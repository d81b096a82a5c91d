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
//! Cost: 2m s² products for the coefficients, about 16 m s for the sums, j side by side in vectors. Of many components some are gone through at a time, so that
//! their coefficients stay in the first-level cache.

use crate::row::{add, by_lanes, difference, groups_of, scaled, times};
use crate::sweep::Iterate;
use equip_scalar::{Float, Kernel, Pack, Scalar, mix_stages};
use equip_tableau::Gauss;

/// So many α's move. The higher ones disturb the stages the more for the same displacement of y1, and with small defects their slopes
/// are small differences: with all, one sweep more at s = 8 and errors no smaller.
const LEADING: usize = 3;

/// Degrees of freedom whose coefficients are there at a time.
const BLOCK: usize = 32;

#[derive(Debug)]
pub(crate) struct Slopes<T: Float> {
    /// P_j(c_i) at i·stride + j.
    legendre: Vec<T>,
    /// φ^q and φ^p: component c of φ_j at c·stride + j.
    coefficients: [Vec<T>; 2],
    /// ‖φ_j^q‖ and ‖φ_j^p‖.
    pub(crate) norms: [Vec<T>; 2],
    /// W(a, j) at a·stride + j.
    products: Vec<T>,
    /// ω(k, j) and ω(k − 1, j) for the j > k that W(k − 1, j) and W(k, j) come with, else 0; at (k − 1)·stride + j.
    ahead: Vec<T>,
    behind: Vec<T>,
    /// v_k and w_k of the α's that move.
    v: [T; LEADING],
    w: [T; LEADING],
    /// The direction d, one for each α.
    pub(crate) d: Vec<T>,
}

impl<T: Float> Slopes<T> {
    pub(crate) fn new(gauss: &Gauss<T>, iterate: &Iterate<T>) -> Self {
        let (s, stride) = (iterate.s, iterate.stride);
        let zeros = |len: usize| vec![T::int(0); len];
        let mut legendre = zeros(s * stride);
        for j in 0..s {
            for (i, &p) in gauss.legendre(j).iter().enumerate() {
                legendre[i * stride + j] = p;
            }
        }
        let omega = |k: usize, j: usize| {
            let square = (2 * k + 1) * (2 * j + 1);
            T::int(2) * T::int(square as i64).sqrt()
        };
        let (mut ahead, mut behind) = (zeros(LEADING * stride), zeros(LEADING * stride));
        for k in 1..s.min(LEADING + 1) {
            for j in k + 1..s {
                let place = (k - 1) * stride + j;
                if (j - k) % 2 == 1 {
                    ahead[place] = omega(k, j);
                } else {
                    behind[place] = omega(k - 1, j);
                }
            }
        }
        Slopes {
            legendre,
            coefficients: [0, 1].map(|_| zeros(BLOCK.min(iterate.n / 2) * stride)),
            norms: [zeros(stride), zeros(stride)],
            products: zeros((LEADING + 1) * stride),
            ahead,
            behind,
            v: [T::int(0); LEADING],
            w: [T::int(0); LEADING],
            d: zeros(s - 1),
        }
    }

    /// Slopes and direction at the current L. Returns whether there is a direction.
    pub(crate) fn take(&mut self, iterate: &Iterate<T>, h: T) -> bool {
        let (set, s, stride) = (iterate.set, iterate.s, iterate.stride);
        self.products.fill(T::int(0));
        self.norms.iter_mut().for_each(|x| x.fill(T::int(0)));
        let (l_q, l_p) = iterate.l.split_at(iterate.n / 2 * stride);
        let blocks = |l| <[T]>::chunks(l, BLOCK * stride);
        for (l_q, l_p) in blocks(l_q).zip(blocks(l_p)) {
            for (to, l) in self.coefficients.iter_mut().zip([l_q, l_p]) {
                mix_stages(set, &self.legendre, l, &mut to[..l.len()], s, stride);
            }
            set.run(&mut Products {
                slopes: self,
                s,
                len: l_q.len(),
            });
        }
        set.run(&mut Sums { slopes: self, s });
        let zero = T::int(0);
        let mut largest = zero;
        for ((v, w), d) in self.v.iter_mut().zip(&mut self.w).zip(&mut self.d) {
            *v = -*v / h;
            *w /= h;
            // In wild units w² is out of range.
            *d = *v / *w / *w;
            if !d.is_finite() {
                *d = zero;
            }
            largest = largest.max(d.abs());
        }
        if !(largest > zero) {
            return false;
        }
        let inverse = T::int(1) / largest;
        self.d.iter_mut().take(LEADING).for_each(|d| *d *= inverse);
        true
    }

    /// Σ_k w_k |α_k| for α's along d that change g by 1: what they move, by the bounds.
    pub(crate) fn displacement(&self) -> T {
        let terms = self.w.iter().zip(&self.d);
        terms.fold(T::int(0), |sum, (&w, &d)| sum + (w * d).abs()) / self.slope().abs()
    }

    /// Σ_k v_k d_k.
    pub(crate) fn slope(&self) -> T {
        let terms = self.v.iter().zip(&self.d);
        terms.fold(T::int(0), |sum, (&v, &d)| sum + v * d)
    }
}

/// W(a, j) and the squares of the norms, with a block of components more; each of φ^q and φ^p has this length.
struct Products<'a, T: Float> {
    slopes: &'a mut Slopes<T>,
    s: usize,
    len: usize,
}

impl<T: Float> Kernel for Products<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.s, self)
    }
}

impl<T: Float> Products<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let groups = groups_of::<T, N>(self.s);
        let stride = groups * N;
        let slopes = &mut *self.slopes;
        let [q, p] = slopes.coefficients.each_ref().map(|x| &x[..self.len]);
        for (squares, rows) in slopes.norms.iter_mut().zip([q, p]) {
            for (g, squares) in squares.as_chunks_mut::<N>().0.iter_mut().enumerate() {
                let mut sum = *squares;
                for row in rows.as_chunks::<N>().0.iter().skip(g).step_by(groups) {
                    add(&mut sum, &times(row, row));
                }
                *squares = sum;
            }
        }
        let known = self.s.min(LEADING + 1);
        for g in 0..groups {
            let at = |x: &[T], row: usize| -> [T; N] { x.as_chunks().0[row * groups + g] };
            for a in 0..known {
                let to = &mut slopes.products.as_chunks_mut::<N>().0[a * groups + g];
                let mut product = *to;
                for c in 0..self.len / stride {
                    let (q_a, p_a) = (q[c * stride + a], p[c * stride + a]);
                    let (q_j, p_j) = (at(q, c), at(p, c));
                    let by_q = scaled(&q_j, p_a);
                    add(&mut product, &difference(&by_q, &scaled(&p_j, q_a)));
                }
                *to = product;
            }
        }
    }
}

/// The norms, and the sums over j: −h v_k and h w_k.
struct Sums<'a, T: Float> {
    slopes: &'a mut Slopes<T>,
    s: usize,
}

impl<T: Float> Kernel for Sums<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.s, self)
    }
}

impl<T: Float> Sums<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let groups = groups_of::<T, N>(self.s);
        let slopes = &mut *self.slopes;
        for squares in &mut slopes.norms {
            for squares in squares.as_chunks_mut::<N>().0 {
                *squares = T::Pack::sqrt(T::Pack::of(squares)).numbers();
            }
        }
        let [norms_q, norms_p] = &slopes.norms;
        let known = self.s.min(LEADING + 1);
        let (mut v, mut w) = ([[T::int(0); N]; LEADING], [[T::int(0); N]; LEADING]);
        for g in 0..groups {
            let at = |x: &[T], row: usize| -> [T; N] { x.as_chunks().0[row * groups + g] };
            for a in 0..known {
                // W(a, j) and its bound.
                let product = at(&slopes.products, a);
                let (q_j, p_j) = (at(norms_q, 0), at(norms_p, 0));
                let mut bound = scaled(&q_j, norms_p[a]);
                add(&mut bound, &scaled(&p_j, norms_q[a]));
                if a < LEADING {
                    let ahead = at(&slopes.ahead, a);
                    add(&mut v[a], &times(&ahead, &product));
                    add(&mut w[a], &times(&ahead, &bound));
                }
                if a > 0 {
                    let behind = at(&slopes.behind, a - 1);
                    v[a - 1] = difference(&v[a - 1], &times(&behind, &product));
                    add(&mut w[a - 1], &times(&behind, &bound));
                }
            }
        }
        slopes.v = v.map(sum);
        slopes.w = w.map(sum);
    }
}

/// The sum of N numbers, a power of 2, half against half.
#[inline(always)]
fn sum<T: Float, const N: usize>(mut x: [T; N]) -> T {
    let mut count = N;
    while count > 1 {
        count /= 2;
        for i in 0..count {
            x[i] += x[i + count];
        }
    }
    x[0]
}
