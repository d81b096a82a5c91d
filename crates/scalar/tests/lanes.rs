//! Lanes have every bit of the doubles they stand for, whatever the instructions.

use equip_scalar::{
    Constant, DoubleDouble, Float, InstructionSet, Kernel, Lanes, Piecewise, mix_stages,
};

/// Every operation on x and y, in any number.
#[rustfmt::skip]
#[inline(always)]
fn everything<S: Piecewise>(x: S, y: S) -> [S; 43] {
    let c = Constant::Double(2.5);
    [
        x + y, x - y, x * y, x / y, -x,
        S::constant(c), S::recip(x), S::sqrt(x), S::exp(x), S::ln(x),
        S::exp_m1(x), S::ln_1p(x), S::sin(x), S::cos(x), S::tan(x),
        S::asin(x), S::acos(x), S::atan(x), S::atan2(x, y), S::sinh(x),
        S::cosh(x), S::tanh(x), S::hypot(x, y), S::abs(x), S::min(x, y),
        S::max(x, y), S::powf(x, c), S::pow(x, y), S::sign(x), S::at_most(x, y),
        S::where_nonzero(x, y), S::times_slope(x, y), S::powf_slope(x, S::powf(x, c), c), S::powi(x, 0), S::powi(x, 1),
        S::powi(x, 2), S::powi(x, 3), S::powi(x, 4), S::powi(x, 5), S::powi(x, 6), S::powi(x, 7), S::powi(x, -1), S::powi(x, -6),
    ]
}

struct Everything<const N: usize>([f64; N], [f64; N]);

impl<const N: usize> Kernel for Everything<N> {
    type Output = [Lanes<N>; 43];
    #[inline(always)]
    fn run(&mut self) -> Self::Output {
        everything(Lanes(self.0), Lanes(self.1))
    }
}

fn special() -> Vec<f64> {
    let mut numbers = vec![
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.3,
        -0.7,
        2.5,
        1e-300,
        5e-324,
        1e300,
        700.0,
        -800.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        std::f64::consts::PI,
    ];
    numbers.extend((1..16).map(|i| (f64::from(i) * 1.7).sin() * f64::from(i)));
    numbers
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn compare<const N: usize>(set: InstructionSet) {
    let numbers = special();
    for &y in &numbers {
        for start in 0..numbers.len() - N {
            let mut x = [0.0; N];
            x.copy_from_slice(&numbers[start..start + N]);
            let results = set.run(&mut Everything(x, [y; N]));
            for lane in 0..N {
                // The exponent must not be known when compiling: powers by repeated products are what is compared.
                let expected = everything(std::hint::black_box(x[lane]), std::hint::black_box(y));
                for (k, (found, expected)) in results.iter().zip(expected).enumerate() {
                    let (x, found) = (x[lane], found.0[lane]);
                    assert!(
                        same(found, expected),
                        "{set:?}, function {k} of {x:e}, {y:e}: {found:e} {expected:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn every_function_in_every_lane() {
    for set in InstructionSet::available() {
        compare::<4>(set);
        compare::<8>(set);
    }
}

#[test]
fn part_of_the_lanes() {
    let numbers = [1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!(Lanes::<4>::load(&numbers).0, [1.0, 2.0, 3.0, 4.0]);
    let lanes = Lanes::<8>::load(&numbers);
    assert_eq!(lanes.0, [1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 5.0, 5.0]);
    let (mut short, mut long) = ([0.0; 3], [0.0; 9]);
    lanes.store(&mut short);
    lanes.store(&mut long);
    assert_eq!(short, [1.0, 2.0, 3.0]);
    assert_eq!(long, [1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 5.0, 5.0, 0.0]);
}

fn mixed<T: Float>() {
    let number = |i: usize| T::ratio(7 * i as i64 % 23 - 11, 13);
    for stages in 1..=18_usize {
        for stride in [
            stages,
            stages.next_multiple_of(4),
            stages.next_multiple_of(8) + 1,
        ] {
            let k: Vec<T> = (0..stages * stride).map(number).collect();
            let l: Vec<T> = (0..3 * stride).map(|i| number(i + 5)).collect();
            for set in InstructionSet::available() {
                let mut z = vec![T::NAN; l.len()];
                mix_stages(set, &k, &l, &mut z, stages, stride);
                for c in 0..3 {
                    for i in 0..stages {
                        let mut expected = k[i] * l[c * stride];
                        for j in 1..stages {
                            expected += k[j * stride + i] * l[c * stride + j];
                        }
                        let found = z[c * stride + i];
                        assert!(
                            found == expected,
                            "{set:?}, {stages} stages in {stride}: {found:e} {expected:e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn stages_are_mixed_in_order() {
    mixed::<f64>();
    mixed::<DoubleDouble>();
}
