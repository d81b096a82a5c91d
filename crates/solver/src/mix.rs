//! The linear half of a sweep, from the gradients to the next stages, compiled for every instruction set.
//!
//! Lanes are the stages: all loops run over arrays of 4 or 8 places, which the compiler turns into vector instructions of whatever
//! set it is compiled for; floats that are no vector elements go stage by stage. Sums have one order, so the bits are the same on every set.
//!
//! Cost: s² products for each component that K is applied to.

use equip_scalar::{Float, Kernel};

/// Lanes that `s` stages of this float are padded to.
pub(crate) fn stride_for<T: Float>(s: usize) -> usize {
    match T::as_doubles(&[]) {
        None => s,
        Some(_) if s <= 4 => 4,
        Some(_) => s.next_multiple_of(8),
    }
}

/// What both forms need: the method, the start of the step, and where things go. Component c of stage i stands at `c·stride + i`.
pub(crate) struct Step<'a, T> {
    /// K(α), column by column.
    pub(crate) k: &'a [T],
    /// h b_i.
    pub(crate) hb: &'a [T],
    /// y0, all components.
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    /// 1 over the sizes of the components.
    pub(crate) inverse_scale: &'a [T],
    pub(crate) gradients: &'a [T],
    pub(crate) l: &'a mut [T],
    pub(crate) z: &'a mut [T],
    pub(crate) points: &'a mut [T],
    pub(crate) s: usize,
}

/// Largest change of Z relative to the sizes of the components, and a sum that is not finite if any of them is not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change<T> {
    pub(crate) largest: T,
    pub(crate) sum: T,
}

/// Z ← K L with L = h b J∇H, all components.
pub(crate) struct Whole<'a, T>(pub(crate) Step<'a, T>);

/// L_p = −h b ∇U, P = p + K L_p, L_q = h b (M⁻¹ P + b), Z_q ← K L_q, with a diagonal M⁻¹.
pub(crate) struct Half<'a, T> {
    pub(crate) step: Step<'a, T>,
    pub(crate) inverse_masses: &'a [T],
    pub(crate) offset: &'a [T],
}

impl<T: Float> Kernel for Whole<'_, T> {
    type Output = Change<T>;

    #[inline(always)]
    fn run(self) -> Change<T> {
        match self.0.lanes() {
            4 => self.lanes::<4>(),
            8 => self.lanes::<8>(),
            _ => self.lanes::<1>(),
        }
    }
}

impl<T: Float> Whole<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(self) -> Change<T> {
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
    type Output = Change<T>;

    #[inline(always)]
    fn run(self) -> Change<T> {
        match self.step.lanes() {
            4 => self.lanes::<4>(),
            8 => self.lanes::<8>(),
            _ => self.lanes::<1>(),
        }
    }
}

impl<T: Float> Half<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(self) -> Change<T> {
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

impl<'a, T: Float> Step<'a, T> {
    /// Lanes worked on together.
    #[inline(always)]
    fn lanes(&self) -> usize {
        match stride_for::<T>(self.s) {
            4 => 4,
            stride if stride % 8 == 0 && T::as_doubles(&[]).is_some() => 8,
            _ => 1,
        }
    }

    #[inline(always)]
    fn views<const N: usize>(self) -> Views<'a, T, N> {
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
        if N > 1
            && self.hb.len() == 1
            && let Some(columns) = self.k.first_chunk::<N>()
        {
            // One group: the padding of K is zero, and all lengths are literals. Two sums halve the chain of additions.
            let l = &self.l[row];
            let (mut even, mut odd) = (scaled(&columns[0], l[0]), scaled(&columns[1], l[1]));
            for j in (2..N).step_by(2) {
                add(&mut even, &scaled(&columns[j], l[j]));
                add(&mut odd, &scaled(&columns[j + 1], l[j + 1]));
            }
            add(&mut even, &odd);
            return even;
        }
        let groups = self.hb.len();
        let l = self.l[row..row + groups].as_flattened();
        let mut sum = scaled(&self.k[g], l[0]);
        for (j, &l) in l.iter().enumerate().take(self.s).skip(1) {
            add(&mut sum, &scaled(&self.k[j * groups + g], l));
        }
        sum
    }

    /// y0 + Z of a component.
    #[inline(always)]
    fn placed(&self, c: usize, z: &[T; N]) -> [T; N] {
        let (hi, lo) = (self.hi[c], self.lo[c]);
        z.map(|z| hi + (z + lo))
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
struct Moved<T, const N: usize> {
    largest: [T; N],
    sum: [T; N],
}

impl<T: Float, const N: usize> Moved<T, N> {
    #[inline(always)]
    fn new() -> Self {
        let zeros = [T::int(0); N];
        Moved {
            largest: zeros,
            sum: zeros,
        }
    }

    #[inline(always)]
    fn see(&mut self, z: &[T; N], before: &[T; N], inverse_scale: T) {
        for i in 0..N {
            let moved = (z[i] - before[i]).abs() * inverse_scale;
            let most = self.largest[i];
            self.largest[i] = if moved > most { moved } else { most };
            self.sum[i] += moved;
        }
    }

    #[inline(always)]
    fn reduce(&self) -> Change<T> {
        let zero = T::int(0);
        Change {
            largest: (self.largest.iter()).fold(zero, |a, &x| if x > a { x } else { a }),
            sum: self.sum.iter().fold(zero, |a, &x| a + x),
        }
    }
}

#[inline(always)]
fn times<T: Float, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    std::array::from_fn(|i| a[i] * b[i])
}

#[inline(always)]
fn scaled<T: Float, const N: usize>(a: &[T; N], b: T) -> [T; N] {
    std::array::from_fn(|i| a[i] * b)
}

#[inline(always)]
fn add<T: Float, const N: usize>(a: &mut [T; N], b: &[T; N]) {
    for i in 0..N {
        a[i] += b[i];
    }
}
