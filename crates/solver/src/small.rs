//! The sweep of a small system as one kernel: ∇H, L and Z ← K L with all lengths literal and everything in registers.
//!
//! The same operations in the same order as in [`crate::mix`], bit for bit. What bounds a sweep is the chain of dependent operations, which is
//! walked through for all components side by side: ∇U, then P ← p + K L_p, then Z_q ← K L_q.

use crate::mix::{Half, Whole, placed, product};
use crate::pairs::{self, HALF};
use equip_autodiff::{Fused, Slopes};
use equip_scalar::Lanes;
use std::array::from_fn;

/// C components, each of G groups of N lanes.
type Rows<const C: usize, const G: usize, const N: usize> = [[[f64; N]; G]; C];

/// K L for one component, in two parts: what is read number by number is best read from memory, where the first part puts it.
pub(crate) trait Mixes<const G: usize, const N: usize> {
    fn folded(&self, l: &[[f64; N]; G]) -> [[f64; N]; G];
    fn product(&self, folded: &[[f64; N]; G]) -> [[f64; N]; G];
}

/// K as it is, for one group of stages.
pub(crate) struct Square<'a, const N: usize>(pub(crate) &'a [[f64; N]; N]);

impl<const N: usize> Mixes<1, N> for Square<'_, N> {
    #[inline(always)]
    fn folded(&self, l: &[[f64; N]; 1]) -> [[f64; N]; 1] {
        *l
    }

    #[inline(always)]
    fn product(&self, l: &[[f64; N]; 1]) -> [[f64; N]; 1] {
        [product(self.0, &l[0])]
    }
}

/// K as P and Q, for two groups.
pub(crate) struct Blocks<'a>(pub(crate) &'a [[[f64; HALF]; HALF]; 2]);

impl Mixes<2, HALF> for Blocks<'_> {
    #[inline(always)]
    fn folded(&self, l: &[[f64; HALF]; 2]) -> [[f64; HALF]; 2] {
        pairs::folded(l)
    }

    #[inline(always)]
    fn product(&self, folded: &[[f64; HALF]; 2]) -> [[f64; HALF]; 2] {
        pairs::product(self.0, folded)
    }
}

/// Sixteen stages: two groups, by pairs.
pub(crate) struct ByPairs<K>(pub(crate) K);

impl<const N: usize> Fused<N> for Half<'_, f64> {
    type Output = f64;

    #[inline(always)]
    fn run<const M: usize>(&mut self, forces: &impl Slopes<M, N>) -> f64 {
        let k = Square(literal(self.step.k.as_chunks().0.first_chunk()));
        half(self, forces, &k)
    }
}

impl Fused<HALF> for ByPairs<Half<'_, f64>> {
    type Output = f64;

    #[inline(always)]
    fn run<const M: usize>(&mut self, forces: &impl Slopes<M, HALF>) -> f64 {
        let k = Blocks(pairs::blocks(self.0.step.k));
        half(&mut self.0, forces, &k)
    }
}

impl<const N: usize> Fused<N> for Whole<'_, f64> {
    type Output = f64;

    #[inline(always)]
    fn run<const C: usize>(&mut self, gradients: &impl Slopes<C, N>) -> f64 {
        let k = Square(literal(self.0.k.as_chunks().0.first_chunk()));
        whole(self, gradients, &k)
    }
}

impl Fused<HALF> for ByPairs<Whole<'_, f64>> {
    type Output = f64;

    #[inline(always)]
    fn run<const C: usize>(&mut self, gradients: &impl Slopes<C, HALF>) -> f64 {
        let k = Blocks(pairs::blocks(self.0.0.k));
        whole(&mut self.0, gradients, &k)
    }
}

/// M positions as the unknowns.
#[inline(always)]
fn half<const M: usize, const G: usize, const N: usize>(
    task: &mut Half<'_, f64>,
    forces: &impl Slopes<M, N>,
    k: &impl Mixes<G, N>,
) -> f64 {
    let q = rows::<M, G, N>(task.step.points);
    let mut slopes = [[Lanes::splat(0.0); M]; G];
    for g in 0..G {
        slopes[g] = forces.at(&from_fn(|c| Lanes(q[c][g])));
    }
    half_from(task, &slopes, k)
}

