//! Floats of which only the arithmetic is written: the default functions over double-double against those
//! of double-double, and over 237 bits against the crate f256 and against each other. Largest error measured:
//! 1.6 ε.
#![allow(clippy::unwrap_used)]

use crate::common::Random;
use equip_scalar::{Arithmetic, Constant, DoubleDouble, Float, Own, Pack, Scalar, decimal};
use f256::f256;
use num_traits::{FloatConst, FromPrimitive, ToPrimitive};

struct Pairs;

impl Arithmetic for Pairs {
    type Number = DoubleDouble;
    const NAME: &'static str = "pairs";
    const MANTISSA_BITS: u32 = 106;
    const EPSILON: DoubleDouble = DoubleDouble::EPSILON;
    const MAX: DoubleDouble = DoubleDouble::MAX;
    const MIN_POSITIVE: DoubleDouble = DoubleDouble::MIN_POSITIVE;
    const INFINITY: DoubleDouble = DoubleDouble::INFINITY;
    const NAN: DoubleDouble = DoubleDouble::NAN;

    fn from_f64(x: f64) -> DoubleDouble {
        x.into()
    }
    fn to_f64(x: DoubleDouble) -> f64 {
        x.hi()
    }
}

struct Octuple;

impl Arithmetic for Octuple {
    type Number = f256;
    const NAME: &'static str = "f256";
    const MANTISSA_BITS: u32 = 237;
    const EPSILON: f256 = f256::EPSILON;
    const MAX: f256 = f256::MAX;
    const MIN_POSITIVE: f256 = f256::MIN_POSITIVE;
    const INFINITY: f256 = f256::INFINITY;
    const NAN: f256 = f256::NAN;

    fn from_f64(x: f64) -> f256 {
        x.into()
    }
    /// By its upper 109 bits.
    fn to_f64(x: f256) -> f64 {
        let (upper, lower) = x.to_bits();
        let exponent = (upper >> 108) as i32 & 0x7ffff;
        let fraction = upper & ((1 << 108) - 1);
        let size = match exponent {
            0 => 0.0,
            0x7ffff if fraction != 0 || lower != 0 => f64::NAN,
            _ => {
                let significand = 1 << 108 | fraction | u128::from(lower != 0);
                significand as f64 * 2f64.powi(exponent - 0x3ffff - 108)
            }
        };
        if x.is_sign_negative() { -size } else { size }
    }
}

type Pair = Own<Pairs>;
type Long = Own<Octuple>;

/// Sizes from 10⁻⁴ to 10⁴ with both signs, those beyond `bound` halved until they are within.
fn points(count: usize, bound: f64) -> impl Iterator<Item = DoubleDouble> {
    let mut random = Random(0x5eed_0029);
    (0..count).map(move |_| {
        let mut x = random.log_uniform(-13.0, 13.0);
        while x.hi() > bound {
            x *= DoubleDouble::exact(0.5);
        }
        random.sign(x)
    })
}

#[test]
fn defaults_have_the_digits_of_double_double() {
    macro_rules! check {
        ($($f:ident to $bound:expr;)*) => {$(
            let mut worst = 0.0_f64;
            for x in points(300, $bound) {
                let found = <Pair as Scalar>::$f(Own(x)).0;
                let exact = <DoubleDouble as Scalar>::$f(x);
                if exact.is_nan() {
                    assert!(found.is_nan(), "{} at {x}: {found}", stringify!($f));
                    continue;
                }
                let error = if found == exact { 0.0 } else { ((found - exact) / exact).to_f64().abs() };
                worst = worst.max(error / DoubleDouble::EPSILON.hi());
            }
            println!("{}: {worst:.1} ε", stringify!($f));
            assert!(worst < 2.5, "{}: {worst}", stringify!($f));
        )*};
    }
    check! {
        recip to 1e4; sqrt to 1e4; cbrt to 1e4; exp to 600.0; exp2 to 900.0;
        ln to 1e4; exp_m1 to 600.0; ln_1p to 1e4; sin to 1e4; cos to 1e4; tan to 1e4;
        asin to 2.0; acos to 2.0; atan to 1e4; sinh to 700.0; cosh to 700.0;
        tanh to 1e4; asinh to 1e4; acosh to 1e4; atanh to 2.0; erf to 9.0;
        erfc to 20.0; abs to 1e4;
    }
    let mut worst = 0.0_f64;
    let two: [fn(DoubleDouble, DoubleDouble) -> [DoubleDouble; 2]; 3] = [
        |x, y| [Own::<Pairs>(x).atan2(Own(y)).0, x.atan2(y)],
        |x, y| [Own::<Pairs>(x).hypot(Own(y)).0, x.hypot(y)],
        |x, y| {
            let (x, y) = (x.abs(), y * DoubleDouble::exact(1e-3));
            let loss = DoubleDouble::ONE + (y * x.ln()).abs();
            let [found, exact] = [Own::<Pairs>(x).powf(Own(y)).0, x.powf(y)];
            [exact + (found - exact) / loss, exact]
        },
    ];
    for (x, y) in points(300, 1e4).zip(points(600, 1e4).skip(300)) {
        for f in two {
            let [found, exact] = f(x, y);
            let error = ((found - exact) / exact).to_f64().abs();
            worst = worst.max(error / DoubleDouble::EPSILON.hi());
        }
    }
    println!("of two numbers: {worst:.1} ε");
    assert!(worst < 2.5, "{worst}");
}

/// In units of 2⁻²³⁶.
fn units(found: Long, exact: Long) -> f64 {
    ((found - exact) / exact).to_f64().abs() / Octuple::to_f64(f256::EPSILON)
}

