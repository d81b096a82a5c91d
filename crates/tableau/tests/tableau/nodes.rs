//! Nodes and weights against what is known of them from elsewhere.

use crate::common::within;
use equip_scalar::{DoubleDouble, Float};
use equip_tableau::{Coefficients, MAX_STAGES, TableauError};

crate::common::in_every_float!(
    up_to_five_nodes_are_radicals,
    twenty_nodes_agree_with_the_published_table,
    every_rule_is_symmetric_to_the_last_bit,
    polynomials_are_orthonormal_in_the_discrete_product,
    moments_are_those_of_the_interval,
);

/// Abramowitz and Stegun, Handbook of Mathematical Functions, table 25.4, n = 20, on [−1, 1]: (x, w).
const TABLE_25_4: [(&str, &str); 10] = [
    ("0.076526521133497333755", "0.152753387130725850698"),
    ("0.227785851141645078080", "0.149172986472603746788"),
    ("0.373706088715419560673", "0.142096109318382051329"),
    ("0.510867001950827098004", "0.131688638449176626898"),
    ("0.636053680726515025453", "0.118194531961518417312"),
    ("0.746331906460150792614", "0.101930119817240435037"),
    ("0.839116971822218823395", "0.083276741576704748725"),
    ("0.912234428251325905868", "0.062672048334109063570"),
    ("0.963971927277913791268", "0.040601429800386941331"),
    ("0.993128599185094924786", "0.017614007139152118312"),
];

/// (x, w) on [−1, 1] for the nodes x ≥ 0, ascending.
fn radicals<T: Float>(s: usize) -> Vec<(T, T)> {
    let (int, ratio) = (T::int, T::ratio);
    let root = |n, d| ratio(n, d).sqrt();
    match s {
        1 => vec![(int(0), int(2))],
        2 => vec![(root(1, 3), int(1))],
        3 => vec![(int(0), ratio(8, 9)), (root(3, 5), ratio(5, 9))],
        4 => [-1, 1]
            .map(|sign| {
                let x = (ratio(3, 7) + int(2 * sign) / int(7) * root(6, 5)).sqrt();
                (x, (int(18) - int(sign) * int(30).sqrt()) / int(36))
            })
            .to_vec(),
        _ => {
            let outer = [-1, 1].map(|sign| {
                let x = (int(5) + int(2 * sign) * root(10, 7)).sqrt() / int(3);
                (x, (int(322) - int(13 * sign) * int(70).sqrt()) / int(900))
            });
            [vec![(int(0), ratio(128, 225))], outer.to_vec()].concat()
        }
    }
}

fn up_to_five_nodes_are_radicals<T: Float>() {
    for s in 1..=5 {
        // 0.5 in f64, 0.12 in double-double, × 2.
        within(
            "radicals",
            distance_to(&Coefficients::gauss(s).unwrap(), &radicals::<T>(s)),
            1.0,
        );
    }
}

fn twenty_nodes_agree_with_the_published_table<T: Float>() {
    let decimal = |text| T::decimal(text).unwrap();
    let known = TABLE_25_4.map(|(x, w)| (decimal(x), decimal(w)));
    let worst = distance_to(&Coefficients::gauss(20).unwrap(), &known);
    // 0.5 ε in f64, × 2; 2.5e-22, the rounding of the table, in double-double, × 4.
    assert!(worst <= T::EPSILON.max(decimal("1e-21")), "{worst:e}");
}

/// The largest deviation of the upper half of a rule on [0, 1] from (x, w) on [−1, 1].
fn distance_to<T: Float>(gauss: &Coefficients<T>, known: &[(T, T)]) -> T {
    let half = T::ratio(1, 2);
    let upper = gauss.stages() / 2;
    let computed = gauss.nodes()[upper..].iter().zip(&gauss.weights()[upper..]);
    assert_eq!(computed.len(), known.len());
    computed
        .zip(known)
        .fold(T::int(0), |worst, ((&c, &b), &(x, w))| {
            let node = (c - (half + half * x)).abs();
            worst.max(node).max((b - half * w).abs())
        })
}

