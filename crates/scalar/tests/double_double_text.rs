//! Decimals: every finite `DoubleDouble` survives printing and parsing, and parsing rounds correctly.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{RM, Random, big, consts};
use equip_scalar::{DoubleDouble, Float};

fn same(x: DoubleDouble, y: DoubleDouble) -> bool {
    x.hi().to_bits() == y.hi().to_bits() && x.lo().to_bits() == y.lo().to_bits()
        || x == y && x.hi() != 0.0
}

fn parse(text: &str) -> DoubleDouble {
    text.parse().unwrap_or(DoubleDouble::NAN)
}

#[test]
fn every_value_survives_printing() {
    let mut random = Random(1);
    let check = |x: DoubleDouble| {
        for text in [format!("{x}"), format!("{x:e}")] {
            assert!(same(parse(&text), x), "{x:?} printed as {text}");
        }
    };
    for i in 0..12_000 {
        let x = match i % 6 {
            0 => random.log_uniform(-1074.0, 1023.0),
            1 => random.log_uniform(-30.0, 30.0),
            2 => DoubleDouble::from(random.unit()),
            3 => DoubleDouble::from_i64(random.bits() as i64),
            4 => DoubleDouble::from_i64(random.bits() as i64 >> 40) / DoubleDouble::from(1000.0),
            // Any two doubles, far apart.
            _ => DoubleDouble::new(
                random.unit(),
                random.unit() * 2f64.powi(-55 - (random.bits() % 900) as i32),
            ),
        };
        check(random.sign(x));
    }
    for x in [
        DoubleDouble::ZERO,
        -DoubleDouble::ZERO,
        DoubleDouble::MAX,
        DoubleDouble::MIN,
    ] {
        check(x);
    }
    check(DoubleDouble::from(5e-324));
    check(DoubleDouble::new(f64::MAX, 5e-324));
    check(DoubleDouble::new(1.0, -5e-324));
}

/// hi and lo are each the nearest double to what they stand for.
#[test]
fn parsing_is_correctly_rounded() {
    let (mut random, mut consts) = (Random(2), consts());
    for _ in 0..3000 {
        let digits = 1 + random.bits() % 60;
        let mut text: String = (0..digits)
            .map(|_| char::from(b'0' + (random.bits() % 10) as u8))
            .collect();
        text.insert((random.bits() % digits) as usize, '.');
        text = format!("{text}e{}", random.bits() as i32 % 240);
        let exact =
            astro_float::BigFloat::parse(&text, astro_float::Radix::Dec, 2400, RM, &mut consts);
        let x = parse(&text);
        if exact.is_zero() {
            assert_eq!(x, DoubleDouble::ZERO);
            continue;
        }
        assert_eq!(x.hi(), text.parse().unwrap_or(f64::NAN), "{text}");
        let distance = exact.sub(&big(x), 2400, RM).abs();
        let half_unit =
            crate::common::double(&distance) <= x.lo().abs() * f64::EPSILON * 0.5 + 3e-324;
        assert!(half_unit, "{text} gave {x:?}");
    }
}

#[test]
fn accepts_what_f64_accepts() {
    for text in [
        "0",
        "-0",
        "+1",
        "1.",
        ".5",
        "1e3",
        "1E+3",
        "-1.5e-3",
        "inf",
        "-inf",
        "+infinity",
        "Infinity",
        "NaN",
        "-nan",
        "1e400",
        "1e-400",
        "-1e99999999999999999999",
        "0e99999999999999999999",
        "00012.50",
        "2.2250738585072014e-308",
        "",
        ".",
        "e5",
        "1e",
        "1e+",
        "+",
        "--1",
        "1.2.3",
        " 1",
        "1 ",
        "0x10",
        "1_000",
        "infin",
        "1f",
        "é",
        "-é",
        "1e5.0",
    ] {
        let ours = text.parse::<DoubleDouble>();
        match text.parse::<f64>() {
            Ok(x) => {
                let y = ours.unwrap_or_else(|error| panic!("{error}"));
                assert!(
                    y.hi().to_bits() == x.to_bits() || y.is_nan() && x.is_nan(),
                    "{text}: {y:?}"
                );
            }
            Err(_) => assert!(ours.is_err(), "{text}: {ours:?}"),
        }
    }
    assert_eq!(
        <DoubleDouble as Float>::decimal(" 0.5 "),
        Ok(DoubleDouble::from(0.5))
    );
    let ones = format!("0.{}", "1".repeat(5000));
    assert_eq!(parse(&ones), DoubleDouble::ONE / DoubleDouble::from(9.0));
}

/// Where `f64` is exact, so are we, character by character.
#[test]
fn formats_as_f64_does() {
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        0.5,
        2.5,
        1234.5625,
        1e15,
        0.001953125,
        9.96875,
        99.5,
        f64::INFINITY,
        f64::NAN,
    ];
    for x in values {
        let y = DoubleDouble::from(x);
        assert_eq!(format!("{y}"), format!("{x}"));
        assert_eq!(format!("{y:e}"), format!("{x:e}"));
        assert_eq!(
            format!("{y:.0} {y:.1} {y:.3} {y:.40}"),
            format!("{x:.0} {x:.1} {x:.3} {x:.40}")
        );
        assert_eq!(
            format!("{y:.0e} {y:.2e} {y:.40e}"),
            format!("{x:.0e} {x:.2e} {x:.40e}")
        );
        assert_eq!(
            format!("{y:12.2}|{y:<12.2}|{y:+.1}|{y:^9}|{y:14.3e}"),
            format!("{x:12.2}|{x:<12.2}|{x:+.1}|{x:^9}|{x:14.3e}")
        );
        assert_eq!(format!("{y:010.2}"), format!("{x:010.2}"));
    }
}

#[test]
fn reads_well() {
    let text = |x: DoubleDouble| x.to_string();
    assert_eq!(text(parse("0.1")), "0.1");
    assert_eq!(text(parse("6.02214076e23")), "602214076000000000000000");
    assert_eq!(text(parse("1e-6")), "0.000001");
    assert_eq!(text(parse("-1e300")), "-1e300");
    assert_eq!(text(parse("2.5e-10")), "2.5e-10");
    assert_eq!(text(DoubleDouble::PI), "3.1415926535897932384626433832795");
    assert_eq!(
        format!("{:.30}", DoubleDouble::PI),
        "3.141592653589793238462643383280"
    );
    // The double 0.1 is another number than 1/10.
    assert_eq!(
        text(DoubleDouble::from(0.1)),
        "0.1000000000000000055511151231257827021181583404541015625"
    );
}
