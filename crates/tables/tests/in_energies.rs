//! Tables within energies: in every number, at many points at once, the same bits.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, SwitchKind};
use equip_scalar::{DoubleDouble, FirstOrder, Float, InstructionSet, Num, Scalar};
use equip_tables::{Table, Table2};

/// Two degrees of freedom with a table of each kind.
struct Tables {
    one: Table,
    two: Table2,
}

impl Tables {
    fn new() -> Self {
        let x: Vec<f64> = (0..20)
            .map(|i| (f64::from(i) / 10.0).powi(3) - 3.0)
            .collect();
        let y: Vec<f64> = x.iter().map(|x| (1.3 * x).sin()).collect();
        let grid: Vec<f64> = (0..9).map(|i| f64::from(i) - 4.0).collect();
        let values: Vec<f64> = (grid.iter())
            .flat_map(|x| grid.iter().map(move |y| (x - 0.3 * y).cos()))
            .collect();
        Tables {
            one: Table::natural(&x, &y).unwrap(),
            two: Table2::not_a_knot(&grid, &grid, &values).unwrap(),
        }
    }

    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let kinetic = (p[0] * p[0] + p[1] * p[1]) / 2;
        kinetic + self.one.at(q[0] - q[1]) * q[0] + self.two.at(q[0], q[1] * q[1] - 2)
    }
}

/// None at a knot, where differences of y″ are those of either side.
fn points() -> Vec<[f64; 4]> {
    let number = |i: u32, k: f64| 1.4 * (f64::from(i) * k).sin();
    (1..25)
        .map(|i| {
            [
                number(i, 1.7),
                number(i, 2.3),
                number(i, 0.9),
                number(i, 3.1),
            ]
        })
        .collect()
}

fn bits<T: Float>(x: &[T]) -> Vec<[u64; 6]> {
    x.iter().map(|x| x.expansion().map(f64::to_bits)).collect()
}

/// H and ∇H one by one; then many at once, in all instructions and strides; the same bits.
fn many_at_once<T: Float>() {
    let tables = Tables::new();
    let recorded = Hamiltonian::new(2, |q, p| tables.energy(q, p)).unwrap();
    let points: Vec<[T; 4]> = points().iter().map(|y| y.map(T::exact)).collect();
    let mut one = recorded.evaluator::<T>();
    let mut expected = vec![[T::int(0); 4]; points.len()];
    for (y, expected) in points.iter().zip(&mut expected) {
        let value = one.gradient(y, expected);
        let [q, p] = [[Num(y[0]), Num(y[1])], [Num(y[2]), Num(y[3])]];
        assert_eq!(bits(&[value]), bits(&[tables.energy(&q, &p).0]));
    }
    for set in InstructionSet::available() {
        one.set_instruction_set(set);
        for stride in [1, 3, 4, 8, 16, 24] {
            for (states, expected) in points.chunks(stride).zip(expected.chunks(stride)) {
                let mut rows = vec![T::int(0); 4 * stride];
                let mut found = rows.clone();
                for (i, y) in states.iter().enumerate() {
                    (0..4).for_each(|c| rows[c * stride + i] = y[c]);
                }
                one.gradients_by_component(&rows, &mut found, stride, states.len());
                for (i, expected) in expected.iter().enumerate() {
                    let found: [T; 4] = std::array::from_fn(|c| found[c * stride + i]);
                    assert_eq!(bits(&found), bits(expected), "{set:?}, stride {stride}");
                }
            }
        }
    }
}

#[test]
fn many_at_once_in_doubles() {
    many_at_once::<f64>();
}

#[test]
fn many_at_once_in_double_double() {
    many_at_once::<DoubleDouble>();
}

