//! Straight-line arithmetic on lanes of doubles, as machine code generated at run time.
//!
//! The trace of an energy is known only at run time. A replay looks up every operation, reads its operands
//! from memory and writes its result to memory. Machine code keeps the numbers in registers.
//!
//! [`Program`] → registers (farthest next use) → bytes (by iced-x86) → executable memory (by memmap2) →
//! [`Code::run`].
//!
//! Every operation is one instruction, rounded as in Rust, so the results have the bits of the same
//! operations on `f64`. Supported processors: x86-64 with AVX2 or AVX-512. On others, and on systems that
//! forbid generated code, [`Code::new`] returns `None`.
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
