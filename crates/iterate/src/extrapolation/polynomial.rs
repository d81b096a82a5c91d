//! The coefficients E and ρ of the extrapolation: the polynomial through the gradients of the last step, and
//! through the gradient at the start of this step if known, evaluated at the nodes of this step.
//!
//! $$ E_{ij} = -\frac1h \sum_{k<s} \bigl(P_k(\tau_i) - \rho_i P_k(a)\bigr) P_k(c_j), \qquad \rho_i = P_s(\tau_i)/P_s(a), \quad \tau_i = a + r c_i . $$
//!
//! E is applied in two factors: Legendre coefficients from L, then their polynomial at the nodes. Its entries
//! are recomputed whenever the ratio r of the step sizes changes, with variable steps in every step. The
//! nodes are therefore processed side by side in vectors.
//!
//! Cost: s² multiplications to compute, and 2 s² for each component to apply.

use crate::layout::row::{by_groups, stride_for};
use crate::matrix::product::product_any;
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Coefficients;

/// E as a product of two factors, and ρ.
#[derive(Debug)]
pub struct Polynomial<T> {
    /// −(L_k(τ_i) − ρ_i L_k(a))/h at k·stride + i, with P_k = √(2k+1) L_k.
    at_nodes: Vec<T>,
    rho: Vec<T>,
    /// √(2k+1) P_k(c_j) at j·stride + k.
    coefficients: Vec<T>,
    /// c_i.
    nodes: Vec<T>,
    stages: usize,
    /// The recurrence coefficients (2k+1)/(k+1) and k/(k+1) of the Legendre polynomials, for k below the
    /// degree s.
    recurrence: Vec<[T; 2]>,
    /// Workspace for L_0 … L_s at the start of the step, and at a group of nodes.
    at_start: Vec<T>,
    at_node: Vec<T>,
    /// What E was computed for: where the step starts in the last one, the ratio of the sizes, the size of
    /// the last step, and whether the gradient at the start is known.
    made_for: Option<([T; 3], bool)>,
}

impl<T: Float> Polynomial<T> {
    /// For steps of this method, before any entries are computed.
    pub fn new(method: &Coefficients<T>) -> Self {
        let (s, degree) = (method.stages(), method.degree());
        let stride = stride_for::<T>(s);
        let mut nodes = vec![T::int(0); stride];
        nodes[..s].copy_from_slice(method.nodes());
        let mut coefficients = vec![T::int(0); stride * stride];
        for k in 0..degree {
            let norm = T::int(2 * k as i64 + 1).sqrt();
            for (j, &p) in method.legendre(k).iter().enumerate() {
                coefficients[j * stride + k] = norm * p;
            }
        }
        let recurrence = |k: i64| [T::ratio(2 * k + 1, k + 1), T::ratio(k, k + 1)];
        Polynomial {
            at_nodes: vec![T::int(0); stride * stride],
            rho: vec![T::int(0); stride],
            coefficients,
            nodes,
            recurrence: (0..degree as i64).map(recurrence).collect(),
            at_start: vec![T::int(0); degree + 1],
            at_node: vec![T::int(0); (degree + 1) * stride],
            stages: s,
            made_for: None,
        }
    }

    /// The coefficients in the form that is applied to L.
    pub(crate) fn view(&self) -> View<'_, T> {
        View {
            at_nodes: &self.at_nodes,
            coefficients: &self.coefficients,
            rho: &self.rho,
        }
    }

    /// Computes E and ρ for a step that starts at `start` in the last step of size `h` and is `ratio` times
    /// as long.
    pub(crate) fn make(&mut self, set: InstructionSet, [start, ratio, h]: [T; 3], known: bool) {
        let made_for = Some(([start, ratio, h], known));
        if self.made_for != made_for {
            self.made_for = made_for;
            set.run(&mut Make {
                to: self,
                start,
                ratio,
                h,
                known,
            });
        }
    }
}

/// The two factors of E, and ρ.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, T> {
    at_nodes: &'a [T],
    coefficients: &'a [T],
    rho: &'a [T],
}

impl<T: Float> View<'_, T> {
    /// The Legendre coefficients of L, for any number of groups.
    #[inline(always)]
    pub(crate) fn coefficients<'b, const N: usize>(
        &self,
        l: &[[T; N]],
        room: &'b mut [[T; N]],
        s: usize,
    ) -> &'b [[T; N]] {
        for (g, to) in room.iter_mut().enumerate() {
            *to = product_any(self.coefficients.as_chunks::<N>().0, l, g, s);
        }
        room
    }

    /// The extrapolated gradient for the group g of stages, from the Legendre coefficients.
    #[inline(always)]
    pub(crate) fn extrapolate_group<const N: usize>(
        &self,
        coefficients: &[[T; N]],
        (g, s): (usize, usize),
        sign: T,
        at_start: T,
    ) -> [T; N] {
        let guess = product_any(self.at_nodes.as_chunks::<N>().0, coefficients, g, s);
        extrapolated(&guess, &self.rho.as_chunks::<N>().0[g], sign, at_start)
    }
}

