//! Lanes have every bit of the numbers they stand for, whatever the instructions.

use equip_scalar::{
    Constant, DoubleDouble, Float, InstructionSet, Kernel, Lanes, Outside, Pack, Scalar, mix_stages,
};
use std::hint::black_box;
use std::sync::Arc;

const COUNT: usize = 51;

/// 1/(1 + x²), and nothing of its derivatives.
#[derive(Debug)]
struct Lorentzian;

impl Outside for Lorentzian {
    fn variables(&self) -> usize {
        1
    }
    fn derivative(&self, _: [u8; 2], [x, _]: [f64; 2]) -> f64 {
        1.0 / (1.0 + x * x)
    }
    fn derivative_in_pairs(&self, _: [u8; 2], [[hi, lo], _]: [[f64; 2]; 2]) -> [f64; 2] {
        let x = DoubleDouble::new(hi, lo);
        let f = (x * x + DoubleDouble::ONE).recip();
        [f.hi(), f.lo()]
    }
}

/// Every operation on x and y, in any number.
#[rustfmt::skip]
#[inline(always)]
fn everything<S: Scalar>(x: S, y: S) -> [S; COUNT] {
    let c = Constant::double(2.5);
    [
        x + y, x - y, x * y, x / y, -x,
        S::constant(c), S::recip(x), S::sqrt(x), S::exp(x), S::ln(x),
        S::exp_m1(x), S::ln_1p(x), S::sin(x), S::cos(x), S::tan(x),
        S::asin(x), S::acos(x), S::atan(x), S::atan2(x, y), S::sinh(x),
        S::cosh(x), S::tanh(x), S::hypot(x, y), S::abs(x), S::min(x, y),
        S::max(x, y), S::powf(x, c), S::pow(x, y), S::at_most(x, y),
        S::where_nonzero(x, y), S::powf_derivative(x, S::powf(x, c), c), S::powi(x, 0), S::powi(x, 1),
        S::powi(x, 2), S::powi(x, 3), S::powi(x, 4), S::powi(x, 5), S::powi(x, 6), S::powi(x, 7), S::powi(x, -1), S::powi(x, -6),
        S::cbrt(x), S::exp2(x), S::asinh(x), S::acosh(x), S::atanh(x), S::erf(x), S::erfc(x), S::signum(x),
        S::select(x, y, x * y), S::outside(&(Arc::new(Lorentzian) as _), [0, 0], [x, x]),
    ]
}

struct Everything<T, const N: usize>([T; N], [T; N]);

