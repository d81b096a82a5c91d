//! Known systems: as direct evaluation and num-dual have them, and their structure is what it is on paper.
#![allow(clippy::unwrap_used)]

use crate::common::{
    Chain, ChargedParticle, DoublePendulum, Energy, HenonHeiles, Kepler, Pendulum, Pythagorean,
    Random, same_bits, widened,
};
use equip_autodiff::{Hamiltonian, Structure, Var};
use equip_scalar::{DoubleDouble, FirstOrder, Float, ratio};

fn close<T: Float>(a: &[T], b: &[T], units: i64) {
    let largest = a
        .iter()
        .map(|x| x.abs())
        .fold(T::int(0), |a, b| if b > a { b } else { a });
    for (a, b) in a.iter().zip(b) {
        let allowed = T::EPSILON * T::int(units) * largest;
        assert!((*a - *b).abs() <= allowed, "{a} {b}");
    }
}

/// The value by the operations as they are written, to the last bit; the gradient by num-dual of length N,
/// and the Hessian by its products with the unit vectors.
fn agree<T: Float, const N: usize>(energy: &impl Energy, y: &[T]) {
    let h = energy.hamiltonian();
    let dual = energy.by_num_dual::<T, N>(y);
    let mut evaluator = h.evaluator();
    let (mut gradient, mut several) = ([T::int(0); N], [T::int(0); N]);
    let (value, direct) = (evaluator.gradient(y, &mut gradient), energy.direct(y));
    assert!(same_bits(value, direct), "{value} {direct}");
    close(&[value], &[dual.value()], 16);
    close(&gradient, &dual.gradient(), 64);
    evaluator.gradients(y, &mut several, N);
    assert_eq!(gradient, several);

    let pattern = &h.structure().hessian;
    let mut entries = vec![T::int(0); pattern.len()];
    evaluator.hessian(y, &mut entries);
    let mut dense = [[T::int(0); N]; N];
    for (i, row) in dense.iter_mut().enumerate() {
        pattern
            .row(i)
            .for_each(|(entry, j)| row[j] = entries[entry]);
    }
    let dense = dense.concat();
    let mut columns = [[T::int(0); N]; N];
    for (j, column) in columns.iter_mut().enumerate() {
        let unit: [T; N] = std::array::from_fn(|i| T::int(i64::from(i == j)));
        evaluator.hessian_vector(y, &unit, column);
    }
    close(&dense, columns.as_flattened(), 256);
    for i in 0..N {
        for j in 0..N {
            assert!(
                dense[N * i + j] == dense[N * j + i],
                "symmetric to the last bit"
            );
        }
    }
    let v: [T; N] = std::array::from_fn(|i| T::ratio(i as i64 + 1, 3));
    let mut product = [T::int(0); N];
    evaluator.hessian_vector(y, &v, &mut product);
    let times_v = |row: &[T]| (row.iter().zip(&v)).fold(T::int(0), |sum, (&h, &v)| sum + h * v);
    let expected: Vec<T> = dense.chunks(N).map(times_v).collect();
    close(&product, &expected, 256);
}

macro_rules! agreement {
    ($($name:ident: $energy:expr, $n:literal;)*) => {$(
        #[test]
        fn $name() {
            let mut random = Random(0x5eed_0004);
            for _ in 0..20 {
                let y: Vec<f64> = (0..$n).map(|_| random.within(0.2, 1.7)).collect();
                agree::<f64, $n>(&$energy, &y);
                agree::<DoubleDouble, $n>(&$energy, &widened(&y));
            }
        }
    )*};
}

agreement! {
    kepler: Kepler, 4;
    henon_heiles: HenonHeiles, 4;
    pendulum: Pendulum, 2;
    double_pendulum: DoublePendulum, 4;
    charged_particle: ChargedParticle, 6;
    short_chain: Chain(4), 8;
    long_chain: Chain(9), 18;
    pythagorean: Pythagorean, 12;
}

fn entries(structure: &Structure) -> Vec<(usize, usize)> {
    let pattern = &structure.hessian;
    let row = |i| pattern.row(i).map(move |(_, j)| (i, j));
    (0..pattern.dimension()).flat_map(row).collect()
}

fn structure_of(energy: impl Energy) -> Structure {
    energy.hamiltonian().structure().clone()
}

