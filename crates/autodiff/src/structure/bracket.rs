//! [`Bracket`]: y' = B(y)∇H(y) with a skew-symmetric matrix B in place of J.
//!
//! A step takes y' = Jw. For a canonical system w = ∇H. Otherwise
//!
//! $$ w = J^T B g, \qquad w' = J^T \Big( B\,\nabla^2 H + \frac{\partial (B g)}{\partial y} \Big), $$
//!
//! where g = ∇H is fixed in the last term.
//!
//! B is traced as its bilinear form S(y, g, λ) = Σ_{i<j} B_ij (λ_i g_j − λ_j g_i). The gradient of S by λ is
//! Bg, and its Hessian contains B (rows λ, columns g) and ∂(Bg)/∂y (rows λ, columns y). Thus B is
//! skew-symmetric for any entries, and H is constant along the motion.
//!
//! S has 3n components: y, g and λ, concatenated.

use super::conjugate::turned;
use super::facts::{HessianPattern, Structure};
use super::pattern::Pattern;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// The structure of the equations of motion.
#[derive(Debug, Clone)]
pub(crate) struct Bracket {
    /// The structure of H, with the pattern of w' in place of the pattern of ∇²H.
    pub(crate) structure: Structure,
    jacobian: Arc<OnceLock<Jacobian>>,
}

/// The sources of the entries of w'.
#[derive(Debug)]
pub(crate) struct Jacobian {
    /// The index in the Hessian of S of the entry of ∂(Bg)/∂y, if there is one.
    pub(crate) direct: Vec<Option<usize>>,
    /// The products of B and ∇²H in entry e, as indices into the Hessian of S and into ∇²H:
    /// `products[starts[e]..starts[e + 1]]`.
    pub(crate) products: Vec<[usize; 2]>,
    pub(crate) starts: Vec<usize>,
}

impl Bracket {
    /// For this energy and this form.
    pub(crate) fn new(energy: &Structure, form: &Structure) -> Self {
        let patterns = [&energy.hessian, &form.hessian].map(Clone::clone);
        let n = energy.hessian.dimension();
        let hessian = HessianPattern::new(n, move |rows| {
            let [energy, form] = &patterns;
            block(&pattern(energy, form), rows)
        });
        Bracket {
            structure: Structure {
                separable: false,
                hessian,
                ..energy.clone()
            },
            jacobian: Arc::default(),
        }
    }

    /// The sources of the entries of w', with these patterns of ∇²H and of the Hessian of the form.
    pub(crate) fn jacobian(&self, energy: &Pattern, form: &Pattern) -> &Jacobian {
        self.jacobian.get_or_init(|| {
            let own = &self.structure.hessian;
            let n = own.dimension();
            let mut jacobian = Jacobian {
                direct: Vec::with_capacity(own.len()),
                products: Vec::new(),
                starts: vec![0],
            };
            for row in 0..n {
                let lambda = 2 * n + turned::<f64>(row, n).0;
                for (_, column) in own.row(row) {
                    jacobian.direct.push(form.place(lambda, column));
                    let factors = form.row(lambda).filter(|(_, g)| (n..2 * n).contains(g));
                    jacobian.products.extend(factors.filter_map(|(b, g)| {
                        let h = energy.place(g - n, column)?;
                        Some([b, h])
                    }));
                    jacobian.starts.push(jacobian.products.len());
                }
            }
            jacobian
        })
    }
}

/// The pattern of w'.
fn pattern(energy: &Pattern, form: &Pattern) -> Pattern {
    let n = energy.dimension();
    let (mut row_starts, mut columns) = (vec![0], Vec::new());
    let mut own = Vec::new();
    for row in 0..n {
        for (_, column) in form.row(2 * n + turned::<f64>(row, n).0) {
            if column < n {
                own.push(column);
            } else if column < 2 * n {
                own.extend(energy.row(column - n).map(|(_, column)| column));
            }
        }
        own.sort_unstable();
        own.dedup();
        columns.append(&mut own);
        row_starts.push(columns.len());
    }
    Pattern {
        row_starts,
        columns,
    }
}

/// The diagonal block with these rows and columns.
fn block(of: &Pattern, rows: Range<usize>) -> Pattern {
    let (mut row_starts, mut columns) = (vec![0], Vec::new());
    for row in rows.clone() {
        let inside = of.row(row).filter(|(_, column)| rows.contains(column));
        columns.extend(inside.map(|(_, column)| column - rows.start));
        row_starts.push(columns.len());
    }
    Pattern {
        row_starts,
        columns,
    }
}
