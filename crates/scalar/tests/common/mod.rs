//! Seeded arguments, and a reference of 320 and more bits.
#![allow(clippy::unwrap_used, clippy::expect_used, dead_code, unreachable_pub)] // Every test crate uses its own part.

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
        let half = (k / 2.0).floor() as i32; // 2^k itself may be subnormal
        let hi = (1.0 + self.unit()) * 2f64.powi(half) * 2f64.powi(k as i32 - half);
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
    if b == 0.0 {
        from_double(a)
    } else {
        from_double(a).add_full_prec(&from_double(b))
    }
}

/// A double, exactly. (`BigFloat::from_f64` of astro-float 0.9.6 returns half of a subnormal number.)
pub fn from_double(x: f64) -> BigFloat {
    if x == 0.0 || x.is_normal() {
        return BigFloat::from_f64(x, 64);
    }
    let scale = BigFloat::from_f64(2f64.powi(-200), 64);
    BigFloat::from_f64(x * 2f64.powi(200), 64).mul_full_prec(&scale)
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

/// |computed − exact| / |exact| in units of 2⁻¹⁰⁴; twice the smallest subnormal number is free.
pub fn error(computed: DoubleDouble, exact: &BigFloat) -> f64 {
    assert!(
        computed.is_finite(),
        "{computed:?} instead of {}",
        double(exact)
    );
    let floor = from_double(5e-324).add_full_prec(&from_double(5e-324));
    let distance = big(computed)
        .sub_full_prec(exact)
        .abs()
        .sub_full_prec(&floor);
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
