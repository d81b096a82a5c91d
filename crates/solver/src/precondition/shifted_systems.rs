//! The systems (I − λ_j G) v = r for the ⌈s/2⌉ eigenvalues λ_j of the tableau, where G = h J H̄ with one
//! Hessian H̄.
//!
//! If H is separable, G = (0 G_qp; G_pq 0) and the momenta are eliminated: with v = (q, p), r = (a, b)
//!
//! $$ (I - \lambda^2 G_{qp} G_{pq})\, q = a + \lambda G_{qp} b, \qquad p = b + \lambda G_{pq} q, $$
//!
//! where −λ² G_qp G_pq = h²λ² T''U''. The size d of a system is n, or m = n/2 for separable H.
//!
//! A system is sparse if it has at most d²/8 terms, dense otherwise. Cost for each eigenvalue: if dense, 8/3
//! d³ real operations to factorise and 8 d² to solve; if sparse, proportional to d for chains. All arithmetic
//! is in `f64`, as for every preconditioner.

use crate::policy::SPARSE_SHARE;
use crate::precondition::schur::Block;
use equip_autodiff::{Pattern, turned};
use equip_linear::{DenseLu, Singular};
use equip_linear::{SparseLu, Symbolic};
use nalgebra::{Complex, DVector};
use std::ops::{AddAssign, Mul};

/// One half of the rows of G.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Half {
    /// The rows of q.
    Q,
    /// The rows of p.
    P,
}

#[derive(Debug)]
pub(crate) struct ShiftedSystems {
    /// The pattern of the Hessian.
    pattern: Pattern,
    /// The entries of G = h J H̄ in the order of the pattern of H̄. Row i of H̄ is row `turned(i)` of G.
    g: Vec<f64>,
    /// Whether the momenta are eliminated.
    reduced: bool,
    factors: Factors,
    /// Workspace of length d for the dense solve.
    column: DVector<Complex<f64>>,
    work: Vec<Complex<f64>>,
}

#[derive(Debug)]
enum Factors {
    Dense(Vec<DenseLu<Complex<f64>>>),
    Sparse {
        symbolic: Symbolic,
        lus: Vec<SparseLu>,
        entries: Vec<Complex<f64>>,
        terms: Vec<Term>,
    },
}

/// A contribution to an entry of a sparse system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Term {
    column: usize,
    row: usize,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// 1.
    One,
    /// −λ g.
    Entry(usize),
    /// −λ² g g'.
    Product(usize, usize),
}

impl ShiftedSystems {
    pub(crate) fn new(pattern: Pattern, separable: bool, systems: usize) -> Self {
        let n = pattern.dimension();
        let d = if separable { n / 2 } else { n };
        let factors = sparse(&pattern, separable, systems)
            .unwrap_or_else(|| Factors::Dense((0..systems).map(|_| DenseLu::new(d)).collect()));
        let dense = matches!(factors, Factors::Dense(_));
        let zero = Complex::new(0.0, 0.0);
        ShiftedSystems {
            g: vec![0.0; pattern.len()],
            pattern,
            reduced: separable,
            factors,
            column: DVector::from_element(if dense { d } else { 0 }, zero),
            work: vec![zero; n],
        }
    }

    /// The entries of G, to be set before [`factor`](Self::factor).
    pub(crate) fn generator_mut(&mut self) -> (&Pattern, &mut [f64]) {
        (&self.pattern, &mut self.g)
    }

    pub(crate) fn generator(&self) -> &[f64] {
        &self.g
    }

    pub(crate) fn factor(&mut self, blocks: &[Block]) -> Result<(), Singular> {
        let (pattern, g) = (&self.pattern, &self.g);
        match &mut self.factors {
            Factors::Dense(lus) => {
                for (lu, block) in lus.iter_mut().zip(blocks) {
                    let matrix = lu.matrix_mut();
                    matrix.fill_with_identity();
                    terms(pattern, self.reduced, |term| {
                        matrix[(term.row, term.column)] += term.kind.value(block.lambda, g);
                    });
                    lu.factor()?;
                }
            }
            Factors::Sparse {
                symbolic,
                lus,
                entries,
                terms,
            } => {
                for (lu, block) in lus.iter_mut().zip(blocks) {
                    let mut at = None;
                    let mut filled = 0;
                    for term in terms.iter() {
                        let value = term.kind.value(block.lambda, g);
                        if at == Some((term.column, term.row)) {
                            entries[filled - 1] += value;
                        } else {
                            entries[filled] = value;
                            filled += 1;
                            at = Some((term.column, term.row));
                        }
                    }
                    symbolic.factor(lu, entries)?;
                }
            }
        }
        Ok(())
    }

