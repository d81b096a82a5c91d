//! The Gauss–Legendre rule on [0, 1]: nodes, weights, and the Legendre polynomials at the nodes.
//!
//! Newton's method on L_s runs in the target float type from an initial guess in `f64`. Its variable is t =
//! 2(1 − c), twice the distance to the end of the interval:
//!
//! $$t \leftarrow t + \frac{L_s}{L_s'}, \qquad L_s' = \frac{s\,(L_{s-1} - x L_s)}{t\,(2-t)}, \qquad x = 1 - t.$$
//!
//! One half of the nodes is computed, the other half is its mirror image. Cost: O(s²) operations.

use crate::error::TableauError;
use crate::legendre::{Classical, alternate, next, norm};
use equip_scalar::Float;

/// The largest number of stages and of quadrature nodes.
pub const MAX_STAGES: usize = 32;

/// The maximum number of Newton steps. An `f64` result takes four; every doubling of the digits takes one or
/// two more.
const MAX_NEWTON: usize = 20;

/// s nodes and weights, and P_0 … P_{n−1} at the nodes.
#[derive(Debug, Clone)]
pub(crate) struct Rule<T> {
    pub(crate) nodes: Vec<T>,
    pub(crate) weights: Vec<T>,
    /// n rows of s values; row k is p_k.
    pub(crate) legendre: Vec<T>,
}

impl<T: Float> Rule<T> {
    /// The rule with s ≥ 1 nodes and n ≤ s polynomials.
    pub(crate) fn new(s: usize, n: usize) -> Self {
        let zero = T::int(0);
        let mut rule = Rule {
            nodes: vec![zero; s],
            weights: vec![zero; s],
            legendre: vec![zero; n * s],
        };
        for (i, t) in distances(s).into_iter().enumerate() {
            rule.mirrored_pair(i, t, n);
        }
        rule
    }

    /// k ≥ 2 equidistant nodes from 0 to 1 with the weights of the closed Newton–Cotes rule, and P_0 at the
    /// nodes. The weight b_i is the integral of the Lagrange polynomial of node i.
    pub(crate) fn newton_cotes(k: usize) -> Self {
        let nodes: Vec<T> = (0..k).map(|i| T::ratio(i as i64, k as i64 - 1)).collect();
        let exact = Rule::<T>::new(k.div_ceil(2), 0);
        let mut weights = vec![T::int(0); k];
        for (&x, &w) in exact.nodes.iter().zip(&exact.weights) {
            for i in 0..k.div_ceil(2) {
                let others = nodes.iter().enumerate().filter(|&(j, _)| j != i);
                let lagrange = others.fold(T::int(1), |product, (_, &c)| {
                    product * (x - c) / (nodes[i] - c)
                });
                weights[i] += w * lagrange;
            }
        }
        for i in 0..k / 2 {
            weights[k - 1 - i] = weights[i];
        }
        Rule {
            legendre: vec![T::int(1); k],
            nodes,
            weights,
        }
    }

    /// Sets the nodes c_i and 1 − c_i. The latter has distance t/2 from 1.
    fn mirrored_pair(&mut self, i: usize, t: T, n: usize) {
        let (one, two) = (T::int(1), T::int(2));
        let s = self.nodes.len();
        let mirror = s - 1 - i;

        // 1 − c is exact for ½ ≤ c ≤ 1, so the two nodes add up to exactly 1.
        self.nodes[mirror] = one - t / two;
        self.nodes[i] = one - self.nodes[mirror];

        let mut norm_squared = T::int(0);
        for (k, (value, _)) in Classical::new(t).take(s).enumerate() {
            let value = if i == mirror && k % 2 == 1 {
                T::int(0)
            } else {
                value
            };
            norm_squared += T::int(2 * k as i64 + 1) * value * value;
            if k < n {
                let p = norm::<T>(k) * value;
                self.legendre[k * s + mirror] = p;
                self.legendre[k * s + i] = alternate(true, k, p);
            }
        }
        self.weights[i] = one / norm_squared;
        self.weights[mirror] = self.weights[i];
    }
}

/// t = 2c for the nodes in the left half up to the middle one, with full relative accuracy. The Newton steps
/// of all nodes run in parallel, since each is a chain of s dependent divisions.
fn distances<T: Float>(s: usize) -> Vec<T> {
    let (one, two, order) = (T::int(1), T::int(2), T::int(s as i64));
    let mut t: Vec<T> = (0..s / 2).map(|i| T::exact(start(s, i))).collect();
    let mut last = vec![Some(T::INFINITY); t.len()];
    let (mut before, mut value) = (t.clone(), t.clone());
    for _ in 0..MAX_NEWTON {
        last_two(s, &t, &mut before, &mut value);
        let values = before.iter().zip(&value);
        for ((t, last), (&before, &value)) in t.iter_mut().zip(&mut last).zip(values) {
            let Some(before_this) = *last else {
                continue;
            };
            let delta = value * *t * (two - *t) / (order * (before - (one - *t) * value));
            *t += delta;
            // A step that is not less than half the previous one is rounding noise.
            *last = (two * delta.abs() < before_this).then_some(delta.abs());
        }
        if last.iter().all(Option::is_none) {
            break;
        }
    }
    if s % 2 == 1 {
        t.push(one);
    }
    t
}

/// L_{s−1} and L_s at each 1 − t.
fn last_two<T: Float>(s: usize, t: &[T], before: &mut [T], value: &mut [T]) {
    let mut step = vec![T::int(0); t.len()];
    value.fill(T::int(1));
    for k in 0..s as i64 {
        before.copy_from_slice(value);
        for ((value, step), &t) in value.iter_mut().zip(&mut step).zip(t) {
            next(k, t, value, step);
        }
    }
}

/// 1 − cos θ with θ = π (4i + 3)/(4s + 2): the leading term of the asymptotic expansion of the zeros (Szegő,
/// 6.21.5).
fn start(s: usize, i: usize) -> f64 {
    let theta = std::f64::consts::PI * (4 * i + 3) as f64 / (4 * s + 2) as f64;
    2.0 * (0.5 * theta).sin().powi(2)
}

/// Returns an error if `stages` is outside the supported range.
pub(crate) fn check_stages(stages: usize) -> Result<(), TableauError> {
    if (1..=MAX_STAGES).contains(&stages) {
        Ok(())
    } else {
        Err(TableauError::StagesOutOfRange {
            stages,
            min: 1,
            max: MAX_STAGES,
        })
    }
}
