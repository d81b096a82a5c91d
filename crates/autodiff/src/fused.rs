//! [`Fused`]: a computation with ∇H or ∇U in its midst, compiled together with the energy.
//!
//! A stage sweep of a small system is a gradient of 30 ns and a product with a matrix of 30 ns. As two kernels that hand each
//! other numbers through memory, with lengths known when the program runs, it takes three times the sum. Here the
//! energy calls the computation and not the other way round: the compiler sees both, and the number of components as a literal.

use crate::Energy;
use crate::batch::{force, gradient};
use equip_scalar::{Kernel, Lanes};

/// ∇H of a system with C components, or ∇U of one with C positions, at N points.
#[doc(hidden)]
pub trait Slopes<const C: usize, const N: usize> {
    /// The derivatives at the states, each of them with every bit of the one at a single state.
    fn at(&self, states: &[Lanes<N>; C]) -> [Lanes<N>; C];
}

/// What is to be done with the derivatives. Mark `run`, and all it calls, `#[inline(always)]`.
#[doc(hidden)]
pub trait Fused<const N: usize> {
    /// What it returns.
    type Output;
    /// The computation.
    fn run<const C: usize>(&mut self, slopes: &impl Slopes<C, N>) -> Self::Output;
}

/// ∇U of a separable system with M positions.
pub(crate) struct Forces<'a, E>(pub(crate) &'a E);

impl<E: Energy, const M: usize, const N: usize> Slopes<M, N> for Forces<'_, E> {
    #[inline(always)]
    fn at(&self, states: &[Lanes<N>; M]) -> [Lanes<N>; M] {
        force::<E, Lanes<N>, M>(self.0, *states)
    }
}

/// ∇H of a system with C components.
pub(crate) struct Gradients<'a, E>(pub(crate) &'a E);

impl<E: Energy, const C: usize, const N: usize> Slopes<C, N> for Gradients<'_, E> {
    #[inline(always)]
    fn at(&self, states: &[Lanes<N>; C]) -> [Lanes<N>; C] {
        gradient::<E, Lanes<N>, C>(self.0, *states).1
    }
}

/// A computation with its derivatives, of C components.
pub(crate) struct Joined<'a, S, F, const C: usize, const N: usize> {
    pub(crate) slopes: S,
    pub(crate) task: &'a mut F,
}

impl<S, F, const C: usize, const N: usize> Kernel for Joined<'_, S, F, C, N>
where
    S: Slopes<C, N>,
    F: Fused<N>,
{
    type Output = F::Output;

    #[inline(always)]
    fn run(&mut self) -> F::Output {
        self.task.run(&self.slopes)
    }
}
