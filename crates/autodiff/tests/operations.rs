//! Every operation of the tape: value to the last bit, gradient and Hessian against num-dual and against
//! central differences in double-double.
// Matrix code reads best with its indices.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

use crate::common::{Energy, Random, same_bits, widened};
use equip_autodiff::Hamiltonian;
use equip_scalar::{DoubleDouble, FirstOrder, Float, Num, Scalar, ratio};
use std::ops::Range;

const POINTS: usize = 40;

/// All first and second derivatives of a function of two variables.
struct Derivatives<T> {
    value: T,
    gradient: [T; 2],
    hessian: [[T; 2]; 2],
}

fn by_tape<E: Energy, T: Float>(energy: &E, y: &[T]) -> Derivatives<T> {
    let h = energy.hamiltonian();
    let mut evaluator = h.evaluator::<T>();
    let zero = T::int(0);
    let mut gradient = [zero; 2];
    let value = evaluator.gradient(y, &mut gradient);
    assert!(same_bits(value, evaluator.value(y)));
    let pattern = &h.structure().hessian;
    let mut entries = vec![zero; pattern.len()];
    evaluator.hessian(y, &mut entries);
    let mut hessian = [[zero; 2]; 2];
    for (i, row) in hessian.iter_mut().enumerate() {
        pattern
            .row(i)
            .for_each(|(entry, j)| row[j] = entries[entry]);
    }
    Derivatives {
        value,
        gradient,
        hessian,
    }
}

/// The gradient of H as it is written, and the products of ∇²H with the unit vectors: its columns, whether or
/// not the pattern has them.
fn by_num_dual<E: Energy, T: Float>(energy: &E, y: &[T]) -> Derivatives<T> {
    let h = energy.by_num_dual::<T, 2>(y);
    let mut evaluator = energy.hamiltonian().evaluator::<T>();
    let mut hessian = [[T::int(0); 2]; 2];
    for (j, column) in hessian.iter_mut().enumerate() {
        let v: [T; 2] = std::array::from_fn(|i| T::int(i64::from(i == j)));
        evaluator.hessian_vector(y, &v, column);
    }
    Derivatives {
        value: h.value(),
        gradient: h.gradient(),
        hessian,
    }
}

/// Central differences of the value (gradient) and of the tape's gradient (Hessian), step 1e-10.
fn by_differences<E: Energy>(energy: &E, y: &[DoubleDouble]) -> Derivatives<DoubleDouble> {
    let step = DoubleDouble::exact(1e-10);
    let h = energy.hamiltonian();
    let mut evaluator = h.evaluator::<DoubleDouble>();
    let zero = DoubleDouble::int(0);
    let mut all = Derivatives {
        value: zero,
        gradient: [zero; 2],
        hessian: [[zero; 2]; 2],
    };
    for j in 0..2 {
        let mut moved = [[zero; 2]; 2];
        let values: [DoubleDouble; 2] = std::array::from_fn(|side| {
            let mut y = [y[0], y[1]];
            y[j] += if side == 0 { -step } else { step };
            evaluator.gradient(&y, &mut moved[side])
        });
        let width = step + step;
        all.gradient[j] = (values[1] - values[0]) / width;
        for i in 0..2 {
            all.hessian[i][j] = (moved[1][i] - moved[0][i]) / width;
        }
    }
    all
}

/// Largest difference, relative to the largest of the numbers compared.
fn distance<T: Float>(a: &Derivatives<T>, b: &Derivatives<T>) -> [f64; 2] {
    let relative = |pairs: &[(T, T)]| {
        let largest = pairs
            .iter()
            .map(|(x, y)| x.abs().max(y.abs()).to_f64())
            .fold(1e-3, f64::max);
        pairs
            .iter()
            .map(|&(x, y)| (x - y).to_f64().abs() / largest)
            .fold(0.0, f64::max)
    };
    let flat = |h: &[[T; 2]; 2]| [h[0][0], h[0][1], h[1][0], h[1][1]];
    let gradients: Vec<(T, T)> = a.gradient.into_iter().zip(b.gradient).collect();
    let hessians: Vec<(T, T)> = flat(&a.hessian).into_iter().zip(flat(&b.hessian)).collect();
    [relative(&gradients), relative(&hessians)]
}

