//! The sweep of a small system as one kernel: ∇H, L and Z ← K L with all lengths literal and everything in registers.
//!
//! The same operations in the same order as in [`crate::mix`], bit for bit. What bounds a sweep is the chain of dependent operations, which is
//! walked through for all components side by side: ∇U, then P ← p + K L_p, then Z_q ← K L_q.

use crate::mix::{Half, Moved, Whole, placed, product};
use equip_autodiff::{Fused, Slopes};
use equip_scalar::Lanes;
use std::array::from_fn;

/// C rows of N lanes.
type Rows<const C: usize, const N: usize> = [[f64; N]; C];

impl<const N: usize> Fused<N> for Half<'_, f64> {
    type Output = f64;

    #[inline(always)]
    fn run<const M: usize>(&mut self, forces: &impl Slopes<M, N>) -> f64 {
        let step = &mut self.step;
        let (k, hb) = (square(step.k), row::<N>(step.hb));
        let (hi, lo) = (step.hi, step.lo);
        let (hi, lo) = (
            (row::<M>(hi), row::<M>(&hi[M..])),
            (row::<M>(lo), row::<M>(&lo[M..])),
        );
        let (w, b) = (row::<M>(self.inverse_masses), row::<M>(self.offset));
        let (l_q, l_p) = step.l.split_at_mut(M * N);
        let (l_q, l_p): (&mut Rows<M, N>, &mut Rows<M, N>) = (rows_mut(l_q), rows_mut(l_p));
        let (q, p) = step.points.split_at_mut(M * N);
        let (q, p): (&mut Rows<M, N>, &mut Rows<M, N>) = (rows_mut(q), rows_mut(p));
        let (z, gradients) = (rows_mut::<M, N>(step.z), rows_mut::<M, N>(step.gradients));
        let inverse_scale = row::<M>(step.inverse_scale);

        let slopes = forces.at(&from_fn(|c| Lanes(q[c])));
        for c in 0..M {
            gradients[c] = slopes[c].0;
            l_p[c] = from_fn(|i| -(hb[i] * slopes[c].0[i]));
        }
        for c in 0..M {
            p[c] = placed(hi.1[c], lo.1[c], &product(k, &l_p[c]));
            l_q[c] = from_fn(|i| hb[i] * (w[c] * p[c][i] + b[c]));
        }
        let before = *z;
        for c in 0..M {
            z[c] = product(k, &l_q[c]);
            q[c] = placed(hi.0[c], lo.0[c], &z[c]);
        }
        change(z, &before, inverse_scale)
    }
}

impl<const N: usize> Fused<N> for Whole<'_, f64> {
    type Output = f64;

    #[inline(always)]
    fn run<const C: usize>(&mut self, gradients: &impl Slopes<C, N>) -> f64 {
        let step = &mut self.0;
        let (k, hb) = (square(step.k), row::<N>(step.hb));
        let (hi, lo) = (row::<C>(step.hi), row::<C>(step.lo));
        let (l, z, points) = (
            rows_mut::<C, N>(step.l),
            rows_mut::<C, N>(step.z),
            rows_mut::<C, N>(step.points),
        );
        let kept = rows_mut::<C, N>(step.gradients);
        let inverse_scale = row::<C>(step.inverse_scale);

        let slopes = gradients.at(&from_fn(|c| Lanes(points[c])));
        for c in 0..C / 2 {
            let (dq, dp) = (slopes[c].0, slopes[c + C / 2].0);
            (kept[c], kept[c + C / 2]) = (dq, dp);
            l[c] = from_fn(|i| hb[i] * dp[i]);
            l[c + C / 2] = from_fn(|i| -(hb[i] * dq[i]));
        }
        let before = *z;
        for c in 0..C {
            z[c] = product(k, &l[c]);
            points[c] = placed(hi[c], lo[c], &z[c]);
        }
        change(z, &before, inverse_scale)
    }
}

/// Apart from the products: sums that go on from component to component would spoil their vectors.
#[inline(always)]
fn change<const C: usize, const N: usize>(
    z: &Rows<C, N>,
    before: &Rows<C, N>,
    inverse_scale: &[f64; C],
) -> f64 {
    let mut moved = Moved::new();
    for c in 0..C {
        moved.see(&z[c], &before[c], inverse_scale[c]);
    }
    moved.reduce()
}

/// K with N columns of N places.
#[inline(always)]
fn square<const N: usize>(k: &[f64]) -> &Rows<N, N> {
    literal(k.as_chunks().0.first_chunk())
}

#[inline(always)]
fn row<const N: usize>(x: &[f64]) -> &[f64; N] {
    literal(x.first_chunk())
}

#[inline(always)]
fn rows_mut<const C: usize, const N: usize>(x: &mut [f64]) -> &mut Rows<C, N> {
    literal(x.as_chunks_mut().0.first_chunk_mut())
}

/// # Panics
/// If what is there is shorter than its literal length.
#[inline(always)]
fn literal<R>(found: Option<R>) -> R {
    match found {
        Some(found) => found,
        None => panic!("a sweep by literal lengths is for one group of stages"),
    }
}
