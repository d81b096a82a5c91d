//! Which sweeps are incremental: those that by the contraction seen leave others to come. Series of them run
//! inside one kernel, which asks here whether to go on.

use crate::convergence::contraction::{Contraction, Progress};
use crate::policy::NOISY;
use equip_scalar::Float;

/// Whether sweeps of a series go on.
pub(crate) trait Again<T> {
    /// After a sweep that has changed Z by `change`. Implementations are inlined into the kernels.
    fn again(&mut self, change: T) -> bool;
}

/// One sweep.
pub(crate) struct Once;

impl<T> Again<T> for Once {
    #[inline(always)]
    fn again(&mut self, _change: T) -> bool {
        false
    }
}

/// The same question of any float, asked by doubles.
pub(crate) struct InDoubles<'a, A, T>(pub(crate) &'a mut A, pub(crate) std::marker::PhantomData<T>);

impl<T: Float, A: Again<T>> Again<f64> for InDoubles<'_, A, T> {
    #[inline(always)]
    fn again(&mut self, change: f64) -> bool {
        self.0.again(T::exact(change))
    }
}

/// A series of incremental sweeps.
pub(crate) struct Series<'a, T> {
    contraction: &'a mut Contraction<T>,
    /// What the last sweep of the series says; nothing if it was not observed yet.
    pub(crate) progress: Option<Progress>,
    pub(crate) made: u32,
}

impl<'a, T: Float> Series<'a, T> {
    pub(crate) fn new(contraction: &'a mut Contraction<T>) -> Self {
        Series {
            contraction,
            progress: None,
            made: 1,
        }
    }

    /// Whether the next sweep leaves others to come.
    #[inline(always)]
    pub(crate) fn is_next(&self) -> bool {
        self.contraction.next_change() > NOISY * T::EPSILON.to_f64()
    }
}

impl<T: Float> Again<T> for Series<'_, T> {
    #[inline(always)]
    fn again(&mut self, change: T) -> bool {
        let progress = self.contraction.observe(change.to_f64(), false);
        self.progress = Some(progress);
        let again = progress == Progress::Contracts && self.is_next();
        self.made += u32::from(again);
        again
    }
}
