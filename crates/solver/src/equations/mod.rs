//! System (7): the constraint, and a reference solution.

pub(crate) mod constraint;
#[cfg(test)]
pub(crate) mod oracle;
