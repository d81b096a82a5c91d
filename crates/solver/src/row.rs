//! How a component's numbers at the stages lie: a *row* is G groups of N lanes, a lane for each stage and padding behind.
//!
//! Rows are arrays in memory and [`Pack`]s in arithmetic, which the compiler turns into vector instructions of whatever set it is
//! compiled for.

use equip_scalar::{Float, Pack};
use std::array::from_fn;

pub(crate) type Row<T, const G: usize, const N: usize> = [[T; N]; G];

/// Lanes that `s` stages of this float are padded to.
pub(crate) fn stride_for<T: Float>(s: usize) -> usize {
    s.next_multiple_of(lanes_of::<T>(s))
}

/// Lanes that are worked on together.
#[inline(always)]
pub(crate) fn lanes_of<T: Float>(s: usize) -> usize {
    match T::WIDTH {
        1 => 1,
        _ if T::IS_DOUBLE && s <= 4 => 4,
        _ => 8,
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
        if <$float>::IS_DOUBLE {
            match $crate::row::lanes_of::<$float>($s) {
                4 => $task.lanes::<4>(),
                _ => $task.lanes::<8>(),
            }
        } else if const { <$float as Float>::WIDTH == 1 } {
            $task.lanes::<1>()
        } else {
            $task.lanes::<8>()
        }
    };
}
pub(crate) use by_lanes;

/// A task's `groups` for the number of lanes and groups that `s` stages of the float stand in, both of them literals: loops over groups are none.
macro_rules! by_groups {
    ($float:ty, $s:expr, $task:ident) => {
        match $crate::row::stride_for::<$float>($s) {
            s if const { <$float as Float>::WIDTH == 1 } => $task.groups::<1>(s),
            4 => $task.groups::<4>(1),
            8 => $task.groups::<8>(1),
            16 => $task.groups::<8>(2),
            stride => $task.groups::<8>(stride / 8),
        }
    };
}
pub(crate) use by_groups;

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

/// What is to be read from memory number by number, where it has just been written: to take the numbers out of a vector the processor needs
/// the units that multiply and add.
#[inline(always)]
pub(crate) fn in_memory<R>(row: &mut R) -> &R {
    std::hint::black_box(row)
}

/// A row that begins with a cache line: what is written across two comes back late.
#[repr(align(64))]
pub(crate) struct OnLines<R>(pub(crate) R);

/// Doubles lane by lane, of which the compiler makes better vectors where many rows are at work, others in packs.
macro_rules! each_lane {
    (|$i:ident| $number:expr, $pack:expr) => {
        if T::IS_DOUBLE {
            from_fn(|$i| $number)
        } else {
            ($pack).numbers()
        }
    };
}

/// y0 + Z of a component, y0 = hi + lo.
#[inline(always)]
pub(crate) fn placed<T: Float, const N: usize>(hi: T, lo: T, z: &[T; N]) -> [T; N] {
    each_lane!(
        |i| hi + (z[i] + lo),
        T::Pack::splat(hi) + (T::Pack::of(z) + T::Pack::splat(lo))
    )
}

#[inline(always)]
pub(crate) fn times<T: Float, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    each_lane!(|i| a[i] * b[i], T::Pack::of(a) * T::Pack::of(b))
}

#[inline(always)]
pub(crate) fn difference<T: Float, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    each_lane!(|i| a[i] - b[i], T::Pack::of(a) - T::Pack::of(b))
}

#[inline(always)]
pub(crate) fn scaled<T: Float, const N: usize>(a: &[T; N], b: T) -> [T; N] {
    each_lane!(|i| a[i] * b, T::Pack::of(a) * T::Pack::splat(b))
}

/// w·x + b.
#[inline(always)]
pub(crate) fn linear<T: Float, const N: usize>(w: T, x: &[T; N], b: T) -> [T; N] {
    each_lane!(
        |i| w * x[i] + b,
        T::Pack::splat(w) * T::Pack::of(x) + T::Pack::splat(b)
    )
}

#[inline(always)]
pub(crate) fn add<T: Float, const N: usize>(a: &mut [T; N], b: &[T; N]) {
    *a = each_lane!(|i| a[i] + b[i], T::Pack::of(a) + T::Pack::of(b));
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
