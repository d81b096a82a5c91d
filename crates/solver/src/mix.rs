//! The linear half of a sweep, from the gradients to the next stages, compiled for every instruction set.
//!
//! Lanes are the stages: all loops run over arrays of 4 or 8 places, which the compiler turns into vector instructions of whatever
//! set it is compiled for; floats that are no vector elements go stage by stage. Sums have one order, so the bits are the same on every set.
//! Up to 16 stages of doubles go through [`crate::rows`].
//!
//! Cost: s² products for each component that K is applied to.

use crate::pairs::{Blocks, has_pairs};
use crate::rows::{Columns, Square};
use crate::start::largest;
use equip_scalar::{Float, Kernel};

/// Lanes that `s` stages of this float are padded to.
pub(crate) fn stride_for<T: Float>(s: usize) -> usize {
    match T::as_doubles(&[]) {
        None => s,
        Some(_) if s <= 4 => 4,
        Some(_) => s.next_multiple_of(8),
    }
}

/// Lanes that are worked on together.
#[inline(always)]
pub(crate) fn lanes_of<T: Float>(s: usize) -> usize {
    match T::as_doubles(&[]) {
        None => 1,
        Some(_) if s <= 4 => 4,
        Some(_) => 8,
    }
}

/// Groups that `s` stages stand in.
#[inline(always)]
fn groups_of_lanes<T: Float>(s: usize) -> usize {
    stride_for::<T>(s) / lanes_of::<T>(s)
}

/// Groups of N lanes that `s` stages stand in.
#[inline(always)]
pub(crate) fn groups_of<T: Float, const N: usize>(s: usize) -> usize {
    stride_for::<T>(s) / N
}

/// What both forms need: the method, the start of the step, and where things go. Component c of stage i stands at `c·stride + i`.
pub(crate) struct Step<'a, T> {
    /// K(α), column by column; or P and Q of [`crate::pairs`].
    pub(crate) k: &'a [T],
    /// h b_i.
    pub(crate) hb: &'a [T],
    /// y0, all components.
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    /// 1 over the sizes of the components.
    pub(crate) inverse_scale: &'a [T],
    pub(crate) gradients: &'a mut [T],
    pub(crate) l: &'a mut [T],
    /// What the products read, if it is not L: room for as much.
    pub(crate) folded: &'a mut [T],
    pub(crate) z: &'a mut [T],
    pub(crate) points: &'a mut [T],
    pub(crate) s: usize,
}

/// Z ← K L with L = h b J∇H, all components. Gives the largest change of Z relative to the sizes of the components; not finite if
/// anything is not.
pub(crate) struct Whole<'a, T>(pub(crate) Step<'a, T>);

/// L_p = −h b ∇U, P = p + K L_p, L_q = h b (M⁻¹ P + b), Z_q ← K L_q, with a diagonal M⁻¹. Gives the change of Z_q.
pub(crate) struct Half<'a, T> {
    pub(crate) step: Step<'a, T>,
    pub(crate) inverse_masses: &'a [T],
    pub(crate) offset: &'a [T],
}

impl<T: Float> Kernel for Whole<'_, T> {
    type Output = T;

    #[inline(always)]
    fn run(&mut self) -> T {
        let (k, s) = (self.0.k, self.0.s);
        if has_pairs::<T>(s) {
            return self.by_rows(&Blocks::of(k));
        }
        match (groups_of_lanes::<T>(s), lanes_of::<T>(s)) {
            (1, 4) => self.by_rows(&Square::<T, 4>::of(k)),
            (1, 8) => self.by_rows(&Square::<T, 8>::of(k)),
            (2, 8) => self.by_rows(&Columns::<T, 2, 8>::of(k, s)),
            (_, 8) => self.lanes::<8>(),
            _ => self.lanes::<1>(),
        }
    }
}

impl<T: Float> Whole<'_, T> {
    /// For any number of groups.
    #[inline(always)]
    pub(crate) fn lanes<const N: usize>(&mut self) -> T {
        let mut step = self.0.views::<N>();
        let (n, groups) = (step.hi.len(), step.hb.len());
        let m = n / 2;
        let mut change = Moved::<T, N>::new();
        for c in 0..n {
            let (from, negative) = if c < m { (c + m, false) } else { (c - m, true) };
            for g in 0..groups {
                let l = times(&step.hb[g], &step.gradients[from * groups + g]);
                step.l[c * groups + g] = if negative { l.map(|x| -x) } else { l };
            }
            step.advance(c, &mut change);
        }
        change.reduce()
    }
}

impl<T: Float> Kernel for Half<'_, T> {
    type Output = T;

    #[inline(always)]
    fn run(&mut self) -> T {
        let (k, s) = (self.step.k, self.step.s);
        if has_pairs::<T>(s) {
            return self.by_rows(&Blocks::of(k));
        }
        match (groups_of_lanes::<T>(s), lanes_of::<T>(s)) {
            (1, 4) => self.by_rows(&Square::<T, 4>::of(k)),
            (1, 8) => self.by_rows(&Square::<T, 8>::of(k)),
            (2, 8) => self.by_rows(&Columns::<T, 2, 8>::of(k, s)),
            (_, 8) => self.lanes::<8>(),
            _ => self.lanes::<1>(),
        }
    }
}

impl<T: Float> Half<'_, T> {
    /// For any number of groups.
    #[inline(always)]
    pub(crate) fn lanes<const N: usize>(&mut self) -> T {
        let mut step = self.step.views::<N>();
        let (n, groups) = (step.hi.len(), step.hb.len());
        let m = n / 2;
        let mut change = Moved::<T, N>::new();
        for c in 0..m {
            let (q, p) = (c * groups, (c + m) * groups);
            for g in 0..groups {
                step.l[p + g] = times(&step.hb[g], &step.gradients[q + g]).map(|x| -x);
            }
            let (w, b) = (self.inverse_masses[c], self.offset[c]);
            for g in 0..groups {
                let momenta = step.placed(c + m, &step.mixed(p, g));
                step.l[q + g] = times(&step.hb[g], &momenta.map(|p| w * p + b));
                step.points[p + g] = momenta;
            }
            step.advance(c, &mut change);
        }
        change.reduce()
    }
}

