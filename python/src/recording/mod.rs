//! A function of Python, called once and recorded.

pub(crate) mod condition;
pub(crate) mod constant;
pub(crate) mod external;
pub(crate) mod recorded;
pub(crate) mod table;
pub(crate) mod variable;