fn verify<E: Energy>(name: &str, energy: &E, x: Range<f64>, y: Range<f64>) {
    let mut random = Random(0x5eed_0001);
    let mut worst = [[0.0_f64; 2]; 3];
    for _ in 0..POINTS {
        let point = [random.within(x.start, x.end), random.within(y.start, y.end)];
        let wide = widened(&point);

        let double = by_tape(energy, &point);
        let direct = energy.direct(&point);
        assert!(
            same_bits(double.value, direct),
            "{name}: {} {direct}",
            double.value
        );
        let extended = by_tape(energy, &wide);
        let direct = energy.direct(&wide);
        assert!(
            same_bits(extended.value, direct),
            "{name}: {} {direct}",
            extended.value
        );

        let found = [
            distance(&double, &by_num_dual(energy, &point)),
            distance(&extended, &by_num_dual(energy, &wide)),
            distance(&extended, &by_differences(energy, &wide)),
        ];
        for (worst, found) in worst.iter_mut().zip(found) {
            (0..2).for_each(|k| worst[k] = worst[k].max(found[k]));
        }
    }
    println!(
        "{name:12} f64 {:?}  dd {:?}  differences {:?}",
        worst[0], worst[1], worst[2]
    );
    for (worst, bound) in worst.iter().zip(BOUNDS) {
        assert!(
            worst.iter().all(|w| *w <= bound),
            "{name}: {worst:?} > {bound:e}"
        );
    }
}

/// Tape against num-dual in f64, in double-double, and against differences. Measured worst over all
/// operations and points: 4.3e-15, 4.3e-31, 2.0e-17; five times that.
const BOUNDS: [f64; 3] = [2e-14, 2e-30, 1e-16];

macro_rules! operations {
    ($($name:ident($x:expr, $y:expr): |$q:ident, $p:ident| $h:expr;)*) => {$(
        #[test]
        fn $name() {
            struct Function;
            impl Energy for Function {
                fn degrees_of_freedom(&self) -> usize {
                    1
                }
                fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
                    let ($q, $p) = (q[0], p[0]);
                    $h
                }
            }
            verify(stringify!($name), &Function, $x, $y);
        }
    )*};
}

