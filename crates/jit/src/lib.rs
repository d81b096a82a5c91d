//! Straight-line arithmetic on lanes of doubles as machine code, made when the program runs.
//!
//! A recorded energy is known only when the program runs. Replayed, each operation has to be found, its
//! operands be read from memory and its result be written there; as machine code of its own it stands between
//! those it belongs to, and numbers stay in registers.
//!
//! [`Program`] → registers (farthest next use) → bytes (by iced-x86) → executable memory (by memmap2) →
//! [`Code::run`].
//!
//! Every operation is an instruction of its own, rounded as in Rust: results have every bit of the same
//! operations on `f64`. For x86-64 with AVX2 or AVX-512; elsewhere [`Code::new`] gives `None`, and so it does
//! on systems that forbid making code.
//!
//! ```
//! use equip_jit::{Code, Program};
//! use equip_scalar::{InstructionSet, Lanes};
//! let mut program = Program::new();
//! let (x, y) = (program.input(0), program.input(1));
//! let product = program.mul(x, y);
//! let three = program.constant(3.0);
//! let sum = program.add(product, three);
//! program.result(0, sum);
//! if let Some(code) = Code::new(&program, InstructionSet::best(), 4) {
//!     let mut scratch = vec![Lanes::splat(0.0); code.scratch()];
//!     let mut results = [0.0; 4];
//!     code.run(&[1.0, 2.0, 3.0, 4.0, /* y */ 0.5, 0.5, 0.5, 0.5], &mut results, &mut scratch, 4);
//!     assert_eq!(results, [3.5, 4.0, 4.5, 5.0]);
//! }
//! ```
// Not `forbid`: `code` calls what it has made.
#![deny(unsafe_code)]

mod program;
#[cfg(target_arch = "x86_64")]
mod registers;
#[cfg(target_arch = "x86_64")]
mod x86_64;

#[cfg(target_arch = "x86_64")]
mod code;
#[cfg(not(target_arch = "x86_64"))]
#[path = "portable.rs"]
mod code;

pub use code::Code;
pub use program::{Program, Value};
