//! The memory layout of a component at the stages: a *row* is G groups of N lanes, one lane for each stage,
//! followed by padding.
//!
//! Rows are arrays in memory and [`Pack`]s in arithmetic. The compiler turns packs into vector instructions
//! of the instruction set in use.

use equip_scalar::{Float, Pack};
use std::array::from_fn;

/// The number of lanes to which `s` stages of this type are padded.
pub fn stride_for<T: Float>(s: usize) -> usize {
    s.next_multiple_of(lanes_of::<T>(s))
}

/// The number of lanes processed together.
#[inline(always)]
pub(crate) fn lanes_of<T: Float>(s: usize) -> usize {
    match T::WIDTH {
        1 => 1,
        _ if T::IS_DOUBLE && s <= 4 => 4,
        _ => 8,
    }
}

/// A task's `groups` for the number of lanes and groups that `s` stages of the float stand in, both of them
/// literals, so that loops over groups are unrolled. [`stride_for`] must be in scope.
macro_rules! by_groups {
    ($float:ty, $s:expr, $task:ident) => {
        match stride_for::<$float>($s) {
            s if const { <$float as Float>::WIDTH == 1 } => $task.groups::<1>(s),
            4 => $task.groups::<4>(1),
            8 => $task.groups::<8>(1),
            16 => $task.groups::<8>(2),
            stride => $task.groups::<8>(stride / 8),
        }
    };
}
pub(crate) use by_groups;

/// # Panics
/// If the slice is shorter than the fixed length.
#[inline(always)]
pub(crate) fn literal<R>(found: Option<R>) -> R {
    match found {
        Some(found) => found,
        None => panic!(
            "an iteration by literal lengths has as many components and stages as it was made for"
        ),
    }
}

/// A row to be read from memory number by number, although it has just been written: to extract numbers from
/// a vector the processor would use the units that multiply and add.
#[inline(always)]
pub(crate) fn in_memory<R>(row: &mut R) -> &R {
    std::hint::black_box(row)
}

/// A row that begins on a cache line: loads across two lines that were just written are slow.
#[repr(align(64))]
pub(crate) struct OnLines<R>(pub(crate) R);

/// Computes `f64` lane by lane, which the compiler vectorises better if many rows are processed, and other
/// types in packs.
macro_rules! each_lane {
    (|$i:ident| $number:expr, $pack:expr) => {
        if T::IS_DOUBLE {
            from_fn(|$i| $number)
        } else {
            ($pack).numbers()
        }
    };
}

/// y0 + Z of a component, with y0 = hi + lo.
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

/// a x + b, with a single rounding for `f64`. It is a loop because a closure is not always inlined, and
/// `mul_add` would then be a library call.
#[inline(always)]
pub(crate) fn fused<T: Float, const N: usize>(a: &[T; N], x: T, b: &[T; N]) -> [T; N] {
    fused_each(a, &[x; N], b)
}

/// The same with one x for each lane.
#[inline(always)]
pub(crate) fn fused_each<T: Float, const N: usize>(a: &[T; N], x: &[T; N], b: &[T; N]) -> [T; N] {
    if !T::IS_DOUBLE {
        return (T::Pack::of(a) * T::Pack::of(x) + T::Pack::of(b)).numbers();
    }
    let mut sums = *b;
    for i in 0..N {
        sums[i] = a[i].mul_add(x[i], sums[i]);
    }
    sums
}

/// Σ_j a_j x_j over `s` columns. Even and odd j are summed separately, which shortens the chain of dependent
/// operations.
#[inline(always)]
pub(crate) fn dot<'a, T: Float, const N: usize>(
    s: usize,
    column: impl Fn(usize) -> &'a [T; N],
    x: &[T],
) -> [T; N] {
    let mut even = scaled(column(0), x[0]);
    if s == 1 {
        return even;
    }
    let mut odd = scaled(column(1), x[1]);
    let mut j = 2;
    while j + 1 < s {
        even = fused(column(j), x[j], &even);
        odd = fused(column(j + 1), x[j + 1], &odd);
        j += 2;
    }
    if j < s {
        even = fused(column(j), x[j], &even);
    }
    add(&mut even, &odd);
    even
}

/// The lane-wise maximum of `size` and |x|.
#[inline(always)]
pub(crate) fn larger<T: Float, const N: usize>(size: &mut [T; N], x: &[T; N]) {
    for i in 0..N {
        let x = x[i].abs();
        size[i] = if x > size[i] { x } else { size[i] };
    }
}

/// The maximum over all lanes.
#[inline(always)]
pub(crate) fn largest<T: Float, const N: usize>(mut x: [T; N]) -> T {
    let mut count = N;
    while count > 1 {
        count /= 2;
        for i in 0..count {
            x[i] = if x[i + count] > x[i] {
                x[i + count]
            } else {
                x[i]
            };
        }
    }
    x[0]
}

#[cfg(test)]
mod tests {
    use super::dot;
    use equip_scalar::{InstructionSet, Kernel};

    struct Dot<'a> {
        columns: &'a [[f64; 8]],
        x: &'a [f64],
    }

    impl Kernel for Dot<'_> {
        type Output = [f64; 8];

        #[inline(always)]
        fn run(&mut self) -> [f64; 8] {
            dot(self.columns.len(), |j| &self.columns[j], self.x)
        }
    }

    /// Products that cancel completely if rounded separately, and irregular ones in the documented order.
    #[test]
    fn products_are_fused_on_every_instruction_set() {
        let e = 2.0_f64.powi(-30);
        let columns = [[1.0; 8], [0.0; 8], [1.0 + e; 8]];
        for set in InstructionSet::available() {
            let (columns, x) = (&columns, &[-1.0, 0.0, 1.0 - e]);
            assert_eq!(set.run(&mut Dot { columns, x }), [-e * e; 8], "{set:?}");
        }
        for s in 1..=17 {
            let number = |k: usize| ((k * k + 5 * k) as f64 * 0.731).sin();
            let columns: Vec<[f64; 8]> = (0..s)
                .map(|j| std::array::from_fn(|i| number(8 * j + i)))
                .collect();
            let x: Vec<f64> = (0..s).map(|j| number(3 * j + 1)).collect();
            let chain = |i: usize, first: usize| {
                let mut sum = columns[first][i] * x[first];
                for j in (first + 2..s).step_by(2) {
                    sum = columns[j][i].mul_add(x[j], sum);
                }
                sum
            };
            for set in InstructionSet::available() {
                let found = set.run(&mut Dot {
                    columns: &columns,
                    x: &x,
                });
                for (i, found) in found.into_iter().enumerate() {
                    let odd = if s > 1 { chain(i, 1) } else { 0.0 };
                    assert_eq!(found, chain(i, 0) + odd, "s = {s}, {set:?}");
                }
            }
        }
    }
}