impl<T: Float> Step<'_, T> {
    #[inline(always)]
    fn views<const N: usize>(&mut self) -> Views<'_, T, N> {
        Views {
            k: self.k.as_chunks().0,
            hb: self.hb.as_chunks().0,
            hi: self.hi,
            lo: self.lo,
            inverse_scale: self.inverse_scale,
            gradients: self.gradients.as_chunks().0,
            l: self.l.as_chunks_mut().0,
            z: self.z.as_chunks_mut().0,
            points: self.points.as_chunks_mut().0,
            s: self.s,
        }
    }
}

/// The same in groups of N lanes.
struct Views<'a, T, const N: usize> {
    k: &'a [[T; N]],
    hb: &'a [[T; N]],
    hi: &'a [T],
    lo: &'a [T],
    inverse_scale: &'a [T],
    gradients: &'a [[T; N]],
    l: &'a mut [[T; N]],
    z: &'a mut [[T; N]],
    points: &'a mut [[T; N]],
    s: usize,
}

impl<T: Float, const N: usize> Views<'_, T, N> {
    /// Σ_j K_ij L_j for the stages of group g, of the component whose L begins at `row`.
    #[inline(always)]
    fn mixed(&self, row: usize, g: usize) -> [T; N] {
        product_any(self.k, &self.l[row..row + self.hb.len()], g, self.s)
    }

    #[inline(always)]
    fn placed(&self, c: usize, z: &[T; N]) -> [T; N] {
        placed(self.hi[c], self.lo[c], z)
    }

    /// Z ← K L and the stages, for one component.
    #[inline(always)]
    fn advance(&mut self, c: usize, change: &mut Moved<T, N>) {
        let groups = self.hb.len();
        for g in 0..groups {
            let z = self.mixed(c * groups, g);
            change.see(&z, &self.z[c * groups + g], self.inverse_scale[c]);
            self.points[c * groups + g] = self.placed(c, &z);
            self.z[c * groups + g] = z;
        }
    }
}

/// Changes of Z, lane by lane. Z of the padding is zero.
pub(crate) struct Moved<T, const N: usize> {
    largest: [T; N],
    sum: [T; N],
}

impl<T: Float, const N: usize> Moved<T, N> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        let zeros = [T::int(0); N];
        Moved {
            largest: zeros,
            sum: zeros,
        }
    }

    #[inline(always)]
    pub(crate) fn see(&mut self, z: &[T; N], before: &[T; N], inverse_scale: T) {
        for i in 0..N {
            let moved = (z[i] - before[i]).abs() * inverse_scale;
            let most = self.largest[i];
            self.largest[i] = if moved > most { moved } else { most };
            self.sum[i] += moved;
        }
    }

    #[inline(always)]
    pub(crate) fn reduce(&self) -> T {
        // Not the sum of the sums: in quest of it the compiler would take the vectors of the loop apart.
        if self.sum.iter().all(|sum| sum.is_finite()) {
            largest(self.largest)
        } else {
            T::NAN
        }
    }
}

/// Σ_j K_ij L_j for the stages of group g, L standing in as many groups.
#[inline(always)]
pub(crate) fn product_any<T: Float, const N: usize>(
    k: &[[T; N]],
    l: &[[T; N]],
    g: usize,
    s: usize,
) -> [T; N] {
    if N > 1
        && let [l] = l
        && let Some(columns) = k.first_chunk::<N>()
    {
        // The padding of K is zero.
        return product(columns, l);
    }
    let groups = l.len();
    let l = l.as_flattened();
    let mut sum = scaled(&k[g], l[0]);
    for (j, &l) in l.iter().enumerate().take(s).skip(1) {
        add(&mut sum, &scaled(&k[j * groups + g], l));
    }
    sum
}

/// Σ_j K_ij L_j for one group of stages, by literal lengths.
#[inline(always)]
pub(crate) fn product<T: Float, const N: usize>(columns: &[[T; N]; N], l: &[T; N]) -> [T; N] {
    sum_of(std::array::from_fn(|j| scaled(&columns[j], l[j])))
}

/// The sum of N terms, a power of 2. The first and the last are added first, and so on inwards: the chain of additions is short.
#[inline(always)]
pub(crate) fn sum_of<T: Float, const N: usize>(mut terms: [[T; N]; N]) -> [T; N] {
    let mut count = N;
    while count > 1 {
        count /= 2;
        for j in 0..count {
            let other = terms[2 * count - 1 - j];
            add(&mut terms[j], &other);
        }
    }
    terms[0]
}

/// y0 + Z of a component, y0 = hi + lo.
#[inline(always)]
pub(crate) fn placed<T: Float, const N: usize>(hi: T, lo: T, z: &[T; N]) -> [T; N] {
    std::array::from_fn(|i| hi + (z[i] + lo))
}

#[inline(always)]
pub(crate) fn times<T: Float, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    std::array::from_fn(|i| a[i] * b[i])
}

#[inline(always)]
pub(crate) fn scaled<T: Float, const N: usize>(a: &[T; N], b: T) -> [T; N] {
    std::array::from_fn(|i| a[i] * b)
}

#[inline(always)]
pub(crate) fn add<T: Float, const N: usize>(a: &mut [T; N], b: &[T; N]) {
    for i in 0..N {
        a[i] += b[i];
    }
}
