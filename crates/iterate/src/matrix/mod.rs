//! K(α) in the shapes in which it is multiplied.

pub(crate) mod columns;
pub(crate) mod product;
pub(crate) mod twofold;
