//! Rooted trees and their order conditions (Butcher 1963; Hairer, Nørsett, Wanner, "Solving ODEs I", II.2).
//!
//! A method has order p if Σ_i b_i φ_i(t) = 1/γ(t) for every rooted tree t of at most p vertices. For t =
//! [t_1, …, t_m]
//!
//! $$\varphi_i(t) = \prod_{n=1}^m \sum_j a_{ij}\,\varphi_j(t_n), \qquad \gamma(t) = |t|\,\gamma(t_1)\cdots\gamma(t_m).$$
//!
//! These are the conditions for autonomous equations: they contain the row sums of A instead of c.

use crate::conditions::largest;
use crate::tableau::{Tableau, dot};
use equip_scalar::Float;

/// The largest number of vertices for which `order()` visits all trees. There are 7813 trees of at most 12
/// vertices.
pub const MAX_TREE_ORDER: usize = 12;

/// A rooted tree. Its branches are earlier trees of the same [`Trees`].
///
/// ```
/// let trees = equip_tableau::trees::Trees::up_to(3);
/// let tall = &trees.all()[3]; // [[τ]], its only branch being number 1, [τ]
/// assert_eq!((tall.order(), tall.density(), tall.branches()), (3, 6, &[1][..]));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tree {
    order: usize,
    density: i64,
    branches: Vec<usize>,
}

impl Tree {
    /// The number of vertices |t|.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The density γ(t): 1 for the single vertex, |t|! for the tall tree.
    pub fn density(&self) -> i64 {
        self.density
    }

    /// The subtrees left when the root is removed: non-increasing indices into [`Trees::all`].
    pub fn branches(&self) -> &[usize] {
        &self.branches
    }
}

/// All rooted trees up to a given order, by increasing order.
///
/// ```
/// use equip_tableau::trees::Trees;
/// let trees = Trees::up_to(4);
/// let densities: Vec<i64> = trees.all().iter().map(|tree| tree.density()).collect();
/// assert_eq!(densities, [1, 2, 3, 6, 4, 8, 12, 24]);
/// ```
#[derive(Debug, Clone)]
pub struct Trees {
    trees: Vec<Tree>,
}

impl Trees {
    /// All trees with at most `order` vertices. The number with n vertices grows like 2.96ⁿ: there are 85
    /// with at most 7, and 1842 with exactly 11.
    ///
    /// ```
    /// assert_eq!(equip_tableau::trees::Trees::up_to(7).all().len(), 85);
    /// ```
    pub fn up_to(order: usize) -> Self {
        let mut trees = Trees { trees: Vec::new() };
        for n in 1..=order {
            let known = trees.trees.len();
            trees.grow(n, n - 1, known, &mut Vec::new());
        }
        trees
    }

    /// The trees, by increasing order.
    pub fn all(&self) -> &[Tree] {
        &self.trees
    }

    /// Adds every tree of `order` vertices that has these branches and further branches with `remaining`
    /// vertices in total and indices < `below`.
    fn grow(&mut self, order: usize, remaining: usize, below: usize, branches: &mut Vec<usize>) {
        if remaining == 0 {
            let product: i64 = branches
                .iter()
                .map(|&index| self.trees[index].density)
                .product();
            let density = order as i64 * product;
            self.trees.push(Tree {
                order,
                density,
                branches: branches.clone(),
            });
            return;
        }
        for index in 0..below {
            let size = self.trees[index].order;
            if size > remaining {
                break;
            }
            branches.push(index);
            self.grow(order, remaining - size, index + 1, branches);
            branches.pop();
        }
    }
}

/// Evaluates the order conditions of a tableau tree by tree, in the order of [`Trees::all`].
#[derive(Debug)]
pub(crate) struct Walk<'t, T> {
    tableau: &'t Tableau<T>,
    /// A φ(t) of the trees evaluated so far.
    images: Vec<Vec<T>>,
}

impl<'t, T: Float> Walk<'t, T> {
    pub(crate) fn new(tableau: &'t Tableau<T>) -> Self {
        Walk {
            tableau,
            images: Vec::new(),
        }
    }

    /// The residual Σ b_i φ_i(t) − 1/γ(t) of the next tree.
    pub(crate) fn residual(&mut self, tree: &Tree) -> T {
        let mut phi = vec![T::int(1); self.tableau.stages()];
        for &branch in &tree.branches {
            for (phi_i, &image_i) in phi.iter_mut().zip(&self.images[branch]) {
                *phi_i *= image_i;
            }
        }
        self.images.push(self.tableau.apply(&phi));
        dot(&self.tableau.b, &phi) - T::ratio(1, tree.density)
    }
}

/// The largest |Σ b_i φ_i(t) − 1/γ(t)| over all trees with at most `p` vertices.
///
/// Cost: s² operations per tree; see [`Trees::up_to`] for the number of trees. Intended for p ≤
/// [`MAX_TREE_ORDER`].
///
/// ```
/// use equip_tableau::{Tableau, trees::order_conditions};
/// assert!(order_conditions(&Tableau::<f64>::classic(), 4) < 1e-15);
/// assert!(order_conditions(&Tableau::<f64>::classic(), 5) > 1e-3);
/// ```
pub fn order_conditions<T: Float>(tableau: &Tableau<T>, p: usize) -> T {
    let trees = Trees::up_to(p);
    let mut walk = Walk::new(tableau);
    largest(trees.all().iter().map(|tree| walk.residual(tree)))
}
