//! Splines against SciPy 1.17.1 (`CubicSpline`), and against the functions they go through.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.
#![allow(clippy::excessive_precision)] // Digits of another program.

use equip_scalar::{DoubleDouble, Num};
use equip_tables::Table;

const X: [f64; 7] = [0.0, 0.7, 1.0, 2.5, 2.75, 4.0, 6.0];
const Y: [f64; 7] = [1.0, -0.5, 0.25, 2.0, 1.5, -1.0, 0.5];
/// Inside, at knots, and beyond both ends, where the polynomials of the end intervals go on.
const AT: [f64; 9] = [0.35, 0.7, 0.9, 2.6, 3.3, 5.9, 6.0, -0.5, 7.25];

#[rustfmt::skip]
const NATURAL: [[f64; 4]; 9] = [
    [-0.1830498921700882, -2.55528561159056, 7.070202321144298, 20.20057806041227],
    [-0.5, 1.156570607010196, 14.140404642288594, -51.84208689023238],
    [-0.055000568272498565, 2.9478097976632673, 3.7719872642421155, -51.84208689023238],
    [1.8215996221753599, -1.9685469712497872, -3.150254368943507, 16.218284733728495],
    [0.2245194406541383, -2.2425921344741666, 0.7758290729304186, 2.7151649669357294],
    [0.3360082187196347, 1.6354570718873465, 0.13382222748927086, -1.3382222748927144],
    [0.49999999999999956, 1.642148183261809, 0.0, -1.3382222748927144],
    [2.475440132636818, -1.2674987602392802, -10.100289030206131, 20.20057806041227],
    [2.1170659989689558, 0.5966620310018742, -1.6727778436158927, -1.3382222748927144],
];
#[rustfmt::skip]
const CLAMPED: [[f64; 4]; 9] = [
    [0.25849714260438805, -3.440008163987463, -0.13872885884714492, 63.53392756556673],
    [-0.5, 0.40288979880699594, 22.098145789101196, -81.17411114481176],
    [-0.08569127264965903, 3.1990367337310004, 5.863323560138838, -81.17411114481176],
    [1.823222305125872, -1.9493104236174303, -3.274428065918512, 10.687242948134681],
    [0.11640312243453693, -2.4467868122535643, 1.211182853098776, 5.240953594176524],
    [0.6681291053735716, -1.3721194204327176, -5.9926864068344985, -5.722387776766758],
    [0.4999999999999991, -2.0, -6.564925184511172, -5.722387776766758],
    [-3.370573929298744, 19.62954269909359, -54.142567289578864, 63.53392756556673],
    [-8.991604238148952, -14.676771931237992, -13.717909905469618, -5.722387776766758],
];
#[rustfmt::skip]
const CURVED: [[f64; 4]; 9] = [
    [-0.24229477428725002, -2.4367093088450003, 8.03746570264898, 14.392759150425661],
    [-0.5, 1.2579601850457147, 13.07493140529796, -47.94665972269396],
    [-0.05083821451515631, 2.914013271651428, 3.4855994607591647, -47.94665972269396],
    [1.822214403853708, -1.9654799758601782, -3.225440438533535, 15.811195482348495],
    [0.20730619404990833, -2.2734326314867155, 0.8464427924615234, 3.0912798338959706],
    [0.3866562390167254, 1.1767537120390954, -0.7994830661905654, -2.005169338094352],
    [0.49999999999999956, 1.0867795587295674, -1.0, -2.005169338094352],
    [3.2592837544370843, -4.069170913005363, -4.196379575212832, 14.392759150425661],
    [0.42450005450103667, -1.7297589866566465, -3.50646167261794, -2.005169338094352],
];
#[rustfmt::skip]
const NOT_A_KNOT: [[f64; 4]; 9] = [
    [-0.6212167232077641, -1.677523722537505, 14.223946501351254, -22.791840995247544],
    [-0.5, 1.904857291976521, 6.246802153014625, -22.791840995247682],
    [-0.024481619871400025, 2.6983809026744923, 1.6884339539650872, -22.791840995247682],
    [1.82117404328656, -1.9795988766340031, -3.157732577691586, 20.07160836901454],
    [0.2866698054225091, -2.1228357457794167, 0.5274183163645318, 1.2261993430980622],
    [0.14191738475673765, 3.393005656439822, 3.715536608419498, 1.226199343098064],
    [0.49999999999999956, 3.770690313997261, 3.838156542729304, 1.226199343098064],
    [8.275919006429989, -22.001430808219247, 33.597011347311664, -22.791840995247544],
    [8.611076123501912, 9.526354229204253, 5.370905721601884, 1.226199343098064],
];

