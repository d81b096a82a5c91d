//! The trait route at many points at once: dual numbers over lanes.
//!
//! Points are taken in groups of 4, so that the derivatives of a group are a handful of vector registers. The
//! last group computes on the padding too. The code is compiled for the processors of the build only: further
//! copies for AVX2 and AVX-512 were measured to be no faster (Kepler's forces at 8 points: 16 ns, 16 ns and
//! 15 ns, division being the bottleneck), and each is compiled anew for every energy.

use crate::Energy;
use crate::dual::Dual;
use equip_scalar::{Constant, Float, Lanes, Num, Pack, Piecewise};

/// Points in a group.
const LANES: usize = 4;

/// Points component by component.
#[derive(Debug)]
pub(crate) struct Batch<'a, T> {
    pub(crate) states: &'a [T],
    pub(crate) gradients: &'a mut [T],
    pub(crate) stride: usize,
    pub(crate) count: usize,
}

impl<'a> Batch<'a, f64> {
    /// `None` if the numbers are not `f64`.
    #[inline(always)]
    pub(crate) fn of_doubles<T: Float>(
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

impl<T: Float> Batch<'_, T> {
    /// A single point.
    pub(crate) fn one<'a>(state: &'a [T], gradient: &'a mut [T]) -> Batch<'a, T> {
        Batch {
            states: state,
            gradients: gradient,
            stride: 1,
            count: 1,
        }
    }

    /// The same for a while.
    pub(crate) fn reborrow(&mut self) -> Batch<'_, T> {
        Batch {
            states: self.states,
            gradients: &mut *self.gradients,
            stride: self.stride,
            count: self.count,
        }
    }

    /// The same, if the numbers are doubles.
    pub(crate) fn in_doubles(&mut self) -> Option<Batch<'_, f64>> {
        Batch::of_doubles(self.states, &mut *self.gradients, self.stride, self.count)
    }
}

impl Batch<'_, f64> {
    /// ∇H of a system with N components. Compiled once for an energy, not for every caller.
    #[inline(never)]
    pub(crate) fn gradients<E: Energy, const N: usize>(self, energy: &E) {
        self.each(|y| gradient::<E, Lanes<LANES>, N>(energy, y).1);
    }

    /// ∇U of a separable system with M positions.
    #[inline(never)]
    pub(crate) fn forces<E: Energy, const M: usize>(self, energy: &E) {
        self.each(|q| force::<E, Lanes<LANES>, M>(energy, q));
    }

    #[inline(always)]
    fn each<const C: usize>(self, derivatives: impl Fn([Lanes<LANES>; C]) -> [Lanes<LANES>; C]) {
        let stride = self.stride;
        for at in (0..self.count).step_by(LANES) {
            let mut state = [Lanes::splat(0.0); C];
            for (c, lanes) in state.iter_mut().enumerate() {
                *lanes = Lanes::load(&self.states[c * stride + at..(c + 1) * stride]);
            }
            let slopes = derivatives(state);
            for (c, slopes) in slopes.iter().enumerate() {
                slopes.store(&mut self.gradients[c * stride + at..(c + 1) * stride]);
            }
        }
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

/// ∂H/∂q at p = 0; of a separable H it is the same at every p.
#[inline(always)]
pub(crate) fn force<E: Energy, S: Piecewise, const M: usize>(energy: &E, state: [S; M]) -> [S; M] {
    let mut q = [Num(Dual::variable(state[0], 0)); M];
    for c in 1..M {
        q[c] = Num(Dual::variable(state[c], c));
    }
    let p = [Num(Dual::fixed(S::constant(Constant::double(0.0)))); M];
    let Num(h) = energy.energy(&q, &p);
    h.gradient()
}