    /// v ← (I − λ_j G)⁻¹ v.
    pub(crate) fn solve(&mut self, j: usize, block: &Block, v: &mut [Complex<f64>]) {
        let m = v.len() / 2;
        if !self.reduced {
            self.solve_factored(j, v);
            return;
        }
        let mut work = std::mem::take(&mut self.work);
        self.product(Half::Q, v, &mut work);
        for i in 0..m {
            v[i] += block.lambda * work[i];
        }
        self.solve_factored(j, &mut v[..m]);
        self.product(Half::P, v, &mut work);
        for i in m..2 * m {
            v[i] += block.lambda * work[i];
        }
        self.work = work;
    }

    fn solve_factored(&mut self, j: usize, v: &mut [Complex<f64>]) {
        match &mut self.factors {
            Factors::Dense(lus) => {
                self.column.as_mut_slice().copy_from_slice(v);
                lus[j].solve(&mut self.column);
                v.copy_from_slice(self.column.as_slice());
            }
            Factors::Sparse { symbolic, lus, .. } => symbolic.solve(&lus[j], v),
        }
    }

    /// out = G x.
    pub(crate) fn apply(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for half in [Half::Q, Half::P] {
            self.add_product(half, x, out);
        }
    }

    /// out = G x, for one half of the rows of G.
    fn product(&self, half: Half, x: &[Complex<f64>], out: &mut [Complex<f64>]) {
        out.fill(Complex::new(0.0, 0.0));
        self.add_product(half, x, out);
    }

    fn add_product<N>(&self, half: Half, x: &[N], out: &mut [N])
    where
        N: Copy + Mul<f64, Output = N> + AddAssign,
    {
        let n = x.len();
        let rows = match half {
            Half::Q => n / 2..n,
            Half::P => 0..n / 2,
        };
        for row in rows {
            let (r, _) = turned::<f64>(row, n);
            for (position, column) in self.pattern.row(row) {
                let g = self.g[position];
                out[r] += x[column] * g;
            }
        }
    }
}

impl Kind {
    fn value(self, lambda: Complex<f64>, g: &[f64]) -> Complex<f64> {
        match self {
            Kind::One => Complex::new(1.0, 0.0),
            Kind::Entry(e) => -lambda * g[e],
            Kind::Product(e, f) => -(lambda * g[e]) * (lambda * g[f]),
        }
    }
}

/// All contributions to I − λG or I − λ² G_qp G_pq except the 1 of the diagonal.
fn terms(pattern: &Pattern, reduced: bool, mut each: impl FnMut(Term)) {
    let n = pattern.dimension();
    let m = n / 2;
    if !reduced {
        for i in 0..n {
            let (row, _) = turned::<f64>(i, n);
            for (e, column) in pattern.row(i) {
                let kind = Kind::Entry(e);
                each(Term { column, row, kind });
            }
        }
        return;
    }
    for row in 0..m {
        // Row `row` of G_qp is row m + row of H̄; row k of G_pq is row k of H̄.
        for (e, k) in pattern.row(m + row) {
            for (f, column) in pattern.row(k - m) {
                let kind = Kind::Product(e, f);
                each(Term { column, row, kind });
            }
        }
    }
}

/// The sparse form, if there are few terms and enough memory.
fn sparse(pattern: &Pattern, reduced: bool, systems: usize) -> Option<Factors> {
    let n = pattern.dimension();
    let d = if reduced { n / 2 } else { n };
    let number = d + if reduced {
        let inner = |(_, k): (usize, usize)| pattern.row(k - n / 2).count();
        let row = |i| pattern.row(n / 2 + i).map(inner).sum::<usize>();
        (0..d).map(row).sum::<usize>()
    } else {
        pattern.len()
    };
    if number > d * d / SPARSE_SHARE {
        return None;
    }
    let mut all = Vec::with_capacity(number);
    all.extend((0..d).map(|i| Term {
        column: i,
        row: i,
        kind: Kind::One,
    }));
    terms(pattern, reduced, |term| all.push(term));
    all.sort_unstable();
    let (mut starts, mut rows) = (vec![0; d + 1], Vec::new());
    for same in all.chunk_by(|x, y| (x.column, x.row) == (y.column, y.row)) {
        rows.push(same[0].row);
        starts[same[0].column + 1] = rows.len();
    }
    let symbolic = Symbolic::new(starts, rows)?;
    Some(Factors::Sparse {
        entries: vec![Complex::new(0.0, 0.0); symbolic.non_zeros()],
        lus: (0..systems)
            .map(|_| SparseLu::new(symbolic.dimension()))
            .collect(),
        symbolic,
        terms: all,
    })
}
