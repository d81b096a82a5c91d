//! E and ρ of [`crate::start`]: what the polynomial through the gradients of the last step, and the one at its end, is at the nodes of this.
//!
//! $$ E_{ij} = -\frac1h \sum_{k<s} \bigl(P_k(\tau_i) - \rho_i P_k(a)\bigr) P_k(c_j), \qquad \rho_i = P_s(\tau_i)/P_s(a), \quad \tau_i = a + r c_i . $$
//!
//! Made anew whenever the ratio r of the steps changes, with variable steps at every step: the nodes stand side by side in vectors.
//!
//! Cost: s³ multiplications.

use crate::MAX_STAGES;
use crate::row::{add, groups_of, lanes_of, scaled, stride_for};
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Gauss;

/// E and ρ, column by column.
#[derive(Debug)]
pub(crate) struct Prolongation<T> {
    pub(crate) e: Vec<T>,
    pub(crate) rho: Vec<T>,
    /// √(2k+1) P_k(c_j) at k·stride + j.
    legendre: Vec<T>,
    /// c_i.
    nodes: Vec<T>,
    /// (2k+1)/(k+1) and k/(k+1), of the recurrence of Legendre polynomials, k = 0 … s − 1.
    recurrence: Vec<[T; 2]>,
    /// Where the step starts in the last one, its size over that, the size of that, and whether the gradient at the start is known.
    made_for: Option<([T; 3], bool)>,
}

impl<T: Float> Prolongation<T> {
    pub(crate) fn new(gauss: &Gauss<T>) -> Self {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let mut nodes = vec![T::int(0); stride];
        nodes[..s].copy_from_slice(gauss.nodes());
        let mut legendre = vec![T::int(0); s * stride];
        for k in 0..s {
            let norm = T::int(2 * k as i64 + 1).sqrt();
            for (to, &p) in legendre[k * stride..].iter_mut().zip(gauss.legendre(k)) {
                *to = norm * p;
            }
        }
        let recurrence = |k: i64| [T::ratio(2 * k + 1, k + 1), T::ratio(k, k + 1)];
        Prolongation {
            e: vec![T::int(0); stride * stride],
            rho: vec![T::int(0); stride],
            legendre,
            nodes,
            recurrence: (0..s as i64).map(recurrence).collect(),
            made_for: None,
        }
    }

    /// For a step that starts at `start` in the last one of size `h`, `ratio` times as long.
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

struct Make<'a, T> {
    to: &'a mut Prolongation<T>,
    start: T,
    ratio: T,
    h: T,
    known: bool,
}

impl<T: Float> Kernel for Make<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        match lanes_of::<T>(self.to.recurrence.len()) {
            4 => self.lanes::<4, 4>(),
            8 => self.lanes::<8, 4>(),
            _ => self.lanes::<1, 1>(),
        }
    }
}

impl<T: Float> Make<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize, const B: usize>(&mut self) {
        let to = &mut *self.to;
        let s = to.recurrence.len();
        let mut at_start = [[T::int(0); 1]; MAX_STAGES + 1];
        classical(&to.recurrence, [self.start], &mut at_start);
        let scale = T::int(-1) / self.h;
        let groups = groups_of::<T, N>(s);
        let e = to.e.as_chunks_mut::<N>().0;
        let rho = to.rho.as_chunks_mut::<N>().0;
        for (g, nodes) in to.nodes.as_chunks::<N>().0.iter().enumerate() {
            let mut at_node = [[T::int(0); N]; MAX_STAGES + 1];
            let tau = std::array::from_fn(|i| self.start + self.ratio * nodes[i]);
            classical(&to.recurrence, tau, &mut at_node);
            if self.known {
                rho[g] = at_node[s].map(|p| p / at_start[s][0]);
            } else {
                rho[g] = [T::int(0); N];
            }
            for (p, a) in at_node.iter_mut().zip(&at_start).take(s) {
                for i in 0..N {
                    p[i] = scale * (p[i] - rho[g][i] * a[0]);
                }
            }
            let rows = to.legendre.chunks_exact(groups * N);
            for block in (0..groups * N).step_by(B) {
                let mut sums = [[T::int(0); N]; B];
                for (p, row) in at_node.iter().zip(rows.clone()) {
                    let Some(row) = row[block..].first_chunk::<B>() else {
                        continue;
                    };
                    for b in 0..B {
                        add(&mut sums[b], &scaled(p, row[b]));
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
fn classical<T: Float, const N: usize>(
    recurrence: &[[T; 2]],
    tau: [T; N],
    out: &mut [[T; N]; MAX_STAGES + 1],
) {
    let x = tau.map(|tau| (tau + tau) - T::int(1));
    (out[0], out[1]) = ([T::int(1); N], x);
    for (k, &[ahead, back]) in recurrence.iter().enumerate().skip(1) {
        out[k + 1] = std::array::from_fn(|i| ahead * x[i] * out[k][i] - back * out[k - 1][i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::DoubleDouble;

    /// Polynomials of degree s, given by their values at the old nodes and at the start, are foretold exactly.
    fn polynomials_are_foretold<T: Float>(most: f64) {
        for s in 2..=16 {
            let gauss = Gauss::<T>::new(s).unwrap_or_else(|e| panic!("{e}"));
            for set in InstructionSet::available() {
                let mut made = Prolongation::new(&gauss);
                let (start, ratio, h) = (T::int(1), T::ratio(3, 4), T::ratio(1, 8));
                made.make(set, [start, ratio, h], true);
                let power =
                    |x: T| (0..s).fold(T::int(1), |product, _| product * (x - T::ratio(3, 4)));
                let stride = stride_for::<T>(s);
                for (i, &c) in gauss.nodes().iter().enumerate() {
                    let terms = gauss.nodes().iter().zip(gauss.weights()).enumerate();
                    let sum = terms.fold(T::int(0), |sum, (j, (&c, &b))| {
                        sum - made.e[j * stride + i] * h * b * power(c)
                    });
                    let found = sum + made.rho[i] * power(start);
                    let error = (found - power(start + ratio * c)).abs().to_f64();
                    assert!(error <= most * 6f64.powi(s as i32), "s = {s}: {error}");
                }
            }
        }
    }

    #[test]
    fn polynomials_of_the_degree_are_foretold_exactly() {
        polynomials_are_foretold::<f64>(1e-15);
        polynomials_are_foretold::<DoubleDouble>(1e-30);
    }
}