fn distance(table: &Table, expected: &[[f64; 4]; 9]) -> f64 {
    let mut worst = 0.0_f64;
    for (&x, expected) in AT.iter().zip(expected) {
        let found = match table.derivatives(x) {
            Ok(found) => found,
            Err(_) => {
                let [value, slope] = [table.at(Num(x)).0, table.derivative_at(Num(x)).0];
                [value, slope, expected[2], expected[3]]
            }
        };
        for (found, expected) in found.iter().zip(expected) {
            worst = worst.max((found - expected).abs() / expected.abs().max(1.0));
        }
    }
    worst
}

/// Measured: 4e-15; rounding in either.
#[test]
fn as_scipy_at_all_kinds_of_ends() {
    let near = |table: Result<Table, _>, expected| {
        let worst = distance(&table.unwrap(), expected);
        println!("{worst:e}");
        assert!(worst < 2e-14, "{worst:e}");
    };
    near(Table::natural(&X, &Y), &NATURAL);
    near(Table::clamped(&X, &Y, [0.5, -2.0]), &CLAMPED);
    near(Table::with_curvatures(&X, &Y, [3.0, -1.0]), &CURVED);
    near(Table::not_a_knot(&X, &Y), &NOT_A_KNOT);
}

/// Halved widths make errors of the value 16, of y′ 8, of y″ 4 times smaller.
#[test]
fn order_four() {
    let errors = |intervals: u32| {
        let x: Vec<f64> = (0..=intervals)
            .map(|i| f64::from(i) * 4.0 / f64::from(intervals))
            .collect();
        let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
        let table = Table::clamped(&x, &y, [1.0, 4.0_f64.cos()]).unwrap();
        let mut worst = [0.0_f64; 3];
        for i in 0..1000 {
            let x = 0.004 * f64::from(i);
            let found = table.derivatives(x).unwrap();
            let exact = [x.sin(), x.cos(), -x.sin()];
            for k in 0..3 {
                worst[k] = worst[k].max((found[k] - exact[k]).abs());
            }
        }
        worst
    };
    let (coarse, fine) = (errors(32), errors(64));
    for (k, power) in [(0, 16.0), (1, 8.0), (2, 4.0)] {
        let ratio = coarse[k] / fine[k];
        assert!(
            (0.9 * power..1.1 * power).contains(&ratio),
            "y^({k}): {ratio}"
        );
    }
}

/// y, y′, y″ from both sides of a knot are the same to round-off of either float, y‴ is not.
#[test]
fn continuous_to_the_second_derivative() {
    let table = Table::natural(&X, &Y).unwrap();
    for &knot in &X[1..6] {
        let [before, after] = [knot.next_down(), knot].map(|x| table.derivatives(x).unwrap());
        for k in 0..3 {
            assert!((before[k] - after[k]).abs() < 3e-14, "{knot}");
        }
        assert!((before[3] - after[3]).abs() > 1.0);
        let below = DoubleDouble::from(knot) - DoubleDouble::from(1e-31);
        let both = [below, DoubleDouble::from(knot)]
            .map(|x| [table.at(Num(x)).0, table.derivative_at(Num(x)).0]);
        for (x, y) in both[0].into_iter().zip(both[1]) {
            assert!((x - y).abs().hi() < 1e-29, "{knot}");
        }
    }
}

/// A cubic polynomial is its own spline; in double-double to 31 digits, also with knots that no double is.
#[test]
fn cubic_polynomials_are_reproduced() {
    let x: Vec<DoubleDouble> = (0..12).map(|i| DoubleDouble::from(i).sqrt()).collect();
    let cubic = |x: DoubleDouble| ((x - DoubleDouble::from(2.0)) * x + DoubleDouble::PI) * x;
    let y: Vec<DoubleDouble> = x.iter().map(|&x| cubic(x)).collect();
    let table = Table::not_a_knot(&x, &y).unwrap();
    for i in 0..100 {
        let x = DoubleDouble::from(i) / DoubleDouble::from(31.0);
        let error = (table.at(Num(x)).0 - cubic(x)).abs().hi();
        assert!(error < 2e-30, "{x}: {error:e}");
        let error = (table.at(Num(x.hi())).0 - cubic(DoubleDouble::from(x.hi())).hi()).abs();
        assert!(error < 2e-14, "{x}: {error:e}");
    }
}

/// What stands in the documentation of the crate: straight through two points, whatever asks for it.
#[test]
fn two_points() {
    let line = Table::natural(&[1.0, 3.0], &[0.0, 4.0]).unwrap();
    assert_eq!(line.derivatives(1.5), Ok([1.0, 2.0, 0.0, 0.0]));
    let hermite = Table::clamped(&[0.0, 1.0], &[0.0, 1.0], [0.0, 0.0]).unwrap();
    assert_eq!(hermite.derivatives(0.5), Ok([0.5, 1.5, 0.0, -12.0]));
    assert_eq!((hermite.range(), hermite.intervals()), (0.0..=1.0, 1));
}
