//! The linear half of a sweep, from the gradients to the next stages, compiled for every instruction set.
//!
//! Lanes are the stages: all loops run over arrays of 4 or 8 places, which the compiler turns into vector instructions of whatever
//! set it is compiled for. Sums keep their order, so the bits are the same on every set and in a loop over single stages.
//!
//! Cost: s² products for each component that K is applied to.

use equip_scalar::{Float, Kernel};

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
        match self.0.hb.len() {
            4 => self.lanes::<4>(),
            _ => self.lanes::<8>(),
        }
    }
}

impl<T: Float> Whole<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(mut self) -> Change<T> {
        let step = &mut self.0;
        let (n, stride) = (step.hi.len(), step.hb.len());
        let m = n / 2;
        let mut change = Moved::<T, N>::new();
        for c in 0..n {
            let (from, sign) = if c < m {
                (c + m, T::int(1))
            } else {
                (c - m, -T::int(1))
            };
            for at in (0..stride).step_by(N) {
                let hb = load::<T, N>(step.hb, at);
                let g = load::<T, N>(step.gradients, from * stride + at);
                store::<T, N>(
                    step.l,
                    c * stride + at,
                    std::array::from_fn(|i| sign * (hb[i] * g[i])),
                );
            }
            for at in (0..stride).step_by(N) {
                step.advance::<N>(c, at, &mut change);
            }
        }
        change.reduce()
    }
}

impl<T: Float> Kernel for Half<'_, T> {
    type Output = Change<T>;

    #[inline(always)]
    fn run(self) -> Change<T> {
        match self.step.hb.len() {
            4 => self.lanes::<4>(),
            _ => self.lanes::<8>(),
        }
    }
}

impl<T: Float> Half<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(mut self) -> Change<T> {
        let step = &mut self.step;
        let (n, stride) = (step.hi.len(), step.hb.len());
        let m = n / 2;
        let mut change = Moved::<T, N>::new();
        for c in 0..m {
            let (q, p) = (c * stride, (c + m) * stride);
            for at in (0..stride).step_by(N) {
                let hb = load::<T, N>(step.hb, at);
                let g = load::<T, N>(step.gradients, q + at);
                store::<T, N>(step.l, p + at, std::array::from_fn(|i| -(hb[i] * g[i])));
            }
            let (hi, lo) = (step.hi[c + m], step.lo[c + m]);
            let (w, b) = (self.inverse_masses[c], self.offset[c]);
            for at in (0..stride).step_by(N) {
                let z = step.mixed::<N>(p, at);
                let momenta: [T; N] = std::array::from_fn(|i| hi + (z[i] + lo));
                store::<T, N>(step.points, p + at, momenta);
                let hb = load::<T, N>(step.hb, at);
                store::<T, N>(
                    step.l,
                    q + at,
                    std::array::from_fn(|i| hb[i] * (w * momenta[i] + b)),
                );
            }
            for at in (0..stride).step_by(N) {
                step.advance::<N>(c, at, &mut change);
            }
        }
        change.reduce()
    }
}

impl<T: Float> Step<'_, T> {
    /// Σ_j K_ij L_j for N stages from `at` on, of the component whose L begins at `row`.
    #[inline(always)]
    fn mixed<const N: usize>(&self, row: usize, at: usize) -> [T; N] {
        let stride = self.hb.len();
        let l = &self.l[row..][..self.s];
        let first = load::<T, N>(self.k, at);
        let mut sum: [T; N] = std::array::from_fn(|i| first[i] * l[0]);
        for (j, &l) in l.iter().enumerate().skip(1) {
            let column = load::<T, N>(self.k, j * stride + at);
            for i in 0..N {
                sum[i] += column[i] * l;
            }
        }
        sum
    }

    /// Z ← K L and the stages, for one component and N stages.
    #[inline(always)]
    fn advance<const N: usize>(&mut self, c: usize, at: usize, change: &mut Moved<T, N>) {
        let place = c * self.hb.len() + at;
        let z = self.mixed::<N>(c * self.hb.len(), at);
        let before = load::<T, N>(self.z, place);
        let (hi, lo, inverse) = (self.hi[c], self.lo[c], self.inverse_scale[c]);
        change.see(std::array::from_fn(|i| (z[i] - before[i]).abs() * inverse));
        store::<T, N>(self.z, place, z);
        store::<T, N>(
            self.points,
            place,
            std::array::from_fn(|i| hi + (z[i] + lo)),
        );
    }
}

/// Changes of Z, lane by lane.
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

    /// The places from s on are padding: their K is zero, and so is their Z.
    #[inline(always)]
    fn see(&mut self, moved: [T; N]) {
        for i in 0..N {
            self.largest[i] = if moved[i] > self.largest[i] {
                moved[i]
            } else {
                self.largest[i]
            };
            self.sum[i] += moved[i];
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
fn load<T: Float, const N: usize>(x: &[T], at: usize) -> [T; N] {
    let mut lanes = [T::int(0); N];
    lanes.copy_from_slice(&x[at..][..N]);
    lanes
}

#[inline(always)]
fn store<T: Float, const N: usize>(x: &mut [T], at: usize, lanes: [T; N]) {
    x[at..][..N].copy_from_slice(&lanes);
}
