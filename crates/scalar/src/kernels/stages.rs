//! Z = K L for all components at once: the linear half of a stage iteration.

use super::instructions::{InstructionSet, Kernel};
use super::lanes::Lanes;
use crate::traits::{Float, Pack};

/// Z_i = Σ_j K_ij L_j for every component, with i and j from 0 to `stages` − 1.
///
/// Layout: component c of stage i is at `c·stride + i` in `l` and `z`; K is stored **column by column**,
/// `k[j·stride + i]` = K_ij, with `stages` ≤ `stride`. If the padding of K is finite, so is that of `z`; the
/// padding of `l` is not used. The sum runs over j = 0, 1, …, with fused products for doubles and one dot
/// product for double-doubles ([`Pack::dot`]), with the same bits on every instruction set. Cost: s² products
/// for each component; 8 stages fill vectors of 8 doubles.
///
/// # Panics
/// If `l` and `z` differ in length, or `k` has fewer than `stages` columns.
///
/// ```
/// use equip_scalar::{InstructionSet, mix_stages};
/// let k = [0.5, 3.0, /* column 2 */ 1.0, 4.0];
/// let mut z = [0.0; 2];
/// mix_stages(InstructionSet::best(), &k, &[10.0, 1.0], &mut z, 2, 2);
/// assert_eq!(z, [6.0, 34.0]);
/// ```
pub fn mix_stages<T: Float>(
    set: InstructionSet,
    k: &[T],
    l: &[T],
    z: &mut [T],
    stages: usize,
    stride: usize,
) {
    assert!(
        l.len() == z.len() && stages > 0 && stages <= stride && k.len() >= stages * stride,
        "K has {stages} columns of {stride} places, L and Z as many places as each other"
    );
    (ready::<T>().mix)(set, [&k[..stages * stride], l], z, [stages, stride]);
}

/// The function, compiled once with this crate for `f64` and double-double.
pub(crate) struct Ready<T: Float> {
    #[expect(clippy::type_complexity, reason = "the signature is what it is")]
    mix: fn(InstructionSet, [&[T]; 2], &mut [T], [usize; 2]),
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready { mix };
}

crate::ready!(Ready);

fn mix<T: Float>(
    set: InstructionSet,
    [k, l]: [&[T]; 2],
    z: &mut [T],
    [stages, stride]: [usize; 2],
) {
    if const { T::IS_DOUBLE } {
        let doubles = (T::as_doubles(k), T::as_doubles(l), T::as_doubles_mut(z));
        if let (Some(k), Some(l), Some(z)) = doubles {
            set.run(&mut Mix {
                k,
                l,
                z,
                stages,
                stride,
            });
        }
    } else {
        set.run(&mut MixPacks {
            k,
            l,
            z,
            stages,
            stride,
        });
    }
}

/// One component after the other, in floats that are not `f64`.
struct MixPacks<'a, T> {
    k: &'a [T],
    l: &'a [T],
    z: &'a mut [T],
    stages: usize,
    stride: usize,
}

impl<T: Float> Kernel for MixPacks<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        if T::WIDTH > 1 && self.stride.is_multiple_of(8) {
            self.packs::<8>();
        } else {
            self.packs::<1>();
        }
    }
}

impl<T: Float> MixPacks<'_, T> {
    #[inline(always)]
    fn packs<const N: usize>(&mut self) {
        let groups = self.stride / N;
        let (k, z) = (self.k.as_chunks::<N>().0, self.z.as_chunks_mut::<N>().0);
        let mut columns = [T::Pack::splat(T::int(0)); BLOCK];
        for g in 0..groups {
            for first in (0..self.stages).step_by(BLOCK) {
                let count = BLOCK.min(self.stages - first);
                for (j, column) in columns[..count].iter_mut().enumerate() {
                    *column = T::Pack::of(&k[(first + j) * groups + g]);
                }
                let rows = self
                    .l
                    .chunks_exact(self.stride)
                    .zip(z.chunks_exact_mut(groups));
                for (l, z) in rows {
                    let sum = T::Pack::dot(|j| columns[j], &l[first..][..count]);
                    z[g] = if first == 0 {
                        sum.numbers()
                    } else {
                        (T::Pack::of(&z[g]) + sum).numbers()
                    };
                }
            }
        }
    }
}

/// Columns that are put into packs at a time.
const BLOCK: usize = 32;

struct Mix<'a> {
    k: &'a [f64],
    l: &'a [f64],
    z: &'a mut [f64],
    stages: usize,
    stride: usize,
}

impl Kernel for Mix<'_> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        if self.stride == 4 {
            self.rows::<4>();
        } else {
            self.rows::<8>();
        }
    }
}

impl Mix<'_> {
    /// N stages at a time.
    #[inline(always)]
    fn rows<const N: usize>(&mut self) {
        let Mix { k, l, z, .. } = self;
        let (stages, stride) = (self.stages, self.stride);
        for (l, z) in l.chunks_exact(stride).zip(z.chunks_exact_mut(stride)) {
            for at in (0..stride).step_by(N) {
                let mut sum = Lanes::<N>::load(&k[at..stride]) * Lanes::splat(l[0]);
                for j in 1..stages {
                    let column = &k[j * stride + at..(j + 1) * stride];
                    sum = Lanes::<N>::load(column).fused(l[j], sum);
                }
                sum.store(&mut z[at..]);
            }
        }
    }
}