operations! {
    add(-2.0..2.0, -2.0..2.0): |x, y| (x + y).powi(3) + (x + 1.5) * y;
    sub(-2.0..2.0, -2.0..2.0): |x, y| (x - y).powi(3) + (2.0 - x) * y;
    mul(-2.0..2.0, -2.0..2.0): |x, y| x * y * x + 3.0 * y * y * y;
    square(-2.0..2.0, -2.0..2.0): |x, y| (x * x + y) * (x * x + y);
    div(0.5..2.0, 0.5..2.0): |x, y| x / y + 1.0 / (x * y) + y / 3.0;
    neg(-2.0..2.0, -2.0..2.0): |x, y| -(x * y) * -x;
    recip(0.5..2.0, -2.0..-0.5): |x, y| (x * x).recip() + y.recip() * x;
    sqrt(0.5..2.0, 0.5..2.0): |x, y| (x * y + y).sqrt();
    powi_3(-2.0..2.0, -2.0..2.0): |x, y| (x + 2.0 * y).powi(3);
    powi_4(-2.0..2.0, -2.0..2.0): |x, y| (x - y * 2.0).powi(4);
    powi_6(-2.0..2.0, -2.0..2.0): |x, y| (x - y).powi(6);
    powi_7(-2.0..2.0, -2.0..2.0): |x, y| (x * y).powi(7);
    powi_negative(0.5..2.0, 0.5..2.0): |x, y| (x * y).powi(-3) + x.powi(-1);
    powf_half(0.5..2.0, 0.5..2.0): |x, y| (x * y).powf(2.5) + x.powf(-1.5);
    powf_ratio(0.5..2.0, 0.5..2.0): |x, y| (x + y).powf(ratio(1, 3));
    pow(0.5..2.0, -2.0..2.0): |x, y| x.pow(y * x);
    exp(-2.0..2.0, -2.0..2.0): |x, y| (x * y).exp();
    ln(0.5..2.0, 0.5..2.0): |x, y| (x * y + x).ln() * y;
    exp_m1(-1.0..1.0, -1.0..1.0): |x, y| (x * y).exp_m1();
    ln_1p(-0.5..1.0, -0.5..1.0): |x, y| (x * y).ln_1p();
    sin(-3.0..3.0, -2.0..2.0): |x, y| (x * y).sin();
    cos(-3.0..3.0, -2.0..2.0): |x, y| (x * y).cos();
    tan(-1.0..1.0, -1.0..1.0): |x, y| (x * y).tan();
    asin(-0.9..0.9, -0.9..0.9): |x, y| (x * y).asin();
    acos(-0.9..0.9, -0.9..0.9): |x, y| (x * y).acos();
    atan(-2.0..2.0, -2.0..2.0): |x, y| (x * y).atan();
    atan2(0.5..2.0, -2.0..2.0): |x, y| y.atan2(x * x) * x;
    sinh(-2.0..2.0, -1.0..1.0): |x, y| (x * y).sinh();
    cosh(-2.0..2.0, -1.0..1.0): |x, y| (x * y).cosh();
    tanh(-2.0..2.0, -1.0..1.0): |x, y| (x * y).tanh();
    cbrt(-2.0..-0.5, 0.5..2.0): |x, y| (x * y).cbrt() + (y * y).cbrt() * x;
    exp2(-2.0..2.0, -2.0..2.0): |x, y| (x * y).exp2();
    log10(0.5..2.0, 0.5..2.0): |x, y| (x * y + x).log10() * y;
    asinh(-2.0..2.0, -2.0..2.0): |x, y| (x * y).asinh();
    acosh(1.1..2.0, 1.1..2.0): |x, y| (x * y).acosh();
    atanh(-0.9..0.9, -0.9..0.9): |x, y| (x * y).atanh();
    erf(-1.5..1.5, -1.5..1.5): |x, y| (x * y).erf();
    erfc(-1.5..1.5, -1.5..1.5): |x, y| (x * y).erfc();
    signum(-2.0..-0.5, 0.5..2.0): |x, y| (x * y).signum() * x * x + y.signum() * y;
    select_left(0.5..1.0, 0.5..2.0): |x, y| (x * y).select(x * x * y, y * y * y * y);
    select_right(-1.0..-0.5, 0.5..2.0): |x, y| (x * y).select(x * x, y * y * y * y) * x;
    select_constant(-1.0..-0.5, 0.5..2.0): |x, y| y.select(1, x) * (x - 3).select(7.5, x * y) * x;
    integers(0.5..2.0, 0.5..2.0): |x, y| (2 * x - y / 3 + 1) * (5 - x) / (4 + y) - 1 / x;
    hypot(0.5..2.0, -2.0..-0.5): |x, y| (x * x).hypot(y);
    abs_negative(-2.0..-0.5, 0.5..2.0): |x, y| (x * y).abs() * x;
    abs_positive(0.5..2.0, 0.5..2.0): |x, y| (x * y).abs() * x;
    min_left(0.5..1.0, 1.5..2.0): |x, y| (x * x).min(y * y) * y;
    min_right(1.5..2.0, 0.5..1.0): |x, y| (x * x).min(y * y) * y;
    max_left(1.5..2.0, 0.5..1.0): |x, y| (x * x).max(y * y) * y;
    max_right(0.5..1.0, 1.5..2.0): |x, y| (x * x).max(y * y) * y;
    clamp(-1.0..1.0, 0.5..2.0): |x, y| x.clamp(-2, 3.0) * y * x + y.clamp(x * x, 1.2) * y;
    long_sum(0.5..2.0, 0.5..2.0): |x, y| {
        let mut h = x * y;
        for k in 1..12 {
            let term = (x * f64::from(k) + y).sin();
            if k % 3 == 0 { h -= term } else { h += term }
        }
        h * h
    };
}

