//! K(α) in its layouts, and the products with it.

pub(crate) mod inverse;
pub(crate) mod product;
pub(crate) mod twofold;