#[test]
fn defaults_have_71_digits() {
    macro_rules! check {
        ($($f:ident to $bound:expr;)*) => {$(
            let mut worst = 0.0_f64;
            for x in points(12, $bound) {
                let x = Long::exact(x.hi()) + Long::exact(x.lo()) + Long::exact(x.lo() * 3e-20);
                let (found, exact) = (x.$f(), Own(x.0.$f()));
                if !(Float::is_nan(found) && Float::is_nan(exact)) {
                    worst = worst.max(units(found, exact));
                }
            }
            println!("{}: {worst:.1} ε", stringify!($f));
            assert!(worst < 2.5, "{}: {worst}", stringify!($f));
        )*};
    }
    check! {
        sqrt to 1e4; cbrt to 1e4; exp to 600.0; ln to 1e4; sin to 1e4; cos to 1e4; tan to 1e4; asin to 0.9; acos to 0.9;
        atan to 1e4;
    }
    // What f256 does not have, by identities.
    let one = Long::int(1);
    for x in [0.3, 0.7, 1.9] {
        let x = Long::exact(x);
        let halved = (x.exp() - (-x).exp()) / Long::int(2);
        assert!(units(x.sinh(), halved) < 12.0);
        assert!(units(x.sinh() / x.cosh(), x.tanh()) < 12.0);
        assert!(units(x.sinh().asinh(), x) < 12.0);
        assert!(units(x.cosh().acosh(), x) < 24.0);
        assert!(units(x.tanh().atanh(), x) < 48.0);
        assert!(units(x.exp_m1().ln_1p(), x) < 12.0);
        assert!(units(x.erf() + x.erfc(), one) < 12.0);
    }
}

/// Against 100 digits by mpmath 1.3.
#[test]
fn the_error_function_has_71_digits() {
    for (found, text) in [
        (Long::exact(0.5).erf(), ERF_HALF),
        (Long::exact(2.0).erfc(), ERFC_2),
        (Long::exact(10.0).erfc(), ERFC_10),
    ] {
        let error = units(found, Long::decimal(text).unwrap());
        println!("{error:.1} ε");
        assert!(error < 2.5, "{text}: {error}");
    }
}

const ERF_HALF: &str = "0.52049987781304653768274665389196452873645157575796370\
    0058805725647193521716853570914788218734787757";
const ERFC_2: &str = "0.00467773498104726583793074363274707138910820295993992\
    3261647673799562719280004822632370991980319319512";
const ERFC_10: &str = "2.08848758376254475700078629495778861156081811932116372\
    7012213713938174695833440290610766384285723554e-45";

#[test]
fn constants_and_decimals_are_exact() {
    let close = |found: Long, exact: f256| units(found, Own(exact)) < 4.0;
    assert!(close(Long::PI(), ::f256::consts::PI));
    assert!(close(Long::LN_2(), ::f256::consts::LN_2));
    assert!(close(Long::LN_10(), ::f256::consts::LN_10));
    assert!(close(Long::E(), ::f256::consts::E));
    assert_eq!(Pair::PI().0, DoubleDouble::PI);
    assert_eq!(Pair::LN_2().0, DoubleDouble::LN_2);

    let tenth = Long::ratio(1, 10);
    assert_eq!(Long::decimal("0.1").unwrap(), tenth);
    assert_eq!(decimal("0.1").unwrap().to::<Long>(), tenth);
    assert_eq!(Constant::from(tenth).to::<Long>(), tenth);
    assert_eq!(tenth.to_string(), "0.1");
    let third = Long::ratio(1, 3);
    for text in [third.to_string(), format!("{third:e}")] {
        assert_eq!(text.parse::<Long>().unwrap(), third, "{text}");
    }
    assert_eq!(format!("{third:.3} {third:.2e}"), "0.333 3.33e-1");
    assert_eq!(Long::from_expansion(third.expansion()), third);
    assert!("0.1x".parse::<Long>().is_err());
    assert!(Float::is_nan("NaN".parse::<Long>().unwrap()));
}

#[test]
fn integers_remainders_and_signs() {
    let n = (1_i128 << 100) + 1;
    let x = Long::from_i128(n).unwrap();
    assert_eq!(x.to_i128(), Some(n));
    assert_eq!(Long::int(i64::MAX) - Long::int(i64::MAX - 1), Long::int(1));
    assert_eq!(x % Long::int(7), Long::int((n % 7) as i64));
    let whole = |x: f64| num_traits::Float::round(Long::exact(x)).to_f64();
    assert_eq!([2.5, -2.5, 0.49, -0.0].map(whole), [3.0, -3.0, 0.0, 0.0]);
    let near = x - Long::exact(1e-20);
    assert_eq!(num_traits::Float::floor(near), x - Long::int(1));
    let negative_zero = -Long::int(0);
    assert!(num_traits::Float::is_sign_negative(negative_zero));
    let back = Long::from_expansion(negative_zero.expansion());
    assert!(num_traits::Float::is_sign_negative(back));
    assert_eq!(Scalar::ln(Long::int(0)), -Long::INFINITY);
    assert_eq!(Scalar::exp(Long::exact(1e9)), Long::INFINITY);
    assert_eq!(Scalar::atan2(Long::int(0), Long::int(-1)), Long::PI());
}

/// A pack of them is as many numbers.
#[test]
fn packs_are_numbers_one_by_one() {
    let x = [1, 2, 3].map(|n| Long::ratio(n, 7));
    type Three = <Long as Float>::Pack<3>;
    let y = Scalar::sin(Three::of(&x) * Three::splat(Long::int(2)));
    assert_eq!(y.numbers(), x.map(|x| (x * Long::int(2)).sin()));
    let (sum, lost) = Three::total(&[x, x]);
    assert!(units(sum + lost, Long::ratio(12, 7)) < 2.0);
}
