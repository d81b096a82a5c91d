//! E and ρ of an extrapolation: what the polynomial through the gradients of the last step, and the one at
//! its end, is at the nodes of this.
//!
//! $$ E_{ij} = -\frac1h \sum_{k<s} \bigl(P_k(\tau_i) - \rho_i P_k(a)\bigr) P_k(c_j), \qquad \rho_i = P_s(\tau_i)/P_s(a), \quad \tau_i = a + r c_i . $$
//!
//! Made anew whenever the ratio r of the steps changes, with variable steps at every step: the nodes stand
//! side by side in vectors. E is the product of two matrices then, and for fewer components than stages it is
//! cheaper to apply one after the other.
//!
//! Cost: s³ multiplications for E, s² without.

use crate::layout::row::{Row, fused, groups_of, in_memory, lanes_of, literal, rows, stride_for};
use crate::matrix::product::{applied, product_any};
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Gauss;

/// E and ρ, column by column.
#[derive(Debug)]
pub struct Polynomial<T> {
    /// E, or its first factor.
    e: Vec<T>,
    rho: Vec<T>,
    /// √(2k+1) P_k(c_j) at k·stride + j.
    legendre: Vec<T>,
    /// The same at j·stride + k: the second factor.
    coefficients: Vec<T>,
    /// Components that it is applied to, and whether as two factors.
    components: usize,
    is_factored: bool,
    /// c_i.
    nodes: Vec<T>,
    /// (2k+1)/(k+1) and k/(k+1), of the recurrence of Legendre polynomials, k = 0 … s − 1.
    recurrence: Vec<[T; 2]>,
    /// Room for L_0 … L_s at the start of the step, and at a group of nodes.
    at_start: Vec<T>,
    at_node: Vec<T>,
    /// Where the step starts in the last one, its size over that, the size of that, and whether the gradient
    /// at the start is known.
    made_for: Option<([T; 3], bool)>,
}

impl<T: Float> Polynomial<T> {
    /// For so many components.
    pub fn new(gauss: &Gauss<T>, components: usize) -> Self {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let mut nodes = vec![T::int(0); stride];
        nodes[..s].copy_from_slice(gauss.nodes());
        let mut legendre = vec![T::int(0); s * stride];
        let mut coefficients = vec![T::int(0); stride * stride];
        for k in 0..s {
            let norm = T::int(2 * k as i64 + 1).sqrt();
            for (j, &p) in gauss.legendre(k).iter().enumerate() {
                legendre[k * stride + j] = norm * p;
                coefficients[j * stride + k] = norm * p;
            }
        }
        let recurrence = |k: i64| [T::ratio(2 * k + 1, k + 1), T::ratio(k, k + 1)];
        Polynomial {
            e: vec![T::int(0); stride * stride],
            rho: vec![T::int(0); stride],
            legendre,
            coefficients,
            components,
            is_factored: false,
            nodes,
            recurrence: (0..s as i64).map(recurrence).collect(),
            at_start: vec![T::int(0); s + 1],
            at_node: vec![T::int(0); (s + 1) * stride],
            made_for: None,
        }
    }

    /// As it is applied to L.
    pub(crate) fn view(&self) -> View<'_, T> {
        View {
            e: &self.e,
            coefficients: self.is_factored.then_some(&self.coefficients),
            rho: &self.rho,
        }
    }

    /// For a step that starts at `start` in the last one of size `h`, `ratio` times as long.
    pub(crate) fn make(&mut self, set: InstructionSet, [start, ratio, h]: [T; 3], known: bool) {
        let made_for = Some(([start, ratio, h], known));
        if self.made_for != made_for {
            self.made_for = made_for;
            let s = self.recurrence.len();
            self.is_factored = ratio != T::int(1) && self.components < s;
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

/// E, or its factors, and ρ.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, T> {
    e: &'a [T],
    coefficients: Option<&'a [T]>,
    rho: &'a [T],
}

impl<'a, T: Float> View<'a, T> {
    /// E L + ρ ∇H(y0), from the L of a component.
    #[inline(always)]
    pub(crate) fn foretell<const G: usize, const N: usize>(
        &self,
        l: &Row<T, G, N>,
        s: usize,
        sign: T,
        at_start: T,
    ) -> Row<T, G, N> {
        let guess = match self.coefficients {
            Some(coefficients) => applied(self.e, in_memory(&mut applied(coefficients, l, s)), s),
            None => applied(self.e, l, s),
        };
        let rho: &Row<T, G, N> = literal(rows(self.rho).first());
        let mut gradients = guess;
        for g in 0..G {
            gradients[g] = foretold(&guess[g], &rho[g], sign, at_start);
        }
        gradients
    }

    /// The same of the group g of stages, L standing in any number of groups.
    #[inline(always)]
    pub(crate) fn foretell_group<const N: usize>(
        &self,
        l: &[[T; N]],
        (g, s): (usize, usize),
        sign: T,
        at_start: T,
    ) -> [T; N] {
        let guess = product_any(self.e.as_chunks::<N>().0, l, g, s);
        foretold(&guess, &self.rho.as_chunks::<N>().0[g], sign, at_start)
    }

    /// E, where it is not factored, and ρ of a single group of stages: what is written elsewhere cannot
    /// change copies.
    #[inline(always)]
    pub(crate) fn copied<const N: usize>(&self) -> Option<([[T; N]; N], [T; N])> {
        let e = self.e.as_chunks().0.first_chunk()?;
        let rho = self.rho.first_chunk()?;
        self.coefficients.is_none().then_some((*e, *rho))
    }

    /// What E, or its first factor, is applied to: L, or its Legendre coefficients in `room`.
    #[inline(always)]
    pub(crate) fn prepared<'b, const N: usize>(
        &self,
        l: &'b [[T; N]],
        room: &'b mut [[T; N]],
        s: usize,
    ) -> &'b [[T; N]] {
        let Some(coefficients) = self.coefficients else {
            return l;
        };
        for (g, to) in room.iter_mut().enumerate() {
            *to = product_any(coefficients.as_chunks::<N>().0, l, g, s);
        }
        room
    }
}

