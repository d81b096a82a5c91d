//! K(α) in its layouts, and the products with it.

pub(crate) mod columns;
pub(crate) mod product;
pub(crate) mod twofold;
