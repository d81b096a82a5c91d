//! Powers with half-integer exponents: near the power itself, the same in lanes, and roots at the ends.
#![allow(clippy::unwrap_used)]

use equip_scalar::{
    Constant, DoubleDouble, Float, InstructionSet, Kernel, Pack, Scalar, decimal, ratio,
};

fn odd() -> impl Iterator<Item = i32> {
    (-15..=15).filter(|n| n % 2 != 0)
}

fn points() -> impl Iterator<Item = f64> {
    (1..200).map(|k| 10_f64.powf(f64::from(k % 40) - 20.0) * (1.0 + f64::from(k) / 300.0))
}

/// By exp and ln in double-double, whose error is at most (8 + 4|c ln x|) ε.
#[test]
fn near_the_power() {
    let mut worst = 0.0_f64;
    for n in odd() {
        let c = ratio(n.into(), 2);
        for x in points() {
            let wide = DoubleDouble::exact(x);
            let exact = DoubleDouble::powf(wide, DoubleDouble::ratio(n.into(), 2));
            let relative = |y: DoubleDouble| ((y - exact) / exact).to_f64().abs();
            let found = <f64 as Scalar>::powf(x, c);
            let units = relative(DoubleDouble::exact(found)) / f64::EPSILON;
            worst = worst.max(units);
            let allowed = 16.0 + 4.0 * (f64::from(n) / 2.0 * x.ln()).abs();
            let units = relative(<DoubleDouble as Scalar>::powf(wide, c));
            assert!(
                units < allowed * DoubleDouble::EPSILON.to_f64(),
                "{x}^({n}/2): {units}"
            );
        }
    }
    // Measured 2.2; seven products, a root and a division are 4.5.
    assert!((0.5..4.5).contains(&worst), "{worst}");
}

/// By x^(n/2) x^(n/2) = xⁿ, which knows nothing of exp and ln.
#[test]
fn its_square_is_a_whole_power() {
    for n in odd() {
        // Far from where lower words underflow.
        for x in points().map(f64::sqrt) {
            let wide = DoubleDouble::exact(x);
            let half = <DoubleDouble as Scalar>::powf(wide, ratio(n.into(), 2));
            let whole = <DoubleDouble as Scalar>::powi(wide, n);
            let error = ((half * half - whole) / whole).abs() / DoubleDouble::EPSILON;
            assert!(error < DoubleDouble::int(24), "{x}^({n}/2): {error}");
        }
    }
}

struct Powers<T, const N: usize>([T; N], Constant);

impl<T: Float, const N: usize> Kernel for Powers<T, N> {
    type Output = [[T; N]; 2];
    #[inline(always)]
    fn run(&mut self) -> Self::Output {
        let x = T::Pack::<N>::of(&self.0);
        let power = Scalar::powf(x, self.1);
        [power, Scalar::powf_derivative(x, power, self.1)].map(Pack::numbers)
    }
}

fn in_lanes<T: Float>() {
    let mut numbers: Vec<T> = points().map(T::exact).collect();
    numbers.extend([0.0, -0.0, -1.0, f64::INFINITY, f64::NAN].map(T::exact));
    let same = |a: T, b: T| a == b || (Float::is_nan(a) && Float::is_nan(b));
    for set in InstructionSet::available() {
        for n in odd() {
            for x in numbers.as_chunks::<4>().0 {
                // However it is written.
                for c in [ratio(n.into(), 2), Constant::double(f64::from(n) / 2.0)] {
                    let found = set.run(&mut Powers::<T, 4>(*x, c));
                    for (k, &x) in x.iter().enumerate() {
                        let power = <T as Scalar>::powf(x, c);
                        let expected = [power, Scalar::powf_derivative(x, power, c)];
                        let found = found.map(|found| found[k]);
                        assert!(
                            same(found[0], expected[0]),
                            "{x}^({n}/2): {found:?} {expected:?}"
                        );
                        assert!(
                            same(found[1], expected[1]),
                            "{x}^({n}/2): {found:?} {expected:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_same_in_lanes() {
    in_lanes::<f64>();
    in_lanes::<DoubleDouble>();
}

#[test]
fn at_the_ends() {
    let power = |x: f64, c: f64| <f64 as Scalar>::powf(x, c.into());
    assert_eq!([power(0.0, 2.5), power(0.0, -1.5)], [0.0, f64::INFINITY]);
    assert_eq!(
        [power(f64::INFINITY, 0.5), power(f64::INFINITY, -0.5)],
        [f64::INFINITY, 0.0]
    );
    assert!(power(-1.0, 1.5).is_nan() && power(f64::NAN, 0.5).is_nan());
    let slope = |x: f64, c: f64| f64::powf_derivative(x, power(x, c), c.into());
    assert_eq!(
        [slope(0.0, 0.5), slope(0.0, 1.5), slope(0.0, 2.5)],
        [f64::INFINITY, 0.0, 0.0]
    );
    assert_eq!(slope(4.0, -1.5), -1.5 / 32.0);
}

/// Others are what they were.
#[test]
fn other_exponents() {
    for c in [1.0 / 3.0, 2.0, -1.0, 8.5, -9.5, 1.500_000_000_000_001] {
        assert_eq!(<f64 as Scalar>::powf(1.7, c.into()), 1.7_f64.powf(c));
    }
    let three_halves = decimal("1.5000000000000000000000001").unwrap();
    let wide = DoubleDouble::exact(1.7);
    let expected = DoubleDouble::powf(wide, three_halves.to());
    assert_eq!(<DoubleDouble as Scalar>::powf(wide, three_halves), expected);
    assert_eq!(ratio(3, 2).exact_halves(), Some(3));
    assert_eq!(ratio(-9, 6).exact_halves(), Some(-3));
    assert_eq!(Constant::double(0.5).exact_halves(), Some(1));
    assert_eq!(
        ratio(3_000_000_000_000_000_001, 2_000_000_000_000_000_000).exact_halves(),
        None
    );
    assert_eq!(three_halves.exact_halves(), None);
    for c in [0.0, 1.0, 0.25, 8.5, f64::NAN, f64::INFINITY] {
        assert_eq!(Constant::double(c).exact_halves(), None);
    }
}
