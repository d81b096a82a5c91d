//! Tables as bytes, alone and within an energy.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{BytesError, Hamiltonian};
use equip_scalar::{DoubleDouble, Num, Outside, Scalar};
use equip_tables::{Custom, Table, Table2, TableError, from_bytes};
use std::sync::Arc;

const X: [f64; 5] = [-2.0, -1.0, 0.5, 1.0, 3.0];

fn tables() -> Vec<Table> {
    let y = X.map(f64::sin);
    vec![
        Table::natural(&X, &y).unwrap(),
        Table::clamped(&X, &y, [0.3, -0.2]).unwrap(),
        Table::with_curvatures(&X, &y, [0.1, 0.7]).unwrap(),
        Table::not_a_knot(&X, &y).unwrap(),
    ]
}

fn surface() -> Table2 {
    let values: Vec<f64> = (X.iter().flat_map(|x| X.map(|y| (x - 0.3 * y).cos()))).collect();
    Table2::not_a_knot(&X, &X, &values).unwrap()
}

fn read(bytes: &[u8]) -> Option<Arc<dyn Outside>> {
    from_bytes(bytes).ok()
}

#[test]
fn energies_with_tables_come_back_bit_for_bit() {
    for table in tables() {
        let surface = surface();
        let h = Hamiltonian::new(2, |q, p| {
            p[0] * p[0] + table.at(q[0]) + table.derivative_at(q[1]) + surface.at(q[0], q[1])
        })
        .unwrap();
        let bytes = h.to_bytes().unwrap();
        let again = Hamiltonian::from_bytes_with(&bytes, read).unwrap();
        for y in [[0.3, -0.7, 0.1, 0.2], [-3.0, 4.0, 0.0, 0.0]] {
            let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
            let values = (
                h.evaluator().gradient(&y, &mut a),
                again.evaluator().gradient(&y, &mut b),
            );
            assert_eq!((values.0.to_bits(), a), (values.1.to_bits(), b));
            let wide = y.map(DoubleDouble::from);
            assert_eq!(h.evaluator().value(&wide), again.evaluator().value(&wide));
        }
        assert_eq!(h.switches().len(), again.switches().len());
        let error = Hamiltonian::from_bytes(&bytes).unwrap_err();
        assert_eq!(error, BytesError::UnknownFunction);
    }
}

#[test]
fn damaged_tables_are_refused_or_are_tables() {
    let outside = |h: &Hamiltonian| h.to_bytes().unwrap();
    let h = Hamiltonian::new(1, |q, _| tables()[1].at(q[0])).unwrap();
    let bytes = outside(&h);
    // The table stands behind the head, the five lengths and its own length.
    let length = u64::from_le_bytes(bytes[41..49].try_into().unwrap()) as usize;
    let table = &bytes[49..49 + length];
    assert!(from_bytes(table).is_ok());
    for at in 0..table.len() {
        assert_eq!(from_bytes(&table[..at]).unwrap_err(), TableError::Damaged);
        for value in [0, 1, 2, 3, 255] {
            let mut other = table.to_vec();
            other[at] = value;
            if let Ok(table) = from_bytes(&other) {
                table.derivative([1, 0], [0.3, 0.0]);
            }
        }
    }
    let longer = [table, &[0]].concat();
    assert_eq!(from_bytes(&longer).unwrap_err(), TableError::Damaged);
    assert_eq!(from_bytes(&[]).unwrap_err(), TableError::Damaged);
}

#[test]
fn closures_are_code() {
    let custom = Custom::new(|x| -x.cos(), |x| x.sin(), |x| x.cos());
    let h = Hamiltonian::new(1, |q, _| custom.at(q[0])).unwrap();
    assert!(matches!(h.to_bytes(), Err(BytesError::NotData { .. })));
    let value = custom.at(Num(1.0)).0;
    assert_eq!(value, -<f64 as Scalar>::cos(1.0));
}
