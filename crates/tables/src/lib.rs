//! Parts of an energy that are given as data or as code.
//!
//! | item | meaning | derivatives |
//! |---|---|---|
//! | [`Table`] | the cubic spline through points (x_i, y_i) | all; y‴ is piecewise constant |
//! | [`Table2`] | the bicubic spline through values on a grid | all; third ones jump at the grid lines |
//! | [`floor`] | the largest integer not above x | 0 |
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
//! All implement [`Outside`](equip_scalar::Outside). In a trace, each call is one operation, and each
//! derivative another operation. They work in every floating-point type. Like sines, they are replayed and
//! not compiled to machine code. A value of a [`Table`] costs 10 ns in `f64` and 0.1 µs in double-double, a
//! value of a [`Table2`] 40 ns and 0.4 µs, for any number of intervals. For crowded knots the cost grows like
//! log₂ of their number.
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
