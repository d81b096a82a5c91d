//! The method with one stage more, by which local errors are told.

use equip_scalar::Float;
use equip_tableau::{Gauss, legendre_integrals_at};

#[derive(Debug, Clone)]
pub(crate) struct OneMore<T> {
    pub(crate) gauss: Gauss<T>,
    /// Σ_k (∫_0^{c_i} P_k) P_k(c_j): from the L_j of s stages to the Z_i of s + 1, row by row.
    pub(crate) prolongation: Vec<T>,
}

impl<T: Float> OneMore<T> {
    /// `None` if no method has one stage more than `gauss`.
    pub(crate) fn new(gauss: &Gauss<T>) -> Option<Self> {
        let s = gauss.stages();
        let finer = Gauss::new(s + 1).ok()?;
        let mut prolongation = vec![T::int(0); finer.stages() * s];
        let mut integrals = vec![T::int(0); s];
        for (row, &c) in prolongation.chunks_exact_mut(s).zip(finer.nodes()) {
            legendre_integrals_at(c, &mut integrals);
            for (k, &integral) in integrals.iter().enumerate() {
                let terms = row.iter_mut().zip(gauss.legendre(k));
                terms.for_each(|(x, &p)| *x += integral * p);
            }
        }
        Some(OneMore {
            gauss: finer,
            prolongation,
        })
    }
}
