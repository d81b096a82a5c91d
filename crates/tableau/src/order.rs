//! The order of a method, computed from its tableau alone.

use crate::conditions::{b_residual, bilinear_residual, c_residual, d_residual, symmetry_residual};
use crate::tableau::Tableau;
use crate::trees::{MAX_TREE_ORDER, Tree, Trees, Walk};
use equip_scalar::Float;

/// The classical order of a method. A condition counts as satisfied if its residual is at most `tolerance`.
///
/// Three theorems bound the order: B(p), C(η), D(ζ) with p ≤ η + ζ + 1 and p ≤ 2η + 2 imply order p (Butcher
/// 1964); a symmetric method has even order; the bilinear conditions and p ≤ 2s are upper bounds. If the
/// lower and upper bounds differ, the order conditions of the trees decide. For the Gauss, EQUIP and HBVM
/// families the result is exact for every s. For other methods the result is the lower bound if all
/// conditions up to [`MAX_TREE_ORDER`] hold and the bounds still differ.
///
/// A sensible tolerance is 1000 ε. The residuals of satisfied conditions are rounding errors. Those of
/// violated conditions are about α_k for a perturbed Gauss method, but can be as small as 1/γ(t) for other
/// methods.
///
/// ```
/// use equip_tableau::{Tableau, order};
/// assert_eq!(order(&Tableau::<f64>::radau_iia(), 1e-12), 3);
/// ```
pub fn order<T: Float>(tableau: &Tableau<T>, tolerance: T) -> usize {
    let holds = |residual: T| residual <= tolerance;
    let (mut lower, mut upper) = (0, 2 * tableau.stages());
    // Without C(1) the c_i are not the row sums of A, and the simplifying assumptions do not apply.
    if holds(c_residual(tableau, 1)) {
        let last = |condition: fn(&Tableau<T>, usize) -> T| {
            (1..=upper)
                .take_while(|&n| holds(condition(tableau, n)))
                .count()
        };
        let (p, eta, zeta) = (last(b_residual), last(c_residual), last(d_residual));
        lower = p.min(eta + zeta + 1).min(2 * eta + 2);
        upper = p.min(last(bilinear_residual)).max(lower);
    }
    let symmetric = holds(symmetry_residual(tableau));
    if symmetric {
        lower += lower % 2;
        upper -= upper % 2;
    }
    if lower >= upper {
        return lower;
    }
    lower.max(order_by_trees(
        tableau,
        tolerance,
        upper.min(MAX_TREE_ORDER),
    ))
}

/// The largest p ≤ `limit` such that all conditions up to p hold.
fn order_by_trees<T: Float>(tableau: &Tableau<T>, tolerance: T, limit: usize) -> usize {
    let trees = Trees::up_to(limit);
    let mut walk = Walk::new(tableau);
    // The first violated tree has one vertex more than the order.
    let violated = |tree: &&Tree| {
        let residual = walk.residual(tree).abs();
        residual.is_nan() || residual > tolerance
    };
    trees
        .all()
        .iter()
        .find(violated)
        .map_or(limit, |tree| tree.order() - 1)
}