/// Gradient and Hessian by the tape, by dual numbers with second derivatives, and by differences.
#[test]
fn derivatives_agree() {
    type T = DoubleDouble;
    let tables = Tables::new();
    let h = Hamiltonian::new(2, |q, p| tables.energy(q, p)).unwrap();
    let mut evaluator = h.evaluator::<T>();
    let step = T::from(1e-10);
    for y in points() {
        let y = y.map(T::from);
        let mut gradient = [T::ZERO; 4];
        evaluator.gradient(&y, &mut gradient);
        let duals: [Num<<T as Float>::Forward<4>>; 4] =
            std::array::from_fn(|i| Num(FirstOrder::variable(y[i], i)));
        let dual = tables.energy(&duals[..2], &duals[2..]).0;
        let near = |x: T, y: T, bound: f64| {
            assert!((x - y).abs().hi() < bound * (1.0 + x.abs().hi()), "{x} {y}");
        };
        for i in 0..4 {
            near(gradient[i], dual.gradient()[i], 1e-29);
            let mut v = [T::ZERO; 4];
            v[i] = T::ONE;
            let mut column = [T::ZERO; 4];
            evaluator.hessian_vector(&y, &v, &mut column);
            let mut moved = [[T::ZERO; 4]; 2];
            let values: [T; 2] = std::array::from_fn(|side| {
                let mut y = y;
                y[i] += if side == 0 { -step } else { step };
                evaluator.gradient(&y, &mut moved[side])
            });
            near(gradient[i], (values[1] - values[0]) / (step + step), 1e-17);
            for j in 0..4 {
                let difference = (moved[1][j] - moved[0][j]) / (step + step);
                near(column[j], difference, 1e-17);
            }
        }
    }
}

/// Third derivatives: the Hessian of an energy with y′ in it.
#[test]
fn third_derivatives() {
    let v = Table::natural(&[0.0, 0.5, 1.5, 2.0], &[0.0, 1.0, -1.0, 2.0]).unwrap();
    let h = Hamiltonian::new(1, |q, p| v.derivative_at(q[0]) + p[0]).unwrap();
    let mut evaluator = h.evaluator::<f64>();
    for x in [0.2, 0.5, 0.7, 1.9] {
        let mut product = [0.0; 2];
        evaluator.hessian_vector(&[x, 0.0], &[1.0, 0.0], &mut product);
        assert_eq!(product[0], v.derivatives(x).unwrap()[3]);
    }
}

/// What is known of such an energy, and that a table is one operation for each variable it is read at.
#[test]
fn structure() {
    let tables = Tables::new();
    let h = Hamiltonian::new(2, |q, p| tables.energy(q, p)).unwrap();
    let structure = h.structure();
    assert!(structure.separable);
    assert_eq!((structure.degree, structure.degree_in_p), (None, Some(2)));
    assert_eq!(structure.hessian.len(), 6);
    let v = &tables.one;
    let alone = Hamiltonian::new(1, |q, p| p[0] * p[0] * 0.5 + v.at(q[0])).unwrap();
    assert_eq!((alone.operations(), alone.gradient_operations()), (4, 1));
    let twice = Hamiltonian::new(1, |q, p| {
        p[0] * p[0] * 0.5 + v.at(q[0]) + v.clone().at(q[0])
    });
    assert_eq!(twice.unwrap().operations(), 5);
}

/// The bound of rounding is above what rounding makes of the value.
#[test]
fn rounding_is_below_its_bound() {
    let tables = Tables::new();
    let h = Hamiltonian::new(2, |q, p| tables.energy(q, p)).unwrap();
    let (mut evaluator, mut wide) = (h.evaluator::<f64>(), h.evaluator::<DoubleDouble>());
    for y in points() {
        let mut gradient = [0.0; 4];
        let (value, bound) = evaluator.gradient_with_bound(&y, &mut gradient);
        let exact = wide.value(&y.map(DoubleDouble::from));
        let error = (exact - DoubleDouble::from(value)).abs().hi();
        assert!(
            error <= bound * f64::EPSILON,
            "{error:e} {bound:e} at {y:?}"
        );
    }
}

