//! Tests of a step: agreement with a reference solution of its equations, and other properties.

mod agreement;
mod oracle;
mod step;
