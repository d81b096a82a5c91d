//! Bicubic splines against SciPy 1.17.1 (`RectBivariateSpline`, which is not-a-knot), and against functions.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.
#![allow(clippy::excessive_precision)] // Digits of another program.

use equip_autodiff::Hamiltonian;
use equip_scalar::{DoubleDouble, Float};
use equip_tables::Table2;

const X: [f64; 5] = [0.0, 0.5, 1.2, 2.0, 3.0];
const Y: [f64; 6] = [-1.0, 0.0, 0.4, 1.5, 2.0, 2.2];
#[rustfmt::skip]
const Z: [[f64; 6]; 5] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.319, 0.479, 0.555, 0.805, 0.945, 1.006],
    [0.485, 0.932, 1.133, 1.77, 2.11, 2.256],
    [0.102, 0.909, 1.254, 2.283, 2.8, 3.016],
    [-1.181, 0.141, 0.673, 2.15, 2.829, 3.102],
];
/// (x, y), and there z, z_x, z_y, z_xx, z_xy, z_yy.
#[rustfmt::skip]
const EXPECTED: [([f64; 2], [f64; 6]); 5] = [
    ([0.2, -0.5], [0.16794418242235504, 0.8116950332162299, 0.05772297616721017, -0.32695455564270665, 0.31149802715459435, 0.02015757430292519]),
    ([1.0, 0.2], [0.9223658016652472, 0.6330456562146332, 0.4111704667688, -0.8563735516492532, 0.4555998666502317, 0.07891278162344151]),
    ([1.9, 1.6], [2.350355665172031, 0.3797980174924246, 0.9750741141519833, -0.9320652572721146, 0.39648460918753026, 0.13891365174798295]),
    ([2.7, 2.1], [3.0245503481329816, -0.1027265675419157, 1.2895671488917797, -0.6722912695814149, 0.26065854428447827, 0.05552488559872372]),
    ([0.5, 0.4], [0.5550000000000002, 1.042834147954575, 0.19843433058863372, -0.4151963479158621, 0.43760213720336577, 0.04197579868202562]),
];

/// z and its derivatives by an energy.
fn derivatives<T: Float>(table: &Table2, at: [T; 2]) -> [T; 6] {
    let h = Hamiltonian::new(2, |q, p| p[0] * p[1] + table.at(q[0], q[1])).unwrap();
    let mut evaluator = h.evaluator::<T>();
    let zero = T::int(0);
    let y = [at[0], at[1], zero, zero];
    let mut gradient = [zero; 4];
    let value = evaluator.gradient(&y, &mut gradient);
    let mut columns = [[zero; 4]; 2];
    for (k, column) in columns.iter_mut().enumerate() {
        let mut v = [zero; 4];
        v[k] = T::int(1);
        evaluator.hessian_vector(&y, &v, column);
    }
    assert!((columns[0][1] - columns[1][0]).abs() <= T::EPSILON * T::int(8));
    let [x, y] = columns;
    [value, gradient[0], gradient[1], x[0], x[1], y[1]]
}

/// Measured: 4e-14 in ∂²z/∂y² near the edge, the same in double-double: the rounding of SciPy.
#[test]
fn as_scipy() {
    let table = Table2::not_a_knot(&X, &Y, Z.as_flattened()).unwrap();
    for (at, expected) in EXPECTED {
        let found = derivatives(&table, at);
        let wide = derivatives(&table, at.map(DoubleDouble::from));
        for k in 0..6 {
            let errors = [found[k], wide[k].hi()].map(|x| (x - expected[k]).abs());
            assert!(errors.iter().all(|&e| e < 2e-13), "{at:?} {k} {errors:?}");
        }
        assert_eq!(table.value(at[0], at[1]), Ok(found[0]));
    }
    assert_eq!(table.range(), [0.0..=3.0, -1.0..=2.2]);
}

/// Products of cubic polynomials are their own splines: to 31 digits in double-double.
#[test]
fn products_of_cubics_are_reproduced() {
    let wide = |x: &[f64]| -> Vec<DoubleDouble> { x.iter().map(|&x| x.into()).collect() };
    let one = |x: DoubleDouble| (x * x - DoubleDouble::from(2.0)) * x;
    let other = |y: DoubleDouble| (y - DoubleDouble::PI) * y * y;
    let (x, y) = (wide(&X), wide(&Y));
    let values: Vec<DoubleDouble> = (x.iter())
        .flat_map(|&x| y.iter().map(move |&y| one(x) * other(y)))
        .collect();
    let table = Table2::not_a_knot(&x, &y, &values).unwrap();
    for (at, _) in EXPECTED {
        let at = at.map(DoubleDouble::from);
        let found = derivatives(&table, at)[0];
        let error = (found - one(at[0]) * other(at[1])).abs().hi();
        assert!(error < 1e-29, "{error:e}");
    }
}

/// Natural ends: along lines of the grid the spline in two variables is that in one.
#[test]
fn natural_ends() {
    let table = Table2::natural(&X, &Y, Z.as_flattened()).unwrap();
    for (row, &x) in Z.iter().zip(&X) {
        let line = equip_tables::Table::natural(&Y, row).unwrap();
        for i in 0..32 {
            let y = -1.0 + 0.1 * f64::from(i);
            let [expected, slope, bend, _] = line.derivatives(y).unwrap();
            let found = derivatives(&table, [x, y]);
            let errors = [found[0] - expected, found[2] - slope, found[5] - bend];
            assert!(errors.iter().all(|e| e.abs() < 1e-13), "{errors:?}");
        }
    }
    for y in Y {
        let ends = [0.0, 3.0].map(|x| derivatives(&table, [x, y])[3]);
        assert!(ends.iter().all(|bend| bend.abs() < 1e-13), "{ends:?}");
    }
}
