//! What the tests share: every check is a generic function that runs in each float type.

/// Runs each check in `f64` and in [`DoubleDouble`](equip_scalar::DoubleDouble).
macro_rules! in_every_float {
    ($($check:ident),* $(,)?) => {
        mod in_f64 {
            $(#[test]
            fn $check() {
                super::$check::<f64>();
            })*
        }
        mod in_dd {
            $(#[test]
            fn $check() {
                super::$check::<equip_scalar::DoubleDouble>();
            })*
        }
    };
}
pub(crate) use in_every_float;

use equip_scalar::Float;

/// Asserts a residual of at most `bound` ε; the measured one is printed, for stating bounds.
pub(crate) fn within<T: Float>(what: &str, residual: T, bound: f64) {
    let measured = (residual / T::EPSILON).to_f64();
    println!("{what}: {measured:.2} eps of {}", T::NAME);
    assert!(
        measured <= bound,
        "{what}: {measured} eps of {}, bound {bound}",
        T::NAME
    );
}

/// A seeded generator: splitmix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in (−1, 1), with all bits of the type in use.
    pub(crate) fn symmetric<T: Float>(&mut self) -> T {
        let bits = T::int(1 << 53);
        let mut digit = || T::int((self.next() >> 11) as i64) / bits;
        let (high, low) = (digit(), digit());
        T::int(2) * (high + low / bits) - T::int(1)
    }

    /// n numbers of the given size, about every fourth one zero.
    pub(crate) fn alphas<T: Float>(&mut self, n: usize, size: T) -> Vec<T> {
        (0..n)
            .map(|_| {
                if self.next().is_multiple_of(4) {
                    T::int(0)
                } else {
                    size * self.symmetric()
                }
            })
            .collect()
    }
}
