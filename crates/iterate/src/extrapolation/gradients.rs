//! The initial guess of a fixed-point iteration: the gradients at the stages, extrapolated from the last
//! step, and the sizes of the components.
//!
//! The polynomial of degree s − 1 through the gradients at the stages of the last step is evaluated at the
//! nodes of this step. It has degree s if the gradient at the start of this step is known:
//!
//! $$ \nabla H(Y_i) \approx \sum_j E_{ij} L_j + \rho_i \nabla H(y_0), \qquad \rho_i = P_s(\tau_i)/P_s(a), \quad \tau_i = a + r c_i, $$
//!
//! P_s vanishes at the old nodes, and a is where this step starts in the last one.
//! [`crate::extrapolation::polynomial`] computes E and ρ. The linear half of an iteration, without
//! evaluations, then gives the stages. Since the velocities follow from the momenta and the gradient at the
//! start from the energy, a step takes 0.8 fewer iterations than from Z = ∫ of the last step's derivatives.
//!
//! If a step is long, the polynomial grows by 6^s and more. Extrapolated gradients are discarded where their
//! L exceeds [`LIKELY`] times the largest L of the last step. For Kepler's problem with 2.24 steps a period,
//! s = 16, the initial error is then the size of the orbit instead of a hundred times that size.
//!
//! The size of a component is max(|y_c|, max_i |Y_ic|), but at least ε^(3/4) of the largest position or
//! momentum: the front of a wave that enters a chain at rest need not be resolved to its own last bit.
//!
//! Cost: 2 s² products for each component.

use crate::MAX_STAGES;
use crate::extrapolation::polynomial::View;
use crate::layout::row::{by_groups, larger, largest, stride_for, times};
use crate::policy::LIKELY;
use equip_autodiff::conjugate;
use equip_scalar::{Float, Kernel};
use std::array::from_fn;
use std::ops::Range;

/// The extrapolation of the gradients.
pub(crate) struct Extrapolate<'a, T> {
    pub(crate) prolongation: View<'a, T>,
    /// L of the last step, all components.
    pub(crate) l: &'a [T],
    /// ∇H at the start of the step, if it is known.
    pub(crate) known: Option<&'a [T]>,
    pub(crate) gradients: &'a mut [T],
    /// h b_i of this step, and the ratio of its size to that of the last step.
    pub(crate) hb: &'a [T],
    pub(crate) ratio: T,
    /// Degrees of freedom, and the number of gradient components needed: ∂H/∂q only, or all.
    pub(crate) m: usize,
    pub(crate) wanted: usize,
    pub(crate) s: usize,
}

impl<T: Float> Kernel for Extrapolate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.s, self)
    }
}

impl<T: Float> Extrapolate<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let (s, m) = (self.s, self.m);
        let l = self.l.as_chunks::<N>().0;
        let gradients = self.gradients.as_chunks_mut::<N>().0;
        let hb = self.hb.as_chunks::<N>().0;
        let mut room = [[T::int(0); N]; MAX_STAGES];
        for c in 0..self.wanted {
            let (from, by_momentum) = conjugate(c, 2 * m);
            let row = &l[from * groups..(from + 1) * groups];
            let most = most_likely(row, self.ratio);
            let row = self.prolongation.coefficients(row, &mut room[..groups], s);
            let at_start = self.known.map_or(T::int(0), |known| known[c]);
            let sign = T::int(if by_momentum { -1 } else { 1 });
            for g in 0..groups {
                let gradient = self
                    .prolongation
                    .extrapolate_group(row, (g, s), sign, at_start);
                gradients[c * groups + g] = likely(&gradient, &hb[g], most);
            }
        }
    }
}

/// The largest plausible L of a component in this step, given its L in the last step. This step is `ratio`
/// times as long.
#[inline(always)]
pub(crate) fn most_likely<T: Float, const N: usize>(last: &[[T; N]], ratio: T) -> T {
    let mut most = [T::int(0); N];
    last.iter().for_each(|l| larger(&mut most, l));
    T::int(LIKELY) * ratio.abs() * largest(most)
}

/// The extrapolated gradients; zero where their L would exceed `most`.
#[inline(always)]
pub(crate) fn likely<T: Float, const N: usize>(gradient: &[T; N], hb: &[T; N], most: T) -> [T; N] {
    let l = times(hb, gradient);
    from_fn(|i| {
        if l[i].abs() <= most {
            gradient[i]
        } else {
            T::int(0)
        }
    })
}

/// The largest |Y| of each component, over y0 and the stages.
pub(crate) struct Sizes<'a, T> {
    pub(crate) hi: &'a [T],
    pub(crate) points: &'a [T],
    pub(crate) scale: &'a mut [T],
    pub(crate) s: usize,
}

impl<T: Float> Kernel for Sizes<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.s, self)
    }
}

impl<T: Float> Sizes<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let points = self.points.as_chunks::<N>().0;
        let components = self.scale.iter_mut().zip(self.hi);
        for ((scale, &hi), points) in components.zip(points.chunks_exact(groups)) {
            let mut size = [hi.abs(); N];
            points.iter().for_each(|points| larger(&mut size, points));
            *scale = largest(size);
        }
    }
}

/// [`resolve`] as a kernel.
pub(crate) struct Resolve<'a, T> {
    pub(crate) scale: &'a mut [T],
    pub(crate) inverse: &'a mut [T],
    pub(crate) components: Range<usize>,
}

impl<T: Float> Kernel for Resolve<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        resolve(self.scale, self.inverse, self.components.clone());
    }
}

/// Raises the sizes of `components` to the smallest size that is resolved, and computes their inverses.
#[inline(always)]
pub(crate) fn resolve<T: Float>(scale: &mut [T], inverse: &mut [T], components: Range<usize>) {
    let (m, root) = (scale.len() / 2, T::EPSILON.sqrt());
    for group in [0..m, m..2 * m] {
        let group = group.start.max(components.start)..group.end.min(components.end);
        if group.is_empty() {
            continue;
        }
        let (scale, inverse) = (&mut scale[group.clone()], &mut inverse[group]);
        let most = largest_in(scale);
        let least = if most > T::int(0) {
            // Below, the inverse overflows.
            (most * root * root.sqrt()).max(T::MIN_POSITIVE)
        } else {
            T::int(1)
        };
        for (x, inverse) in scale.iter_mut().zip(inverse) {
            *x = if *x > least { *x } else { least };
            *inverse = T::int(1) / *x;
        }
    }
}

/// The largest of non-negative numbers.
#[inline(always)]
fn largest_in<T: Float>(x: &[T]) -> T {
    let (rows, rest) = x.as_chunks::<8>();
    let mut lanes = [T::int(0); 8];
    rows.iter().for_each(|row| larger(&mut lanes, row));
    rest.iter()
        .fold(largest(lanes), |a, &x| if x > a { x } else { a })
}