/// ± E L + ρ ∇H(y0).
#[inline(always)]
pub(crate) fn extrapolated<T: Float, const N: usize>(
    guess: &[T; N],
    rho: &[T; N],
    sign: T,
    at_start: T,
) -> [T; N] {
    std::array::from_fn(|i| sign * guess[i] + rho[i] * at_start)
}

struct Make<'a, T> {
    to: &'a mut Polynomial<T>,
    start: T,
    ratio: T,
    h: T,
    known: bool,
}

impl<T: Float> Kernel for Make<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.to.stages, self);
    }
}

impl<T: Float> Make<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let to = &mut *self.to;
        let s = to.recurrence.len();
        let at_start = to.at_start.as_chunks_mut::<1>().0;
        classical(&to.recurrence, [self.start], at_start);
        let at_node = &mut to.at_node.as_chunks_mut::<N>().0[..=s];
        let scale = T::int(-1) / self.h;
        let at_nodes = to.at_nodes.as_chunks_mut::<N>().0;
        let rho = to.rho.as_chunks_mut::<N>().0;
        for (g, nodes) in to.nodes.as_chunks::<N>().0.iter().enumerate() {
            let tau = std::array::from_fn(|i| self.start + self.ratio * nodes[i]);
            classical(&to.recurrence, tau, at_node);
            if self.known {
                rho[g] = at_node[s].map(|p| p / at_start[s][0]);
            } else {
                rho[g] = [T::int(0); N];
            }
            for (k, (p, a)) in at_node.iter().zip(&*at_start).take(s).enumerate() {
                at_nodes[k * groups + g] =
                    std::array::from_fn(|i| scale * (p[i] - rho[g][i] * a[0]));
            }
        }
    }
}

/// The classical Legendre polynomials L_0 … L_s at 2τ − 1, where P_k = √(2k+1) L_k.
#[inline(always)]
fn classical<T: Float, const N: usize>(recurrence: &[[T; 2]], tau: [T; N], out: &mut [[T; N]]) {
    let x = tau.map(|tau| (tau + tau) - T::int(1));
    let (mut before, mut now) = ([T::int(1); N], x);
    (out[0], out[1]) = (before, now);
    for (out, &[ahead, back]) in out[2..].iter_mut().zip(&recurrence[1..]) {
        let mut next = now;
        for i in 0..N {
            next[i] = ahead * x[i] * now[i] - back * before[i];
        }
        (before, now) = (now, next);
        *out = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::DoubleDouble;

    /// Polynomials of degree s, given by their values at the old nodes and at the start, are extrapolated
    /// exactly.
    fn polynomials_are_foretold<T: Float>(most: f64) {
        for s in 2..=16 {
            let gauss = Coefficients::<T>::gauss(s).unwrap_or_else(|e| panic!("{e}"));
            for set in InstructionSet::available() {
                let mut made = Polynomial::new(&gauss);
                let (start, ratio, h) = (T::int(1), T::ratio(3, 4), T::ratio(1, 8));
                made.make(set, [start, ratio, h], true);
                let power =
                    |x: T| (0..s).fold(T::int(1), |product, _| product * (x - T::ratio(3, 4)));
                let stride = stride_for::<T>(s);
                let mut l = vec![[T::int(0); 1]; stride];
                for ((l, &c), &b) in l.iter_mut().zip(gauss.nodes()).zip(gauss.weights()) {
                    *l = [-(h * b * power(c))];
                }
                let found = match crate::layout::row::lanes_of::<T>(s) {
                    4 => extrapolated::<T, 4>(&made, l.as_flattened(), s, power(start)),
                    8 => extrapolated::<T, 8>(&made, l.as_flattened(), s, power(start)),
                    _ => extrapolated::<T, 1>(&made, l.as_flattened(), s, power(start)),
                };
                for (&found, &c) in found.iter().zip(gauss.nodes()) {
                    let error = (found - power(start + ratio * c)).abs().to_f64();
                    assert!(error <= most * 6f64.powi(s as i32), "s = {s}: {error}");
                }
            }
        }
    }

    fn extrapolated<T: Float, const N: usize>(
        made: &Polynomial<T>,
        l: &[T],
        s: usize,
        at_start: T,
    ) -> Vec<T> {
        let (view, l) = (made.view(), l.as_chunks::<N>().0);
        let mut room = vec![[T::int(0); N]; l.len()];
        let coefficients = view.coefficients(l, &mut room, s);
        (0..l.len())
            .flat_map(|g| view.extrapolate_group(coefficients, (g, s), T::int(1), at_start))
            .collect()
    }

    #[test]
    fn polynomials_of_the_degree_are_foretold_exactly() {
        polynomials_are_foretold::<f64>(1e-15);
        polynomials_are_foretold::<DoubleDouble>(1e-30);
    }
}