fn every_rule_is_symmetric_to_the_last_bit<T: Float>() {
    for s in 1..=MAX_STAGES {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let (c, b) = (gauss.nodes(), gauss.weights());
        assert!(c[0] > T::int(0) && c.is_sorted_by(|x, y| x < y));
        for i in 0..s {
            assert_eq!(c[i], T::int(1) - c[s - 1 - i]);
            assert_eq!(c[i] + c[s - 1 - i], T::int(1));
            assert_eq!(b[i], b[s - 1 - i]);
            for k in 0..s {
                let mirrored = gauss.legendre(k)[s - 1 - i];
                assert_eq!(
                    gauss.legendre(k)[i],
                    if k % 2 == 0 { mirrored } else { -mirrored }
                );
            }
        }
    }
}

fn polynomials_are_orthonormal_in_the_discrete_product<T: Float>() {
    for s in (1..=20).chain([24, 28, MAX_STAGES]) {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let mut worst = T::int(0);
        for k in 0..s {
            for l in 0..=k {
                let values = gauss.legendre(k).iter().zip(gauss.legendre(l));
                let sum = values
                    .zip(gauss.weights())
                    .fold(T::int(0), |sum, ((&x, &y), &b)| sum + b * x * y);
                worst = worst.max((sum - T::int(i64::from(k == l))).abs());
            }
        }
        // 2.5 up to s = 20 and 5.2 at s = 64 in f64; 1.0 and 1.2 in double-double; × 2.
        within("orthonormality", worst, if s <= 20 { 5.0 } else { 10.4 });
    }
}

fn moments_are_those_of_the_interval<T: Float>() {
    for s in (1..=20).chain([24, 28, MAX_STAGES]) {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let mut powers = gauss.weights().to_vec();
        let mut worst = T::int(0);
        for q in 1..=2 * s {
            let sum = powers.iter().fold(T::int(0), |sum, &x| sum + x);
            worst = worst.max((sum - T::ratio(1, q as i64)).abs());
            for (power, &c) in powers.iter_mut().zip(gauss.nodes()) {
                *power *= c;
            }
        }
        // 1.0 in f64, 0.5 in double-double, × 2.
        within("moments", worst, 2.0);
    }
}

/// The same numbers in 31 digits, rounded, are those of f64.
#[test]
fn doubles_are_the_rounded_double_doubles() {
    let mut worst = [0.0f64; 4];
    for s in 1..=MAX_STAGES {
        let (short, long) = (
            Coefficients::<f64>::gauss(s).unwrap(),
            Coefficients::<DoubleDouble>::gauss(s).unwrap(),
        );
        let mut compare = |index: usize, x: &[f64], y: &[DoubleDouble], relative: bool| {
            for (x, y) in x.iter().zip(y.iter().map(|y| y.to_f64())) {
                let scale = if relative { y.abs() } else { y.abs().max(1.0) };
                worst[index] = worst[index].max((x - y).abs() / scale);
            }
        };
        compare(0, short.nodes(), long.nodes(), false);
        compare(1, short.weights(), long.weights(), true);
        for k in 0..s {
            compare(2, short.legendre(k), long.legendre(k), false);
        }
        let plain = DoubleDouble::int(0);
        compare(
            3,
            &short.matrix(&vec![0.0; s - 1]),
            &long.matrix(&vec![plain; s - 1]),
            false,
        );
    }
    // Measured up to s = 64: 0.5, 7.7, 22.5 (of values up to 11), 4.8; × 2.
    within("nodes", worst[0], 1.0);
    within("relative error of weights", worst[1], 15.4);
    within("polynomials", worst[2], 45.0);
    within("K", worst[3], 9.6);
}

#[test]
fn impossible_numbers_of_stages_are_refused() {
    for stages in [0, MAX_STAGES + 1] {
        let error = Coefficients::<f64>::gauss(stages).unwrap_err();
        assert_eq!(
            error,
            TableauError::StagesOutOfRange {
                stages,
                min: 1,
                max: MAX_STAGES
            }
        );
        assert!(error.to_string().contains("choose a number from 1 to 32"));
    }
}
