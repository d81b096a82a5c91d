//! The trait route at many points at once: dual numbers over lanes.
//!
//! Points are taken in groups of 4, so that the derivatives of a group are a handful of vector registers. The
//! last group computes on the padding too. The code is compiled for the processors of the build only: further
//! copies for AVX2 and AVX-512 were measured to be no faster (Kepler's forces at 8 points: 16 ns, 16 ns and
//! 15 ns, division being the bottleneck), and each is compiled anew for every energy.

use super::dual::Dual;
use crate::replay::batch::Batch;
use crate::{Energy, Pattern};
use equip_scalar::{
    Constant, FirstOrder, Float, Forward2, Lanes, Num, Pack as _, Piecewise, SecondOrder,
};
use std::array::from_fn;

/// Points in a group.
const LANES: usize = 4;

/// Largest number of components differentiated by dual numbers.
pub(crate) const LARGEST: usize = 8;

/// Evaluates an expression with the length of the state as a constant.
macro_rules! by_length {
    ($y:expr, $n:ident => $small:expr, $large:expr) => {
        match $y.len() {
            2 => by_length!(@ $n = 2, $small),
            4 => by_length!(@ $n = 4, $small),
            6 => by_length!(@ $n = 6, $small),
            8 => by_length!(@ $n = 8, $small),
            _ => $large,
        }
    };
    (@ $n:ident = $value:literal, $small:expr) => {{
        const $n: usize = $value;
        $small
    }};
}
pub(crate) use by_length;

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

#[inline(always)]
pub(crate) fn value<E: Energy, T: Float, const N: usize>(energy: &E, y: &[T]) -> T {
    let y: [Num<T>; N] = from_fn(|i| Num(y[i]));
    energy.energy(&y[..N / 2], &y[N / 2..]).0
}

/// ∇²H at a state of two components, by num-dual, into the entries of a pattern. Returns whether the state is
/// that short.
pub(crate) fn hessian<E: Energy, T: Float>(
    energy: &E,
    y: &[f64],
    (pattern, entries): (&Pattern, &mut [T]),
) -> bool {
    let &[q, p] = y else {
        return false;
    };
    let [q, p] = [(q, 0), (p, 1)].map(|(x, i)| Num(Forward2::<f64, 2>::variable(x, i)));
    let Num(h) = energy.energy(&[q], &[p]);
    let h = h.hessian();
    for i in 0..2 {
        for (entry, j) in pattern.row(i) {
            entries[entry] = T::exact(h[i.min(j)][i.max(j)]);
        }
    }
    true
}

#[inline(always)]
pub(crate) fn dual_gradient<E: Energy, T: Float, const N: usize>(
    energy: &E,
    y: &[T],
    to: &mut [T],
) -> T {
    let mut state = [y[0]; N];
    state.copy_from_slice(y);
    let (h, slopes) = gradient(energy, state);
    to.copy_from_slice(&slopes);
    h
}
