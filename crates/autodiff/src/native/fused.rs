//! [`Fused`]: a computation that contains ∇H or ∇U, compiled together with the energy.
//!
//! A stage iteration of a small system is a gradient of 30 ns and a matrix product of 30 ns. As two kernels
//! that exchange numbers through memory, with lengths known at run time only, it takes three times their sum.
//! Here the energy calls the computation instead: the compiler sees both, with a constant number of
//! components. The energy itself is called as machine code.

use equip_jit::Code;
use equip_scalar::{Kernel, Lanes};

/// ∇H of a system with C components, or ∇U of a system with C positions, at N points.
#[doc(hidden)]
pub trait StageGradients<const C: usize, const N: usize> {
    /// The derivatives at the states, bit for bit the same as at single states.
    fn at(&self, states: &[[f64; N]; C]) -> [Lanes<N>; C];
}

/// A computation on the derivatives. Mark `run`, and all functions that it calls, `#[inline(always)]`.
#[doc(hidden)]
pub trait Fused<const N: usize> {
    /// The result of the computation.
    type Output;
    /// The computation.
    fn run<const C: usize>(&mut self, derivatives: &impl StageGradients<C, N>) -> Self::Output;
    /// The same for few registers; see [`Kernel::run_narrow`].
    fn run_narrow<const C: usize>(
        &mut self,
        derivatives: &impl StageGradients<C, N>,
    ) -> Self::Output;
}

/// Derivatives by machine code for rows of this length.
pub(crate) struct Called<'a>(pub(crate) &'a Code);

impl<const C: usize, const N: usize> StageGradients<C, N> for Called<'_> {
    #[inline(always)]
    fn at(&self, states: &[[f64; N]; C]) -> [Lanes<N>; C] {
        let mut rows = [[0.0; N]; C];
        let from = states.as_flattened();
        debug_assert_eq!(self.0.stride(), N);
        self.0.run(from, rows.as_flattened_mut(), &mut [], N);
        rows.map(Lanes)
    }
}

/// A computation with its derivatives, for C components.
pub(crate) struct Joined<'a, S, F, const C: usize, const N: usize> {
    pub(crate) derivatives: S,
    pub(crate) task: &'a mut F,
}

impl<S, F, const C: usize, const N: usize> Kernel for Joined<'_, S, F, C, N>
where
    S: StageGradients<C, N>,
    F: Fused<N>,
{
    type Output = F::Output;

    #[inline(always)]
    fn run(&mut self) -> F::Output {
        self.task.run(&self.derivatives)
    }

    #[inline(always)]
    fn run_narrow(&mut self) -> F::Output {
        self.task.run_narrow(&self.derivatives)
    }
}

/// Runs the task with a constant number of components; `None` for other numbers.
macro_rules! fuse {
    ($set:expr, $count:expr, $derivatives:ident, $task:ident, [$($literal:literal)*]) => {
        match $count {
            $($literal => {
                let mut joined = Joined::<_, _, $literal, N> { derivatives: $derivatives, task: $task };
                $set.run_wide(&mut joined)
            })*
            _ => None,
        }
    };
}
pub(crate) use fuse;