impl<T: Float, const N: usize> Kernel for Everything<T, N> {
    type Output = [[T; N]; COUNT];
    #[inline(always)]
    fn run(&mut self) -> Self::Output {
        everything(T::Pack::<N>::of(&self.0), T::Pack::<N>::of(&self.1)).map(Pack::numbers)
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

/// The same numbers with lower words, and numbers near the limits of what is done by vectors.
fn special_double_doubles() -> Vec<DoubleDouble> {
    let doubles = special().into_iter().enumerate();
    let mut numbers: Vec<DoubleDouble> = doubles
        .map(|(i, x)| DoubleDouble::new(x, x * f64::EPSILON * (0.1 * i as f64 - 0.4) / 2.0))
        .collect();
    let bits = |x: i32| 2_f64.powi(x) * 1.1;
    numbers.extend(
        [-1000, -901, -899, 500, 990, 999, 1001, 1023].map(|k| DoubleDouble::from(bits(k))),
    );
    numbers
}

fn same<T: Float>(a: T, b: T) -> bool {
    let words = |x: T| x.expansion().map(f64::to_bits);
    words(a) == words(b) || (Float::is_nan(a) && Float::is_nan(b))
}

fn compare<T: Float, const N: usize>(set: InstructionSet, numbers: &[T]) {
    for &y in numbers {
        for start in 0..numbers.len() - N {
            let mut x = [T::int(0); N];
            x.copy_from_slice(&numbers[start..start + N]);
            let results = set.run(&mut Everything(x, [y; N]));
            for lane in 0..N {
                // The exponent must not be known when compiling: powers by repeated products are what is
                // compared.
                let expected = everything(black_box(x[lane]), black_box(y));
                for (k, (found, expected)) in results.iter().zip(expected).enumerate() {
                    let (x, found) = (x[lane], found[lane]);
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
        compare::<f64, 4>(set, &special());
        compare::<f64, 8>(set, &special());
        compare::<DoubleDouble, 4>(set, &special_double_doubles());
        compare::<DoubleDouble, 8>(set, &special_double_doubles());
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

/// `rounds`: of doubles products and sums are rounded one after the other, of double-doubles the whole.
fn mixed<T: Float>(rounds: bool) {
    let number = |i: usize| T::ratio(7 * i as i64 % 23 - 11, 13);
    for stages in 1..=18_usize {
        for stride in [
            stages,
            stages.next_multiple_of(4),
            stages.next_multiple_of(8),
            stages.next_multiple_of(8) + 1,
        ] {
            let k: Vec<T> = (0..stages * stride).map(number).collect();
            let l: Vec<T> = (0..3 * stride).map(|i| number(i + 5)).collect();
            let mut first = None;
            for set in InstructionSet::available() {
                let mut z = vec![T::NAN; l.len()];
                mix_stages(set, &k, &l, &mut z, stages, stride);
                for c in 0..3 {
                    for i in 0..stages {
                        let term = |j: usize| k[j * stride + i] * l[c * stride + j];
                        let fused =
                            |sum: T, j: usize| k[j * stride + i].mul_add(l[c * stride + j], sum);
                        let expected = (1..stages).fold(term(0), fused);
                        let size = (0..stages).fold(T::int(0), |sum, j| sum + term(j).abs());
                        let found = z[c * stride + i];
                        let most = if rounds {
                            T::int(0)
                        } else {
                            T::int(4) * T::EPSILON * size
                        };
                        assert!(
                            (found - expected).abs() <= most,
                            "{set:?}, {stages} stages in {stride}: {found:e} {expected:e}"
                        );
                    }
                }
                let first = first.get_or_insert_with(|| z.clone());
                let pairs = z.iter().zip(first.iter());
                let stages = pairs
                    .enumerate()
                    .filter(|(place, _)| place % stride < stages);
                assert!(stages.into_iter().all(|(_, (&a, &b))| same(a, b)));
            }
        }
    }
}

#[test]
fn stages_are_mixed() {
    mixed::<f64>(true);
    mixed::<DoubleDouble>(false);
}

/// What becomes infinite in one place stays a number in the others.
#[test]
fn sums_of_products_beyond_the_largest_number() {
    let big = DoubleDouble::exact(1e200);
    let one = DoubleDouble::int(1);
    let (mut z, l) = ([one; 4], [big, one, one, one]);
    let mut k = [one; 16];
    k[1] = big;
    mix_stages(InstructionSet::best(), &k, &l, &mut z, 4, 4);
    assert_eq!(z[1], DoubleDouble::INFINITY);
    assert_eq!(z[0], big + DoubleDouble::int(3));
}

struct Total<'a, T, const N: usize>(&'a [[T; N]]);

impl<T: Float, const N: usize> Kernel for Total<'_, T, N> {
    type Output = (T, T);
    #[inline(always)]
    fn run(&mut self) -> (T, T) {
        T::Pack::total(self.0)
    }
}

/// The exact sum by integers, in units of 2^−`places`.
fn totals<T: Float, const N: usize>(places: i32, number: impl Fn(i64) -> T) {
    let exact = |x: T| -> i128 {
        let words = x
            .expansion()
            .map(|word| (word * 2_f64.powi(places)) as i128);
        words.iter().sum()
    };
    let mut has_lost = false;
    for seed in 0..40 {
        // Odd, and of 53 bits, of either sign.
        let odd =
            |i: i64| ((i * i + seed * i + 11).wrapping_mul(1_442_695_040_888_963_407) >> 10) | 1;
        let packs: [[T; N]; 3] =
            std::array::from_fn(|g| std::array::from_fn(|i| number(odd((N * g + i) as i64))));
        let whole: i128 = packs.as_flattened().iter().map(|&x| exact(x)).sum();
        for set in InstructionSet::available() {
            let (found, lost) = set.run(&mut Total(&packs));
            assert_eq!(exact(found) + exact(lost), whole, "{set:?}: {found:e}");
            has_lost |= lost != T::int(0);
            let mut infinite = packs;
            infinite[1][N - 1] = T::INFINITY;
            assert_eq!(set.run(&mut Total(&infinite)).0, T::INFINITY);
        }
    }
    assert!(has_lost);
}

#[test]
fn totals_are_exact_with_what_they_have_lost() {
    totals::<f64, 4>(0, |odd| odd as f64);
    totals::<f64, 8>(0, |odd| odd as f64);
    // Sums of the upper words lose bits, and so do those of the lower words with these.
    let unit = DoubleDouble::from(2_f64.powi(-55));
    let wide = |odd: i64| {
        DoubleDouble::int(odd) + DoubleDouble::int(odd.wrapping_mul(odd + 2) >> 11 | 1) * unit
    };
    totals::<DoubleDouble, 4>(55, wide);
    totals::<DoubleDouble, 8>(55, wide);
}
