//! The coefficient matrix A of the Gauss method, factorised so that I − h A⊗G decouples into ⌈s/2⌉ systems of
//! size n.
//!
//! With A = 𝒫 X 𝒫⁻¹, eqs. (3)–(4) of the paper, and the real Schur form X = W S Wᵀ:
//!
//! $$ A = (\mathcal{P} W)\, S\, (W^T \mathcal{P}^T B), $$
//!
//! S is upper triangular except for a 2×2 diagonal block for each pair of eigenvalues λ, λ̄. A block is
//! solved by one complex system: with the left eigenvector (1, η) of the block and the right-hand sides r_1,
//! r_2
//!
//! $$ (I - h\lambda G)\, v = r_1 + \eta r_2, \qquad w_2 = \mathrm{Im}\, v / \mathrm{Im}\, \eta, \quad
//!    w_1 = \mathrm{Re}\, v - \mathrm{Re}\,\eta\; w_2 ; $$
//!
//! Back substitution couples the blocks. The eigenvectors of A would decouple them completely, but their
//! condition number grows like 10^(s/2) (1e2 at s = 6, 3e10 at s = 20). W is orthogonal.
//!
//! For a method without α_k, W S Wᵀ is the real Schur form of A itself, with k − s additional eigenvalues 0.
//!
//! All arithmetic is in `f64`, once per run. Cost: O(s³).

use equip_scalar::Float;
use equip_tableau::Coefficients;
use nalgebra::linalg::Schur as SchurForm;
use nalgebra::{Complex, DMatrix};

/// The maximum number of iterations of the QR algorithm, which takes about two for each eigenvalue.
const MAX_SWEEPS: usize = 10_000;

/// A diagonal block of S.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    /// Its first row.
    pub(crate) start: usize,
    /// Its size, 1 or 2.
    pub(crate) size: usize,
    /// The eigenvalue with Im λ ≥ 0.
    pub(crate) lambda: Complex<f64>,
    /// η of the left eigenvector (1, η).
    pub(crate) eta: Complex<f64>,
}

/// A = `right` S `left`, all s × s.
#[derive(Debug)]
pub(crate) struct Schur {
    /// Wᵀ 𝒫ᵀ B.
    pub(crate) left: DMatrix<f64>,
    pub(crate) schur: DMatrix<f64>,
    /// 𝒫 W.
    pub(crate) right: DMatrix<f64>,
    pub(crate) blocks: Vec<Block>,
}

impl Schur {
    /// For the method with α = 0. `None` if the QR algorithm fails, which it does for no Gauss method.
    pub(crate) fn new<T: Float>(method: &Coefficients<T>) -> Option<Self> {
        let s = method.stages();
        let b = DMatrix::from_fn(s, s, |i, j| match i == j {
            true => method.weights()[i].to_f64(),
            false => 0.0,
        });
        if !method.is_skew() {
            let k = method.matrix(&[]);
            let k = DMatrix::from_row_iterator(s, s, k.iter().map(|k| k.to_f64()));
            let (w, schur) = SchurForm::try_new(k * b, f64::EPSILON, MAX_SWEEPS)?.unpack();
            return Some(Schur {
                left: w.transpose(),
                right: w,
                blocks: blocks(&schur),
                schur,
            });
        }
        let mut x = DMatrix::zeros(s, s);
        x[(0, 0)] = 0.5;
        for k in 1..s {
            x[(k, k - 1)] = method.xi(k).to_f64();
            x[(k - 1, k)] = -method.xi(k).to_f64();
        }
        let (w, schur) = SchurForm::try_new(x, f64::EPSILON, MAX_SWEEPS)?.unpack();
        let p = DMatrix::from_fn(s, s, |i, k| method.legendre(k)[i].to_f64());
        Some(Schur {
            left: w.transpose() * p.transpose() * b,
            right: p * w,
            blocks: blocks(&schur),
            schur,
        })
    }
}

fn blocks(schur: &DMatrix<f64>) -> Vec<Block> {
    let s = schur.nrows();
    let mut blocks = Vec::with_capacity(s.div_ceil(2));
    let mut start = 0;
    while start < s {
        let a = schur[(start, start)];
        if start + 1 == s || schur[(start + 1, start)] == 0.0 {
            blocks.push(Block {
                start,
                size: 1,
                lambda: a.into(),
                eta: 0.0.into(),
            });
            start += 1;
            continue;
        }
        let (b, c) = (schur[(start, start + 1)], schur[(start + 1, start)]);
        let d = schur[(start + 1, start + 1)];
        let (mean, half) = ((a + d) / 2.0, (a - d) / 2.0);
        let lambda = mean + Complex::from(half * half + b * c).sqrt();
        blocks.push(Block {
            start,
            size: 2,
            lambda,
            eta: (lambda - a) / c,
        });
        start += 2;
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measured: 2e-15 at s = 32; the bound is 10 times that. 32 stages are the largest number supported.
    #[test]
    fn the_parts_make_up_the_tableau() {
        for s in 1..=equip_iterate::MAX_STAGES {
            let gauss = Coefficients::<f64>::gauss(s).unwrap();
            let split = Schur::new(&gauss).unwrap();
            let mut u = vec![0.0; s * s];
            gauss.antisymmetric_into(&vec![0.0; s - 1], &mut u);
            let a = DMatrix::from_fn(s, s, |i, j| (0.5 + u[i * s + j]) * gauss.weights()[j]);
            let error = (&split.right * &split.schur * &split.left - &a).amax();
            let inverse = (&split.right * &split.left - DMatrix::identity(s, s)).amax();
            println!("s = {s}: {error:.1e}, {inverse:.1e}");
            assert!(error < 2e-14, "s = {s}: {error:e}");
            assert!(inverse < 2e-13, "s = {s}: {inverse:e}");
            let sizes: usize = split.blocks.iter().map(|b| b.size).sum();
            assert_eq!(sizes, s);
            assert_eq!(split.blocks.len(), s.div_ceil(2), "s = {s}");
            for block in &split.blocks {
                assert!(block.size == 1 || block.lambda.im > 0.0);
                // (1, η) (S − λ) = 0.
                if block.size == 2 {
                    let k = block.start;
                    let d = split.schur[(k + 1, k + 1)] - block.lambda;
                    let left = split.schur[(k, k + 1)] + block.eta * d;
                    assert!(left.norm() < 1e-14);
                }
            }
        }
    }
}
