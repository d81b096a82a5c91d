//! equip in a browser: H is a text, and EQUIP and Gauss integrate it side by side.
//!
//! [`Expression`] reads the text, [`Simulation`] makes the steps. `page` has the page, which calls both as
//! WebAssembly; `web/build` builds it.
#![cfg_attr(not(target_arch = "wasm32"), forbid(unsafe_code))]

#[cfg(target_arch = "wasm32")]
pub mod browser;
mod error;
mod expression;
mod functions;
mod names;
mod reader;
mod simulation;
mod tokens;
mod track;
mod value;

pub use error::{FormulaError, SimulationError};
pub use expression::Expression;
pub use simulation::{Progress, Simulation};
pub use track::Track;
