//! The preconditioners M ≠ 1 of the iteration Z ← Z + M⁻¹ (K(α) L(Z) − Z).

pub(crate) mod choice;
pub(crate) mod diagonal;
pub(crate) mod frozen;
pub(crate) mod full;
pub(crate) mod rows;
pub(crate) mod schur;
pub(crate) mod shifted_systems;

#[cfg(test)]
mod tests;
