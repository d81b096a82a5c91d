//! The trait route at many points at once: dual numbers over lanes.
//!
//! Points are taken in groups of 8, or of 4 where there is no room for more, each group a handful of vector
//! registers. The last group computes on the padding too. Cost on AVX-512: Kepler 1 ns a point.

use crate::Energy;
use crate::dual::Dual;
use equip_scalar::{Constant, Float, Kernel, Lanes, Num, Piecewise};

/// Points component by component.
#[derive(Debug)]
pub(crate) struct Batch<'a> {
    pub(crate) states: &'a [f64],
    pub(crate) gradients: &'a mut [f64],
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

impl<'a> Batch<'a> {
    /// `None` if the numbers are not `f64`.
    #[inline(always)]
    pub(crate) fn of<T: Float>(
        states: &'a [T],
        gradients: &'a mut [T],
        stride: usize,
        count: usize,
    ) -> Option<Self> {
        Some(Batch {
            states: T::as_doubles(states)?,
            gradients: T::as_doubles_mut(gradients)?,
            stride,
            count,
        })
    }
}

/// Derivatives of an energy by C variables. Not a closure: those are not always inlined, and code that is not inlined into a
/// kernel has no vector instructions.
trait Derive<const C: usize> {
    fn derive<S: Piecewise>(self, state: [S; C]) -> [S; C];
}

impl Batch<'_> {
    #[inline(always)]
    fn each<const C: usize>(self, derivatives: impl Derive<C> + Copy) {
        if self.stride <= 4 {
            self.groups::<4, C>(derivatives);
        } else {
            self.groups::<8, C>(derivatives);
        }
    }

    #[inline(always)]
    fn groups<const L: usize, const C: usize>(self, derivatives: impl Derive<C> + Copy) {
        let stride = self.stride;
        let mut at = 0;
        while at < self.count {
            let mut state = [Lanes::<L>::splat(0.0); C];
            for c in 0..C {
                state[c] = Lanes::load(&self.states[c * stride + at..(c + 1) * stride]);
            }
            let slopes = derivatives.derive(state);
            for c in 0..C {
                slopes[c].store(&mut self.gradients[c * stride + at..(c + 1) * stride]);
            }
            at += L;
        }
    }
}

/// ∇H of a system with N components.
#[derive(Debug)]
pub(crate) struct Gradients<'a, E, const N: usize>(pub(crate) &'a E, pub(crate) Batch<'a>);

impl<E: Energy, const N: usize> Kernel for Gradients<'_, E, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.1.each(Gradient::<E, N>(self.0));
    }
}

/// ∇U of a separable system with M positions.
#[derive(Debug)]
pub(crate) struct Forces<'a, E, const M: usize>(pub(crate) &'a E, pub(crate) Batch<'a>);

impl<E: Energy, const M: usize> Kernel for Forces<'_, E, M> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.1.each(Force::<E, M>(self.0));
    }
}

struct Gradient<'a, E, const N: usize>(&'a E);

impl<E, const N: usize> Clone for Gradient<'_, E, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<E, const N: usize> Copy for Gradient<'_, E, N> {}

impl<E: Energy, const N: usize> Derive<N> for Gradient<'_, E, N> {
    #[inline(always)]
    fn derive<S: Piecewise>(self, state: [S; N]) -> [S; N] {
        gradient(self.0, state).1
    }
}

/// H and ∇H at one state, or at one in each lane.
#[inline(always)]
pub(crate) fn gradient<E: Energy, S: Piecewise, const N: usize>(
    energy: &E,
    state: [S; N],
) -> (S, [S; N]) {
    let mut y = [Num(Dual::variable(state[0], 0)); N];
    for c in 1..N {
        y[c] = Num(Dual::variable(state[c], c));
    }
    let Num(h) = energy.energy(&y[..N / 2], &y[N / 2..]);
    (h.value, h.gradient())
}

struct Force<'a, E, const M: usize>(&'a E);

impl<E, const M: usize> Clone for Force<'_, E, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<E, const M: usize> Copy for Force<'_, E, M> {}

impl<E: Energy, const M: usize> Derive<M> for Force<'_, E, M> {
    /// ∂H/∂q at p = 0; of a separable H it is the same at every p.
    #[inline(always)]
    fn derive<S: Piecewise>(self, state: [S; M]) -> [S; M] {
        let mut q = [Num(Dual::variable(state[0], 0)); M];
        for c in 1..M {
            q[c] = Num(Dual::variable(state[c], c));
        }
        let p = [Num(Dual::fixed(S::constant(Constant::Double(0.0)))); M];
        let Num(h) = self.0.energy(&q, &p);
        h.gradient()
    }
}