#[test]
fn derivatives_at_special_points() {
    let gradient =
        |energy: &dyn Fn(&[equip_autodiff::Var], &[equip_autodiff::Var]) -> equip_autodiff::Var,
         y: [f64; 2]| {
            let h = Hamiltonian::new(1, energy).unwrap();
            let mut gradient = [f64::NAN; 2];
            h.evaluator().gradient(&y, &mut gradient);
            let mut column = [f64::NAN; 2];
            h.evaluator().hessian_vector(&y, &[1.0, 0.0], &mut column);
            (gradient, column[0])
        };
    assert_eq!(
        gradient(&|q, _| q[0].sqrt(), [0.0, 0.0]).0[0],
        f64::INFINITY
    );
    assert_eq!(
        gradient(&|q, _| q[0].powf(2.5), [0.0, 0.0]),
        ([0.0, 0.0], 0.0)
    );
    assert_eq!(
        gradient(&|q, _| q[0].powf(2.0), [0.0, 0.0]),
        ([0.0, 0.0], 2.0)
    );
    assert_eq!(
        gradient(&|q, _| q[0].powf(1.0), [0.0, 0.0]),
        ([1.0, 0.0], 0.0)
    );
    assert_eq!(
        gradient(&|q, _| q[0].powf(0.0), [0.0, 0.0]),
        ([0.0, 0.0], 0.0)
    );
    assert_eq!(
        gradient(&|q, _| q[0].powi(3), [0.0, 0.0]),
        ([0.0, 0.0], 0.0)
    );
    let steep = gradient(&|q, _| q[0].powi(-1), [1e-110, 0.0]).0[0];
    assert!((steep / -1e220 - 1.0).abs() < 1e-14);
    assert_eq!(gradient(&|q, _| q[0].abs(), [0.0, 0.0]), ([0.0, 0.0], 0.0));
    assert_eq!(
        gradient(&|q, _| q[0].abs(), [-0.5, 0.0]),
        ([-1.0, 0.0], 0.0)
    );
    assert_eq!(gradient(&|q, p| q[0].hypot(p[0]), [0.0, 0.0]).0, [0.0, 0.0]);
    let wide = gradient(&|q, p| q[0].hypot(p[0]), [3e200, 4e200]).0;
    assert!((wide[0] - 0.6).abs() < 1e-15 && (wide[1] - 0.8).abs() < 1e-15);
    assert_eq!(
        gradient(&|q, p| q[0].pow(p[0]), [0.0, 2.0]),
        ([0.0, 0.0], 2.0)
    );
    assert_eq!(
        gradient(&|q, p| q[0].pow(p[0]), [0.0, 1.0]),
        ([1.0, 0.0], 0.0)
    );
    assert_eq!(gradient(&|q, p| q[0].min(p[0]), [1.0, 1.0]).0, [1.0, 0.0]);
    assert_eq!(gradient(&|q, p| q[0].max(p[0]), [1.0, 1.0]).0, [1.0, 0.0]);
    assert_eq!(
        gradient(&|q, _| q[0].tanh(), [800.0, 0.0]),
        ([0.0, 0.0], 0.0)
    );
    let far = gradient(&|q, _| q[0].tanh(), [25.0, 0.0]).0[0];
    assert!((far / (4.0 * (-50_f64).exp()) - 1.0).abs() < 1e-15);
    let wide = gradient(&|q, p| q[0].atan2(p[0]), [1e200, 1e200]).0;
    assert!((wide[0] * 2e200 - 1.0).abs() < 1e-15 && (wide[1] * 2e200 + 1.0).abs() < 1e-15);
}

/// Operations that are taken together, such as 1/√x and x² + y, have the bits of each by itself.
#[test]
fn operations_taken_together_keep_every_bit() {
    let h = Hamiltonian::new(3, |q, _| {
        let r2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
        1.0 / r2.sqrt() + (q[0] * q[0]).exp()
    })
    .unwrap();
    for k in 0..64 {
        let q = [1.0, 2.0, 3.0].map(|x| (x + 0.37 * f64::from(k)).sin());
        let y = [q[0], q[1], q[2], 0.0, 0.0, 0.0];
        let r2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
        let value = 1.0 / r2.sqrt() + (q[0] * q[0]).exp();
        assert_eq!(h.evaluator().value(&y).to_bits(), value.to_bits(), "{q:?}");
        let [x, y, z] = q.map(DoubleDouble::from);
        let one = DoubleDouble::from(1.0);
        let wide = one / <DoubleDouble as Scalar>::sqrt(x * x + y * y + z * z)
            + <DoubleDouble as Scalar>::exp(x * x);
        let zero = DoubleDouble::from(0.0);
        let found = h.evaluator().value(&[x, y, z, zero, zero, zero]);
        assert_eq!(found, wide, "{q:?}");
    }
}