/// A known switch changes its sign at every inner knot and nowhere else, and is smooth enough to be found.
#[test]
fn switches() {
    let x: Vec<f64> = (0..12).map(|i| f64::from(i).powf(1.5)).collect();
    let v = Table::natural(&x, &x.clone()).unwrap();
    let h = Hamiltonian::new(1, |q, p| p[0] + v.at(q[0]) + v.derivative_at(q[0])).unwrap();
    let switches = h.switches();
    assert_eq!(switches.kinds(), [SwitchKind::Knots]);
    let mut evaluator = switches.evaluator::<f64>();
    let mut wide = switches.evaluator::<DoubleDouble>();
    let mut at = |x: f64| {
        let (mut g, mut exact) = ([0.0], [DoubleDouble::ZERO]);
        evaluator.values(&[x, 0.0], &mut g);
        wide.values(&[x, 0.0].map(DoubleDouble::from), &mut exact);
        assert!((g[0] - exact[0].hi()).abs() <= 1e-14 * (1.0 + g[0].abs()));
        g[0]
    };
    let (mut changes, mut before) = (Vec::new(), at(-3.0));
    for i in -2999..50_000 {
        let x = 0.001 * f64::from(i);
        let now = at(x);
        // Its slope is 4 at knots, and never more.
        assert!((now - before).abs() < 0.005);
        if now * before < 0.0 || now == 0.0 {
            changes.push(x);
        }
        before = now;
    }
    assert_eq!(changes.len(), 10);
    for (change, knot) in changes.iter().zip(&x[1..]) {
        assert!((change - knot).abs() < 0.0011, "{change} {knot}");
    }
    let grid = Tables::new();
    let h = Hamiltonian::new(2, |q, p| grid.energy(q, p)).unwrap();
    let switches = h.switches();
    assert_eq!(switches.kinds(), [SwitchKind::Knots; 3]);
    let mut g = [0.0; 3];
    let y = [-2.5, 1.0, 0.0, 0.0];
    switches.evaluator().values(&y, &mut g);
    // −2.5 and 1² − 2 = −1 on the grid −4, −3, …, 4.
    assert_eq!(g[1..], [-1.0, 0.0]);
    let line = Table::natural(&[0.0, 1.0], &[0.0, 1.0]).unwrap();
    let h = Hamiltonian::new(1, |q, _| line.at(q[0])).unwrap();
    assert!(h.switches().is_empty());
}

/// The domain of an energy is that of the arguments of its tables, of those that do not extrapolate.
#[test]
fn tables_end_unless_they_are_extrapolated() {
    let v = Table::natural(&[-1.0, 0.0, 2.0], &[1.0, 0.0, 4.0]).unwrap();
    let two = Table2::natural(&[0.0, 1.0], &[0.0, 3.0], &[0.0; 4]).unwrap();
    let argument = |h: &Hamiltonian, y: &[f64]| {
        let mut domains = h.switches().domains().evaluator();
        domains.check(y).err().map(|outside| outside.argument)
    };
    let h = Hamiltonian::new(1, |q, p| v.at(2 * q[0]) + v.extrapolated().at(q[0]) + p[0]).unwrap();
    for (q, outside) in [
        (0.3, None),
        (1.0, None),
        (1.1, Some(2.2)),
        (-0.6, Some(-1.2)),
    ] {
        assert_eq!(argument(&h, &[q, 0.0]), outside, "{q}");
    }
    let read = |bytes: &[u8]| equip_tables::from_bytes(bytes).ok();
    let again = Hamiltonian::from_bytes_with(&h.to_bytes().unwrap(), read);
    assert_eq!(argument(&again.unwrap(), &[1.1, 0.0]), Some(2.2));
    let h = Hamiltonian::new(1, |q, p| two.at(q[0], p[0])).unwrap();
    assert_eq!(argument(&h, &[0.5, 3.5]), Some(3.5));
    assert_eq!(argument(&h, &[0.5, 2.5]), None);
    let h = Hamiltonian::new(1, |q, p| two.extrapolated().at(q[0], p[0])).unwrap();
    assert_eq!(argument(&h, &[7.0, 3.5]), None);
    // Beyond it is the same polynomial.
    let same = Hamiltonian::new(1, |q, p| v.extrapolated().at(q[0]) + p[0]).unwrap();
    let table = Hamiltonian::new(1, |q, p| v.at(q[0]) + p[0]).unwrap();
    let [a, b] = [same, table].map(|h| h.evaluator::<f64>().value(&[5.0, 0.0]));
    assert_eq!(a.to_bits(), b.to_bits());
}