#[test]
fn structure_on_paper() {
    let kepler = structure_of(Kepler);
    assert!(kepler.separable && !kepler.is_quadratic());
    assert_eq!(
        (kepler.degree, kepler.degree_in_q, kepler.degree_in_p),
        (None, None, Some(2))
    );
    assert_eq!(
        entries(&kepler),
        [(0, 0), (0, 1), (1, 0), (1, 1), (2, 2), (3, 3)]
    );

    let henon = structure_of(HenonHeiles);
    assert!(henon.separable);
    assert_eq!(
        (henon.degree, henon.degree_in_q, henon.degree_in_p),
        (Some(3), Some(3), Some(2))
    );
    assert_eq!(
        entries(&henon),
        [(0, 0), (0, 1), (1, 0), (1, 1), (2, 2), (3, 3)]
    );

    let pendulum = structure_of(Pendulum);
    assert!(pendulum.separable);
    assert_eq!((pendulum.degree, pendulum.degree_in_p), (None, Some(2)));
    assert_eq!(entries(&pendulum), [(0, 0), (1, 1)]);

    let double = structure_of(DoublePendulum);
    assert!(!double.separable);
    assert_eq!(
        (double.degree, double.degree_in_q, double.degree_in_p),
        (None, None, Some(2))
    );
    assert_eq!(double.hessian.len(), 16);

    let charged = structure_of(ChargedParticle);
    assert!(!charged.separable && charged.is_quadratic());
    assert_eq!(
        (charged.degree_in_q, charged.degree_in_p),
        (Some(2), Some(2))
    );
    let expected = [
        (0, 0),
        (0, 4),
        (1, 1),
        (1, 3),
        (2, 2),
        (3, 1),
        (3, 3),
        (4, 0),
        (4, 4),
        (5, 5),
    ];
    assert_eq!(entries(&charged), expected);

    let bodies = structure_of(Pythagorean);
    assert!(bodies.separable);
    assert_eq!((bodies.degree_in_q, bodies.degree_in_p), (None, Some(2)));
    assert_eq!(bodies.hessian.len(), 36 + 6);

    let chain = structure_of(Chain(50));
    assert!(chain.separable);
    assert_eq!(
        (chain.degree, chain.degree_in_q, chain.degree_in_p),
        (Some(4), Some(4), Some(2))
    );
    assert_eq!(chain.hessian.len(), 50 + 2 * 49 + 50);
}

fn structure(h: impl FnOnce(&[Var], &[Var]) -> Var) -> Structure {
    Hamiltonian::new(2, h).unwrap().structure().clone()
}

#[test]
fn structure_of_corner_cases() {
    // Factors and signs over sums of both kinds separate; products of both do not.
    assert!(structure(|q, p| -(0.5 * (q[0].sin() + p[0].exp()) - q[1]) / 3.0).separable);
    assert!(structure(|q, p| (q[0] * q[1]) + (p[0] / p[1])).separable);
    assert!(!structure(|q, p| q[0] * p[0]).separable);
    assert!(!structure(|q, p| (q[0] + p[0]).powi(2)).separable);
    assert!(!structure(|q, p| q[0].max(p[0])).separable);
    assert!(!structure(|q, p| (q[0] + p[0]).abs()).separable);
    assert!(!structure(|q, p| q[0] / p[0]).separable);
    assert!(!structure(|q, p| q[0].sin() + p[0] + (q[1] - p[0]).sin()).separable);
    // Conservative: a cancelling term is not seen to cancel.
    let cancelling = structure(|q, p| p[0] * p[0] + q[0] * p[1].sin() - q[0] * p[1].sin());
    assert!(!cancelling.separable && cancelling.degree.is_none());
    // Degrees.
    assert_eq!(structure(|q, _| q[0].powi(3) * q[1] / 7.0).degree, Some(4));
    assert_eq!(
        structure(|q, p| q[0] * q[0] * p[0].exp()).degree_in_q,
        Some(2)
    );
    assert_eq!(structure(|q, p| q[0] * q[0] * p[0].exp()).degree_in_p, None);
    assert_eq!(structure(|q, p| q[0].powi(2) / p[0]).degree_in_q, Some(2));
    assert_eq!(structure(|q, _| q[0].powf(2.0)).degree, Some(2));
    assert_eq!(structure(|q, _| q[0].powf(2.5)).degree, None);
    assert_eq!(structure(|q, _| q[0].powi(-1)).degree, None);
    assert_eq!(structure(|q, _| q[0].abs()).degree, None);
    assert_eq!(structure(|q, _| q[0].min(q[1])).degree, None);
    assert_eq!(structure(|_, p| p[0] + 2.0).degree, Some(1));
    assert_eq!(
        structure(|q, _| q[0] * Var::from(2.0).sqrt()).degree,
        Some(1)
    );
    assert_eq!(
        structure(|q, _| q[0].powi(i32::MAX).powi(i32::MAX)).degree,
        Some(u32::MAX)
    );
    // Sparsity: no diagonal for a product, none at all for what is linear piece by piece.
    assert_eq!(entries(&structure(|q, _| q[0] * q[1])), [(0, 1), (1, 0)]);
    assert_eq!(
        entries(&structure(|q, p| q[0] / p[1])),
        [(0, 3), (3, 0), (3, 3)]
    );
    assert_eq!(
        entries(&structure(|q, p| (q[0] - 3.0 * p[1]).abs().max(q[1]))),
        []
    );
    assert_eq!(entries(&structure(|q, _| (2.0 * q[0]) * ratio(1, 3))), []);
    assert_eq!(
        entries(&structure(|q, _| q[0] / 3.0 + (Var::from(2.0) / 5.0).exp())),
        []
    );
    // A term that does not reach H leaves no trace.
    let unused = structure(|q, p| {
        let _ = (q[0] * p[0]).sin();
        q[0] + p[0]
    });
    assert!(unused.separable && unused.hessian.is_empty());
}
