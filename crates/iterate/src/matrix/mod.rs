//! K(α) in the shapes in which it is multiplied.

pub(crate) mod coefficients;
pub(crate) mod product;
pub(crate) mod twofold;
