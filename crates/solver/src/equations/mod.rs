//! System (7): its two halves, and their solution without a shortcut.

pub(crate) mod constraint;
#[cfg(test)]
pub(crate) mod oracle;
