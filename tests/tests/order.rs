//! Order: the printed error tables of the method, and observed orders down to errors only double-double can
//! see.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Alphas, Equip, Gauss, Method, Preconditioner};
use equip_scalar::{DoubleDouble, Float, ratio};
use equip_tests::{Start, distance, henon_heiles, kepler, observed_order};

/// What a run of the tables shows.
#[derive(Debug)]
struct Figures {
    error: f64,
    energy: f64,
    alpha: f64,
}

/// Kepler e = 0.6 over 2 periods with n steps per period, the error against the start, which the flow returns
/// to.
fn two_periods<T: Float>(method: Method, n: i64) -> Figures {
    let (h, start) = kepler::<T>(6);
    let step = T::two_pi() / T::int(n);
    let mut run = method
        .step(step)
        .start(&h, &start.q, &start.p, T::int(0))
        .unwrap();
    for _ in 0..2 * n {
        run.advance().unwrap();
    }
    let view = run.view();
    let end: Vec<T> = view.q.iter().chain(view.p).copied().collect();
    let certificate = run.certificate();
    let largest = |(low, high): &(T, T)| low.abs().max(high.abs()).to_f64();
    Figures {
        error: distance(&end, &start.state()).to_f64(),
        energy: certificate.energy.unwrap().max.to_f64(),
        alpha: certificate
            .alpha_range
            .iter()
            .map(largest)
            .fold(0.0, f64::max),
    }
}

/// [s, n, Gauss error, Gauss max |ΔH|, error with the last α only, its max |α|], computed independently in
/// quadruple precision.
const TABLE: [(usize, i64, f64, f64, f64, f64); 8] = [
    (2, 80, 5.872e-3, 2.24e-5, 5.33e-4, 4.922e-4),
    (2, 160, 3.906e-4, 1.50e-6, 3.354e-5, 1.237e-4),
    (2, 320, 2.476e-5, 9.53e-8, 2.1e-6, 3.09e-5),
    (3, 80, 6.581e-5, 2.72e-7, 1.728e-6, 4.652e-3),
    (3, 160, 9.952e-7, 4.11e-9, 2.742e-8, 4.929e-3),
    (3, 320, 1.544e-8, 6.38e-11, 4.279e-10, 6.363e-4),
    (4, 160, 1.961e-10, 1.51e-12, 4.312e-11, 1.346e-3),
    (4, 320, 8.217e-13, 5.57e-15, 1.691e-13, 8.058e-4),
];

/// [s, n, error] with α_{s−1} = 0.02 throughout.
const FIXED_ALPHA: [(usize, i64, f64); 6] = [
    (3, 80, 5.26e-3),
    (3, 160, 3.32e-4),
    (3, 320, 2.08e-5),
    (4, 80, 2.44e-5),
    (4, 160, 3.84e-7),
    (4, 320, 6.01e-9),
];

/// `found` within 1 % of a table entry.
fn agrees(what: &str, s: usize, n: i64, found: f64, table: f64) {
    let off = found / table - 1.0;
    println!(
        "s={s} n={n:<4} {what:<22} {found:.4e}  table {table:.4e}  {:+.3} %",
        100.0 * off
    );
    assert!(
        off.abs() <= 0.01,
        "{what}, s = {s}, n = {n}: {found:e}, table {table:e}"
    );
}

#[test]
fn gauss_has_the_errors_of_the_table() {
    for (s, n, error, energy, _, _) in TABLE {
        let found = two_periods::<DoubleDouble>(Gauss::stages(s), n);
        agrees("Gauss error", s, n, found.error, error);
        agrees("Gauss max |dH|", s, n, found.energy, energy);
    }
}

#[test]
#[ignore = "known deficit: largest alpha 7.3e-4, 4.9e-4 in the table (s = 2, n = 80)"]
fn the_single_alpha_of_the_paper_has_the_errors_of_the_table() {
    for (s, n, _, _, error, alpha) in TABLE {
        let method = Equip::stages(s).alphas(Alphas::Last);
        let found = two_periods::<DoubleDouble>(method, n);
        agrees("last alpha: error", s, n, found.error, error);
        agrees("last alpha: max |alpha|", s, n, found.alpha, alpha);
        assert!(
            found.energy < 1e-29,
            "s = {s}, n = {n}: energy error {:e}",
            found.energy
        );
    }
}

#[test]
fn a_fixed_alpha_has_the_errors_of_the_table() {
    for (s, n, error) in FIXED_ALPHA {
        let found = two_periods::<DoubleDouble>(Method::fixed_alpha(s, ratio(1, 50)), n);
        agrees("fixed alpha: error", s, n, found.error, error);
    }
}

/// End state of a Kepler arc from a point that is no apsis, over t = 1 with n steps: along it no slope ∂g/∂α
/// vanishes, so that the single α of the paper shows its order as clearly as the others.
fn arc<T: Float>(method: Method, n: i64) -> Vec<T> {
    let (h, _) = kepler::<T>(6);
    let q = [T::ratio(3, 5), T::ratio(7, 10)];
    let p = [T::ratio(-9, 10), T::ratio(1, 2)];
    let mut run = method
        .step(T::ratio(1, n))
        .start(&h, &q, &p, T::int(0))
        .unwrap();
    for _ in 0..n {
        run.advance().unwrap();
    }
    let view = run.view();
    [view.q, view.p].concat()
}