/// The same from ∇U on.
#[inline(always)]
pub(crate) fn half_from<const M: usize, const G: usize, const N: usize>(
    task: &mut Half<'_, f64>,
    slopes: &[[Lanes<N>; M]; G],
    k: &impl Mixes<G, N>,
) -> f64 {
    let step = &mut task.step;
    let hb: &[[f64; N]; G] = literal(step.hb.as_chunks().0.first_chunk());
    let (hi, lo) = (halves::<M>(step.hi), halves::<M>(step.lo));
    let (w, b) = (row::<M>(task.inverse_masses), row::<M>(task.offset));
    let (l_q, l_p) = step.l.split_at_mut(M * G * N);
    let (l_q, l_p) = (rows::<M, G, N>(l_q), rows::<M, G, N>(l_p));
    let (q, p) = step.points.split_at_mut(M * G * N);
    let (q, p) = (rows::<M, G, N>(q), rows::<M, G, N>(p));
    let (z, gradients) = (rows::<M, G, N>(step.z), rows::<M, G, N>(step.gradients));
    let folded = rows::<M, G, N>(step.folded);
    let inverse_scale = row::<M>(step.inverse_scale);

    for c in 0..M {
        let l: [[f64; N]; G] = from_fn(|g| from_fn(|i| -(hb[g][i] * slopes[g][c].0[i])));
        folded[c] = k.folded(&l);
        l_p[c] = l;
        gradients[c] = from_fn(|g| slopes[g][c].0);
    }
    for c in 0..M {
        let moved = k.product(&folded[c]);
        let momenta: [[f64; N]; G] = from_fn(|g| placed(hi[1][c], lo[1][c], &moved[g]));
        let l: [[f64; N]; G] = from_fn(|g| from_fn(|i| hb[g][i] * (w[c] * momenta[g][i] + b[c])));
        folded[c] = k.folded(&l);
        l_q[c] = l;
        p[c] = momenta;
    }
    let before = *z;
    for c in 0..M {
        let moved = k.product(&folded[c]);
        q[c] = from_fn(|g| placed(hi[0][c], lo[0][c], &moved[g]));
        z[c] = moved;
    }
    change(z, &before, inverse_scale)
}

/// All C components as unknowns.
#[inline(always)]
fn whole<const C: usize, const G: usize, const N: usize>(
    task: &mut Whole<'_, f64>,
    gradients: &impl Slopes<C, N>,
    k: &impl Mixes<G, N>,
) -> f64 {
    let points = rows::<C, G, N>(task.0.points);
    let mut slopes = [[Lanes::splat(0.0); C]; G];
    for g in 0..G {
        slopes[g] = gradients.at(&from_fn(|c| Lanes(points[c][g])));
    }
    whole_from(task, &slopes, k)
}

/// The same from ∇H on.
#[inline(always)]
pub(crate) fn whole_from<const C: usize, const G: usize, const N: usize>(
    task: &mut Whole<'_, f64>,
    slopes: &[[Lanes<N>; C]; G],
    k: &impl Mixes<G, N>,
) -> f64 {
    let step = &mut task.0;
    let hb: &[[f64; N]; G] = literal(step.hb.as_chunks().0.first_chunk());
    let (hi, lo) = (row::<C>(step.hi), row::<C>(step.lo));
    let (l, z) = (rows::<C, G, N>(step.l), rows::<C, G, N>(step.z));
    let (points, kept) = (
        rows::<C, G, N>(step.points),
        rows::<C, G, N>(step.gradients),
    );
    let folded = rows::<C, G, N>(step.folded);
    let inverse_scale = row::<C>(step.inverse_scale);

    for c in 0..C {
        let from = (c + C / 2) % C;
        let mut row: [[f64; N]; G] = from_fn(|g| from_fn(|i| hb[g][i] * slopes[g][from].0[i]));
        if c >= C / 2 {
            row = from_fn(|g| from_fn(|i| -row[g][i]));
        }
        folded[c] = k.folded(&row);
        l[c] = row;
        kept[c] = from_fn(|g| slopes[g][c].0);
    }
    let before = *z;
    for c in 0..C {
        let moved = k.product(&folded[c]);
        points[c] = from_fn(|g| placed(hi[c], lo[c], &moved[g]));
        z[c] = moved;
    }
    change(z, &before, inverse_scale)
}

/// The largest change of Z relative to the sizes of the components, as an integer: of numbers that are not negative the larger has the
/// larger bits, and what is not a number the largest. A maximum of integers is the same in any order, so the compiler may take vectors.
#[inline(always)]
fn change<const C: usize, const G: usize, const N: usize>(
    z: &Rows<C, G, N>,
    before: &Rows<C, G, N>,
    inverse_scale: &[f64; C],
) -> f64 {
    let mut most = 0;
    for c in 0..C {
        for g in 0..G {
            for i in 0..N {
                let moved = (z[c][g][i] - before[c][g][i]) * inverse_scale[c];
                most = most.max(moved.abs().to_bits());
            }
        }
    }
    let most = f64::from_bits(most);
    if most.is_finite() { most } else { f64::NAN }
}

#[inline(always)]
pub(crate) fn row<const C: usize>(x: &[f64]) -> &[f64; C] {
    literal(x.first_chunk())
}

/// Those of the positions and those of the momenta.
#[inline(always)]
fn halves<const M: usize>(x: &[f64]) -> [&[f64; M]; 2] {
    [row(x), row(&x[M..])]
}

#[inline(always)]
pub(crate) fn rows<const C: usize, const G: usize, const N: usize>(
    x: &mut [f64],
) -> &mut Rows<C, G, N> {
    literal(x.as_chunks_mut().0.as_chunks_mut().0.first_chunk_mut())
}

/// # Panics
/// If what is there is shorter than its literal length.
#[inline(always)]
pub(crate) fn literal<R>(found: Option<R>) -> R {
    match found {
        Some(found) => found,
        None => panic!(
            "a sweep by literal lengths has as many components and stages as it was made for"
        ),
    }
}
