//! What makes no table is refused, in words that say what to change.

use equip_tables::{Table, Table2, TableError};

#[test]
fn data_that_make_no_table() {
    let natural = |x: &[f64], y: &[f64]| Table::natural(x, y).err();
    assert_eq!(
        natural(&[1.0], &[1.0]),
        Some(TableError::TooFewKnots {
            found: 1,
            needed: 2
        })
    );
    assert_eq!(
        Table::not_a_knot(&[1.0, 2.0, 3.0], &[0.0; 3]).err(),
        Some(TableError::TooFewKnots {
            found: 3,
            needed: 4
        })
    );
    assert_eq!(
        natural(&[1.0, 2.0], &[1.0]),
        Some(TableError::Lengths {
            knots: 2,
            values: 1
        })
    );
    for twice in [[0.0, 1.0, 1.0], [0.0, 1.0, 0.5]] {
        let found = natural(&twice, &[0.0; 3]);
        assert_eq!(found, Some(TableError::NotAscending { index: 2 }));
    }
    let not_finite = |what, index| Some(TableError::NotFinite { what, index });
    assert_eq!(natural(&[0.0, f64::NAN], &[0.0; 2]), not_finite("knot", 1));
    assert_eq!(
        natural(&[0.0, 1.0], &[f64::INFINITY, 0.0]),
        not_finite("value", 0)
    );
    let clamped = Table::clamped(&[0.0, 1.0], &[0.0; 2], [0.0, f64::NAN]);
    assert_eq!(clamped.err(), not_finite("condition at end", 1));
    let steep = natural(&[0.0, 1e-200, 1.0], &[0.0, 1e200, 0.0]);
    assert_eq!(steep, Some(TableError::Overflow { index: 0 }));
}

#[test]
fn grids_that_make_no_table() {
    let two = |x: &[f64], y: &[f64], values: &[f64]| Table2::natural(x, y, values).err();
    assert_eq!(
        two(&[0.0, 1.0], &[0.0, 1.0, 2.0], &[0.0; 5]),
        Some(TableError::Lengths {
            knots: 6,
            values: 5
        })
    );
    assert_eq!(
        two(&[0.0, 1.0], &[1.0, 0.0], &[0.0; 4]),
        Some(TableError::NotAscending { index: 1 })
    );
    assert_eq!(
        Table2::not_a_knot(&[0.0, 1.0], &[0.0, 1.0], &[0.0; 4]).err(),
        Some(TableError::TooFewKnots {
            found: 2,
            needed: 4
        })
    );
}

#[test]
fn values_outside() {
    let table = Table::natural(&[0.0, 1.0], &[0.0, 1.0]);
    let outside = table.and_then(|table| table.derivatives(1.5));
    let expected = TableError::OutsideOfTable {
        x: 1.5,
        first: 0.0,
        last: 1.0,
    };
    assert_eq!(outside, Err(expected));
    let nan = Table::natural(&[0.0, 1.0], &[0.0, 1.0]).and_then(|t| t.derivatives(f64::NAN));
    assert!(matches!(nan, Err(TableError::OutsideOfTable { .. })));
    let table = Table2::natural(&[0.0, 1.0], &[2.0, 3.0], &[0.0, 1.0, 2.0, 3.0]);
    let found = table
        .as_ref()
        .map(|t| (t.value(0.5, 2.5), t.value(0.5, 1.0)));
    let expected = TableError::OutsideOfTable {
        x: 1.0,
        first: 2.0,
        last: 3.0,
    };
    assert_eq!(found, Ok((Ok(1.5), Err(expected))));
}

#[test]
fn words() {
    let found = Table::natural(&[0.0, 2.0, 1.0], &[0.0; 3]).map_err(|e| e.to_string());
    let text = "knot 2 is not larger than the knot before; sort the knots and give each once";
    assert_eq!(found.err().as_deref(), Some(text));
}