/// Doubles n from `first` until the error is below `least`: every observed order is `order` ± `tolerance`.
fn down_to<T: Float>(least: f64, method: Method, (order, tolerance): (usize, f64), first: i64) {
    let exact = arc::<T>(Gauss::stages(14), 96);
    let error = |n: i64| distance(&arc::<T>(method, n), &exact);
    let (mut n, mut coarse) = (first, error(first));
    while coarse.to_f64() > least {
        n *= 2;
        let fine = error(n);
        let observed = observed_order(coarse, fine);
        println!(
            "{method}, {}: n = {n:<5} error {fine:.2e}, order {observed:.3}",
            T::NAME
        );
        assert!(
            (observed - order as f64).abs() <= tolerance,
            "{method}: {observed} at n = {n}"
        );
        coarse = fine;
    }
}

/// The error to go down to: what takes a second. Below 1e-29 the α's are at the round-off level.
fn least_error(order: usize) -> f64 {
    match order {
        2 => 1e-7,
        4 => 1e-14,
        6 => 1e-22,
        _ => 5e-26,
    }
}

fn has_order(method: Method, order: usize, first: i64) {
    let expected = (order, 0.1);
    down_to::<DoubleDouble>(least_error(order), method, expected, first);
}

#[test]
fn gauss_has_order_2s() {
    for s in 1..=6 {
        has_order(Gauss::stages(s), 2 * s, 16);
    }
}

#[test]
fn equip_has_order_2s() {
    // With three stages it is 6.26, 5.96, 6.22 with less steps, and from there on 6.06, 6.01, 6.00.
    for (s, first) in [(2, 16), (3, 32), (4, 16), (5, 16), (6, 16)] {
        has_order(Equip::stages(s), 2 * s, first);
    }
}

#[test]
fn the_single_alpha_of_the_paper_has_order_2s() {
    for s in 2..=6 {
        let method = Equip::stages(s).alphas(Alphas::Last);
        has_order(method, 2 * s, 16);
    }
}

#[test]
fn a_fixed_alpha_has_order_2s_minus_2() {
    for s in 2..=6 {
        let method = Method::fixed_alpha(s, ratio(1, 50));
        has_order(method, 2 * s - 2, 16);
    }
}

#[test]
fn orders_in_f64_down_to_its_rounding() {
    for s in 2..=4 {
        for method in [
            Gauss::stages(s),
            Equip::stages(s),
            Equip::stages(s).alphas(Alphas::Last),
        ] {
            // Below 1e-12 rounding weighs more than the tenth of an order.
            let first = if method == Equip::stages(3) { 8 } else { 4 };
            down_to::<f64>([1e-9, 2e-10, 1e-9][s - 2], method, (2 * s, 0.1), first);
        }
    }
}

/// α_k by responses in double-double: the order, an error below that of Gauss, the energy at round-off, and
/// no Newton.
#[test]
fn responses_have_order_2s_in_double_double() {
    type D = DoubleDouble;
    let (h, _) = kepler::<D>(6);
    let q = [D::ratio(3, 5), D::ratio(7, 10)];
    let p = [D::ratio(-9, 10), D::ratio(1, 2)];
    let exact = arc::<D>(Gauss::stages(14), 96);
    for (s, first) in [(3, 64), (4, 32), (6, 16)] {
        let error = |n: i64| {
            let step = Equip::stages(s).step(D::ratio(1, n));
            let step = step.preconditioner(Preconditioner::Automatic);
            let mut run = step.start(&h, &q, &p, D::int(0)).unwrap();
            for _ in 0..n {
                let defect = run.advance().unwrap().energy_error.unwrap();
                assert!(
                    defect.abs() < D::exact(1e-30),
                    "s = {s}, n = {n}: {defect:e}"
                );
            }
            assert_eq!(run.counts().newton_iterations, 0);
            let view = run.view();
            distance(&[view.q, view.p].concat(), &exact)
        };
        let (coarse, fine) = (error(first), error(2 * first));
        let order = observed_order(coarse, fine);
        let gauss = distance(&arc::<D>(Gauss::stages(s), 2 * first), &exact);
        println!("s = {s}: {coarse:.2e} {fine:.2e}, order {order:.3}, Gauss {gauss:.2e}");
        assert!((order - 2.0 * s as f64).abs() <= 0.3, "s = {s}: {order}");
        assert!(fine < gauss, "s = {s}: {fine:e}, Gauss {gauss:e}");
    }
}

/// A slope ∂g/∂α that vanishes along the way: order 2s stays with all α's free, to within the sign changes.
#[test]
fn all_alphas_keep_the_order_where_slopes_vanish() {
    let end = |method: Method, n: i64| {
        type D = DoubleDouble;
        let (h, Start { q, p }) = henon_heiles::<D>(D::ratio(1, 12), "0.3", "0.2");
        let mut run = method
            .step(D::ratio(2, n))
            .start(&h, &q, &p, D::int(0))
            .unwrap();
        for _ in 0..n {
            run.advance().unwrap();
        }
        let view = run.view();
        [view.q, view.p].concat()
    };
    let exact = end(Gauss::stages(12), 64);
    for s in 3..=6 {
        let error = |n: i64| distance(&end(Equip::stages(s), n), &exact);
        // Over 3 doublings, so that one step near a sign change weighs less; measured 5.95, 7.91, 9.96,
        // 11.96.
        let order = observed_order(error(8), error(64)) / 3.0;
        println!("s = {s}: {order:.3}");
        assert!((order - 2.0 * s as f64).abs() <= 0.3);
    }
}