/// ± E L + ρ ∇H(y0).
#[inline(always)]
pub(crate) fn foretold<T: Float, const N: usize>(
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
        if T::IS_DOUBLE {
            match lanes_of::<T>(self.to.recurrence.len()) {
                4 => self.lanes::<4, 4>(),
                _ => self.lanes::<8, 4>(),
            }
        } else if const { T::WIDTH == 1 } {
            self.lanes::<1, 1>();
        } else {
            self.lanes::<8, 4>();
        }
    }
}

impl<T: Float> Make<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize, const B: usize>(&mut self) {
        let to = &mut *self.to;
        let s = to.recurrence.len();
        let at_start = to.at_start.as_chunks_mut::<1>().0;
        classical(&to.recurrence, [self.start], at_start);
        let at_node = &mut to.at_node.as_chunks_mut::<N>().0[..=s];
        let scale = T::int(-1) / self.h;
        let groups = groups_of::<T, N>(s);
        let e = to.e.as_chunks_mut::<N>().0;
        let rho = to.rho.as_chunks_mut::<N>().0;
        for (g, nodes) in to.nodes.as_chunks::<N>().0.iter().enumerate() {
            let tau = std::array::from_fn(|i| self.start + self.ratio * nodes[i]);
            classical(&to.recurrence, tau, at_node);
            if self.known {
                rho[g] = at_node[s].map(|p| p / at_start[s][0]);
            } else {
                rho[g] = [T::int(0); N];
            }
            for (p, a) in at_node.iter_mut().zip(&*at_start).take(s) {
                for i in 0..N {
                    p[i] = scale * (p[i] - rho[g][i] * a[0]);
                }
            }
            if to.is_factored {
                for (k, p) in at_node.iter().enumerate().take(s) {
                    e[k * groups + g] = *p;
                }
                continue;
            }
            let rows = to.legendre.chunks_exact(groups * N);
            for block in (0..groups * N).step_by(B) {
                let mut sums = [[T::int(0); N]; B];
                for (p, row) in at_node.iter().zip(rows.clone()) {
                    let Some(row) = row[block..].first_chunk::<B>() else {
                        continue;
                    };
                    for b in 0..B {
                        sums[b] = fused(p, row[b], &sums[b]);
                    }
                }
                for (b, sum) in sums.into_iter().enumerate() {
                    e[(block + b) * groups + g] = sum;
                }
            }
        }
    }
}

/// The classical Legendre polynomials L_0 … L_s at 2τ − 1: P_k = √(2k+1) L_k.
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

    /// Polynomials of degree s, given by their values at the old nodes and at the start, are foretold
    /// exactly.
    fn polynomials_are_foretold<T: Float>(most: f64) {
        for s in 2..=16 {
            let gauss = Gauss::<T>::new(s).unwrap_or_else(|e| panic!("{e}"));
            for set in InstructionSet::available() {
                for components in [1, s] {
                    let mut made = Polynomial::new(&gauss, components);
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
                        4 => foretold::<T, 4>(&made, l.as_flattened(), s, power(start)),
                        8 => foretold::<T, 8>(&made, l.as_flattened(), s, power(start)),
                        _ => foretold::<T, 1>(&made, l.as_flattened(), s, power(start)),
                    };
                    for (&found, &c) in found.iter().zip(gauss.nodes()) {
                        let error = (found - power(start + ratio * c)).abs().to_f64();
                        assert!(error <= most * 6f64.powi(s as i32), "s = {s}: {error}");
                    }
                }
            }
        }
    }

    fn foretold<T: Float, const N: usize>(
        made: &Polynomial<T>,
        l: &[T],
        s: usize,
        at_start: T,
    ) -> Vec<T> {
        let (view, l) = (made.view(), l.as_chunks::<N>().0);
        let mut room = vec![[T::int(0); N]; l.len()];
        let prepared = view.prepared(l, &mut room, s);
        (0..l.len())
            .flat_map(|g| view.foretell_group(prepared, (g, s), T::int(1), at_start))
            .collect()
    }

    #[test]
    fn polynomials_of_the_degree_are_foretold_exactly() {
        polynomials_are_foretold::<f64>(1e-15);
        polynomials_are_foretold::<DoubleDouble>(1e-30);
    }
}
