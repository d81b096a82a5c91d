//! [`Lanes`] as words: N algorithms side by side.

use super::transforms::Word;
use crate::kernels::Lanes;

impl<const N: usize> Word for Lanes<N> {
    #[inline(always)]
    fn word(x: f64) -> Self {
        Lanes::splat(x)
    }

    /// A vector instruction inside a kernel for AVX2 or AVX-512, elsewhere N calls.
    #[inline(always)]
    fn product_rest(a: Self, b: Self, p: Self) -> Self {
        let mut rest = p;
        for k in 0..N {
            rest.0[k] = a.0[k].mul_add(b.0[k], -p.0[k]);
        }
        rest
    }

    #[inline(always)]
    fn unless_zero(mut self, test: Self, other: Self) -> Self {
        for k in 0..N {
            self.0[k] = self.0[k].unless_zero(test.0[k], other.0[k]);
        }
        self
    }
}
