//! Shared by the tests: seeded points, and energies of well-known systems.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    dead_code,
    missing_docs,
    unreachable_pub
)]

use equip_autodiff::Energy;
use equip_scalar::{DoubleDouble, Float, Num, Scalar, ratio};

/// xorshift64*, Vigna 2016.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 33) as usize % n
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * (-53_f64).exp2()
    }
}

/// Equal in every bit; any NaN is any other.
pub fn same_bits<T: Float>(a: T, b: T) -> bool {
    let bits = |x: T| x.expansion().map(f64::to_bits);
    bits(a) == bits(b) || (Float::is_nan(a) && Float::is_nan(b))
}

pub fn widened(y: &[f64]) -> Vec<DoubleDouble> {
    y.iter().map(|&x| DoubleDouble::exact(x)).collect()
}

/// An energy as data: number of degrees of freedom and a generic method.
macro_rules! energies {
    ($($(#[$doc:meta])* $name:ident($m:expr): |$q:ident, $p:ident| $h:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name;

        impl Energy for $name {
            fn degrees_of_freedom(&self) -> usize {
                $m
            }
            #[inline(always)]
            fn energy<S: Scalar>(&self, $q: &[Num<S>], $p: &[Num<S>]) -> Num<S> {
                $h
            }
        }
    )*};
}

energies! {
    Kepler(2): |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    };
    HenonHeiles(2): |q, p| {
        let squares = (p[0].powi(2) + p[1].powi(2) + q[0].powi(2) + q[1].powi(2)) / 2.0;
        squares + q[0].powi(2) * q[1] - ratio(1, 3) * q[1].powi(3)
    };
    Pendulum(1): |q, p| p[0] * p[0] / 2.0 - q[0].cos();
    /// Unit masses and lengths: not separable, the mass matrix depends on the angles.
    DoublePendulum(2): |q, p| {
        let c = (q[0] - q[1]).cos();
        let kinetic = (p[0] * p[0] + 2.0 * p[1] * p[1] - 2.0 * p[0] * p[1] * c)
            / (2.0 * (2.0 - c * c));
        kinetic - 2.0 * q[0].cos() - q[1].cos()
    };
    /// In the field of a constant magnetic field and a quadrupole: q and p meet in (p − A(q))².
    ChargedParticle(3): |q, p| {
        let (x, y) = (p[0] + q[1] * 0.5, p[1] - q[0] * 0.5);
        (x * x + y * y + p[2] * p[2]) * 0.5 + q[2].powi(2) - 0.5 * (q[0].powi(2) + q[1].powi(2))
    };
    /// Burrau's three bodies, masses 3, 4, 5.
    Pythagorean(6): |q, p| {
        let masses = [3.0, 4.0, 5.0];
        let mut h = Num::from(0.0);
        for i in 0..3 {
            h += (p[2 * i] * p[2 * i] + p[2 * i + 1] * p[2 * i + 1]) / (2.0 * masses[i]);
            for j in 0..i {
                let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
                h -= masses[i] * masses[j] / (x * x + y * y).sqrt();
            }
        }
        h
    };
}

/// Fermi, Pasta, Ulam, Tsingou: quadratic and quartic springs, fixed ends.
pub struct Chain(pub usize);

impl Energy for Chain {
    fn degrees_of_freedom(&self) -> usize {
        self.0
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let spring = |stretch: Num<S>| stretch.powi(2) / 2.0 + ratio(1, 12) * stretch.powi(4);
        let kinetic: Num<S> = p.iter().map(|p| p.powi(2)).sum();
        let inner: Num<S> = q.windows(2).map(|q| spring(q[1] - q[0])).sum();
        kinetic / 2.0 + inner + spring(q[0]) + spring(q[self.0 - 1])
    }
}
