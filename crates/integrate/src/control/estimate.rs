//! The error estimate of a step, from the decay of the Legendre coefficients of its stage derivatives.
//!
//! The stages define u'(τ) = Σ_{k<s} γ_k P_k(τ), γ_k = Σ_i b_i P_k(c_i) f(Y_i). What s stages do not resolve
//! begins with γ_s; to the end point it is passed by the part of the flow's derivative that is orthogonal to
//! all polynomials of degree below s, which decays alike. So the end point, of order 2s, has an error of
//! about the *square* of the relative size of γ_s:
//!
//! $$ \mathrm{est} = \varrho^{2s}, \qquad
//!    \varrho = \max_{g \in \{q, p\}} \max\Big( \theta_{s-1}^{1/(s-1)}, \theta_{s-2}^{1/(s-2)} \Big), \qquad \theta_k = \frac{h \lVert \gamma_k \rVert_g}{\max(h \max_j \lVert \gamma_j \rVert_g, a)} . $$
//!
//! ϱ is the ratio of a geometric decay; two coefficients are used because every other one vanishes where the
//! motion is even or odd about the middle of the step. Norms are maximum norms over the positions and over
//! the momenta. Relative to the motion in the step, not to the state: that knows no origin and sees a close
//! encounter of two bodies among many. Motion below the absolute scale a is not resolved further; a =
//! √tolerance times the largest component of the group unless the user says otherwise.
//!
//! The same coefficients tell where the motion gets faster. By least squares γ_k ≈ w γ_{k−1}; if what limits
//! the convergence is a singularity on the axis of time, w = 1/ρ and it lies at half a step divided by 1/z =
//! 2w/(1 + w²) from the middle of the step, ahead if w > 0, behind if w < 0 (Bernstein ellipses). Of the last
//! two w the smaller one counts, and none if they differ in sign, as those of an oscillation do, which gets
//! no faster anywhere.
//!
//! Cost: s² n multiplications, no evaluation of H.

use equip_scalar::{Float, InstructionSet, mix_stages};
use equip_solver::{State, decay, stride_for};
use equip_tableau::Gauss;

/// What the coefficients of a step say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Estimate {
    /// ϱ: to the power 2s it is the error of the end point relative to the motion in the step.
    pub(crate) decay: f64,
    /// 1/z: half a step divided by the signed distance from its middle to what the motion is about to meet,
    /// or leaves behind; within ±1.
    pub(crate) nearness: f64,
}

#[derive(Debug)]
pub(crate) struct Decay<T: Float> {
    set: InstructionSet,
    s: usize,
    stride: usize,
    /// Scales of positions and momenta, where the user gave them.
    scales: [Option<T>; 2],
    /// √tolerance.
    share: T,
    /// P_k(c_i) at i·stride + k.
    legendre: Vec<T>,
    /// h γ_k of component c at c·stride + k.
    coefficients: Vec<T>,
    /// h‖γ_k‖ of positions and momenta, each of length `stride`.
    norms: [Vec<T>; 2],
}

impl<T: Float> Decay<T> {
    pub(crate) fn new(gauss: &Gauss<T>, n: usize, tolerance: T, scales: [Option<T>; 2]) -> Self {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let zeros = |len: usize| vec![T::int(0); len];
        let mut legendre = zeros(s * stride);
        for k in 0..s {
            for (i, &p) in gauss.legendre(k).iter().enumerate() {
                legendre[i * stride + k] = p;
            }
        }
        Decay {
            set: InstructionSet::best(),
            s,
            stride,
            scales,
            share: tolerance.sqrt(),
            legendre,
            coefficients: zeros(n * stride),
            norms: [zeros(stride), zeros(stride)],
        }
    }

    /// The estimate for the step from `y` with these L, component c of stage i at c·stride + i.
    pub(crate) fn estimate(&mut self, l: &[T], y: &State<T>) -> Estimate {
        let (set, s, stride) = (self.set, self.s, self.stride);
        mix_stages(set, &self.legendre, l, &mut self.coefficients, s, stride);
        let half = self.coefficients.len() / 2;
        for (norms, rows) in self
            .norms
            .iter_mut()
            .zip(self.coefficients.chunks_exact(half))
        {
            norms.fill(T::int(0));
            for row in rows.chunks_exact(stride) {
                for (norm, &x) in norms.iter_mut().zip(row) {
                    let x = x.abs();
                    *norm = if x > *norm { x } else { *norm };
                }
            }
        }
        let sizes = group_norms(&y.hi);
        let units = [0, 1].map(|g| {
            let least = self.scales[g].unwrap_or(self.share * sizes[g]);
            self.norms[g]
                .iter()
                .take(s)
                .fold(least, |a, &norm| a.max(norm))
        });
        Estimate {
            decay: decay(&self.norms, units, s),
            nearness: self.nearness(units),
        }
    }

    /// 1/z from the last two ratios w of coefficients, the smaller one, and none if they differ in sign.
    fn nearness(&self, units: [T; 2]) -> f64 {
        let half = self.coefficients.len() / 2;
        let ratio = |k: usize| {
            let (mut across, mut along) = (0.0, 0.0);
            for (rows, unit) in self.coefficients.chunks_exact(half).zip(units) {
                if unit > T::int(0) {
                    let unit = T::int(1) / unit;
                    for row in rows.chunks_exact(self.stride) {
                        let (x, before) = ((row[k] * unit).to_f64(), (row[k - 1] * unit).to_f64());
                        across += x * before;
                        along += before * before;
                    }
                }
            }
            if along > 0.0 { across / along } else { 0.0 }
        };
        let last = ratio(self.s - 1);
        let before = if self.s > 2 { ratio(self.s - 2) } else { last };
        let w = if last * before > 0.0 {
            last.abs().min(before.abs()).copysign(last)
        } else {
            0.0
        };
        2.0 * w / (1.0 + w * w)
    }
}

/// Maximum norms of the positions and of the momenta.
fn group_norms<T: Float>(y: &[T]) -> [T; 2] {
    let (q, p) = y.split_at(y.len() / 2);
    [q, p].map(|x| x.iter().fold(T::int(0), |a, x| a.max(x.abs())))
}
