//! Seeded arguments, and a reference of 320 and more bits.
#![allow(dead_code)] // Every test crate uses its own part.

use astro_float::{BigFloat, Consts, RoundingMode, Sign};
use equip_scalar::DoubleDouble;

pub const RM: RoundingMode = RoundingMode::ToEven;
pub const BITS: usize = 320;

/// Steele, Lea, Flood: splitmix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [a, b), with a random lower part.
    pub fn between(&mut self, a: f64, b: f64) -> DoubleDouble {
        let hi = a + (b - a) * self.unit();
        self.with_tail(hi)
    }

    /// `hi` with a random lower part: mostly full, sometimes short, sometimes none.
    pub fn with_tail(&mut self, hi: f64) -> DoubleDouble {
        let ulp = hi.abs() * f64::EPSILON;
        let tail = match self.bits() % 8 {
            0 => 0.0,
            1 => self.unit() * 2f64.powi(-(self.bits() as i32 & 63)),
            _ => self.unit(),
        };
        let sign = if self.bits() & 1 == 0 { 0.5 } else { -0.5 };
        DoubleDouble::new(hi, sign * ulp * tail)
    }

    /// 2^k with k uniform in [a, b) times a random significand, positive.
    pub fn log_uniform(&mut self, a: f64, b: f64) -> DoubleDouble {
        let k = (a + (b - a) * self.unit()).floor();
        let hi = (1.0 + self.unit()) * 2f64.powi(k as i32);
        self.with_tail(hi)
    }

    pub fn sign(&mut self, x: DoubleDouble) -> DoubleDouble {
        if self.bits() & 1 == 0 { x } else { -x }
    }
}

/// The number, exactly.
pub fn big(x: DoubleDouble) -> BigFloat {
    sum(x.hi(), x.lo())
}

pub fn sum(a: f64, b: f64) -> BigFloat {
    let bits = 2240; // holds any sum of two doubles
    BigFloat::from_f64(a, 64).add(&BigFloat::from_f64(b, 64), bits, RM)
}

/// To a double, by the leading 64 bits.
pub fn double(x: &BigFloat) -> f64 {
    if x.is_zero() {
        return 0.0;
    }
    let Some((words, _, sign, exponent, _)) = x.as_raw_parts() else {
        return if x.is_nan() {
            f64::NAN
        } else if x.is_positive() {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
    };
    let top = words.last().map_or(0.0, |&w| w as f64 / 2f64.powi(64));
    let half = exponent / 2;
    let size = top * 2f64.powi(half) * 2f64.powi(exponent - half);
    if sign == Sign::Neg { -size } else { size }
}

/// |computed − exact| / |exact| in units of 2⁻¹⁰⁴; one and a half of the smallest subnormal number is free.
pub fn error(computed: DoubleDouble, exact: &BigFloat) -> f64 {
    assert!(
        computed.is_finite(),
        "{computed:?} instead of {}",
        double(exact)
    );
    let distance = big(computed).sub(exact, 2240, RM).abs();
    let floor = BigFloat::from_f64(7.5e-324, 64);
    let distance = distance.sub(&floor, 2240, RM);
    if distance.is_zero() || distance.is_negative() {
        return 0.0;
    }
    double(&distance.div(&exact.abs(), 128, RM)) * 2f64.powi(104)
}

/// The largest error of a function, and where it was.
pub struct Worst {
    name: &'static str,
    error: f64,
    at: [DoubleDouble; 2],
    count: usize,
}

impl Worst {
    pub fn new(name: &'static str) -> Self {
        Worst {
            name,
            error: 0.0,
            at: [DoubleDouble::ZERO; 2],
            count: 0,
        }
    }

    pub fn record(&mut self, at: [DoubleDouble; 2], error: f64) {
        self.count += 1;
        assert!(!error.is_nan(), "{} at {at:?}", self.name);
        if error > self.error {
            self.error = error;
            self.at = at;
        }
    }

    /// Asserts that the worst error is at most `bound`, in units of 2⁻¹⁰⁴.
    pub fn assert(&self, least: usize, bound: f64) {
        println!(
            "{:8} {:6} arguments, largest error {:.3} at {:?}",
            self.name, self.count, self.error, self.at
        );
        assert!(
            self.count >= least,
            "{}: only {} arguments",
            self.name,
            self.count
        );
        assert!(
            self.error <= bound,
            "{}: {} > {bound} at {:?}",
            self.name,
            self.error,
            self.at
        );
    }
}

pub fn consts() -> Consts {
    Consts::new().unwrap()
}
