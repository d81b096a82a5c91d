//! Parts of an energy that are given as data or as code, for use inside of H.
//!
//! | type | what it is | derivatives |
//! |---|---|---|
//! | [`Table`] | the cubic spline through points (x_i, y_i) | all, y‴ piece by piece |
//! | [`Table2`] | the bicubic spline through values on a grid | all, third ones piece by piece |
//! | [`floor`] | the largest integer up to x | 0 |
//! | [`Custom`] | closures for f, f′, f″ | f‴ by differences |
//!
//! ```
//! use equip_autodiff::Hamiltonian;
//! use equip_tables::Table;
//!
//! let x = [0.0, 0.5, 1.5, 2.0];
//! let v = Table::natural(&x, &x.map(|x| x * x))?;
//! let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0]))?;
//! assert_eq!(h.evaluator().value(&[1.5, 2.0]), 2.0 + 2.25);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! All are an [`Outside`](equip_scalar::Outside): in a recording one operation, whatever stands behind it,
//! and its derivatives another. They work in every kind of number. As sines, they are replayed from the tape
//! and not part of machine code. A value of a [`Table`] costs 10 ns in `f64`, 0.1 µs in double-double, of a
//! [`Table2`] 40 ns and 0.4 µs, however many intervals there are (knots crowded in one place: log₂ of their
//! number more).
#![forbid(unsafe_code)]

mod alternating;
mod bytes;
mod custom;
mod error;
mod knots;
mod polynomial;
mod read;
mod spline;
mod table;
mod table2;
mod whole;

pub use custom::Custom;
pub use error::TableError;
pub use read::from_bytes;
pub use table::Table;
pub use table2::Table2;
pub use whole::floor;
