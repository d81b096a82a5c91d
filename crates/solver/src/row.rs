//! How a component's numbers at the stages lie: a *row* is G groups of N lanes, a lane for each stage and padding behind.
//!
//! Lanes are worked on by loops over arrays of 4 or 8 places, which the compiler turns into vector instructions of whatever set it is
//! compiled for; floats that are no vector elements go stage by stage.

use equip_scalar::Float;
use std::array::from_fn;

pub(crate) type Row<T, const G: usize, const N: usize> = [[T; N]; G];

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

/// Groups of N lanes that `s` stages stand in.
#[inline(always)]
pub(crate) fn groups_of<T: Float, const N: usize>(s: usize) -> usize {
    stride_for::<T>(s) / N
}

/// A task's `lanes` for the number of lanes that `s` stages of the float are worked on with.
macro_rules! by_lanes {
    ($float:ty, $s:expr, $task:ident) => {
        match $crate::row::lanes_of::<$float>($s) {
            4 => $task.lanes::<4>(),
            8 => $task.lanes::<8>(),
            _ => $task.lanes::<1>(),
        }
    };
}
pub(crate) use by_lanes;

/// Whole rows.
#[inline(always)]
pub(crate) fn rows<T, const G: usize, const N: usize>(x: &[T]) -> &[Row<T, G, N>] {
    x.as_chunks().0.as_chunks().0
}

#[inline(always)]
pub(crate) fn rows_mut<T, const G: usize, const N: usize>(x: &mut [T]) -> &mut [Row<T, G, N>] {
    x.as_chunks_mut().0.as_chunks_mut().0
}

/// # Panics
/// If what is there is shorter than its literal length.
#[inline(always)]
pub(crate) fn literal<R>(found: Option<R>) -> R {
    match found {
        Some(found) => found,
        None => panic!(
            "a sweep by literal lengths has as many components and stages as it was made for"
        ),
    }
}

/// y0 + Z of a component, y0 = hi + lo.
#[inline(always)]
pub(crate) fn placed<T: Float, const N: usize>(hi: T, lo: T, z: &[T; N]) -> [T; N] {
    from_fn(|i| hi + (z[i] + lo))
}

#[inline(always)]
pub(crate) fn times<T: Float, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    from_fn(|i| a[i] * b[i])
}

#[inline(always)]
pub(crate) fn difference<T: Float, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    from_fn(|i| a[i] - b[i])
}

#[inline(always)]
pub(crate) fn scaled<T: Float, const N: usize>(a: &[T; N], b: T) -> [T; N] {
    from_fn(|i| a[i] * b)
}

#[inline(always)]
pub(crate) fn add<T: Float, const N: usize>(a: &mut [T; N], b: &[T; N]) {
    for i in 0..N {
        a[i] += b[i];
    }
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
