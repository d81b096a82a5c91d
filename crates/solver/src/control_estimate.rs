//! The error estimate of a step, from the decay of the Legendre coefficients of its stage derivatives.
//!
//! The stages define u'(τ) = Σ_{k<s} γ_k P_k(τ), γ_k = Σ_i b_i P_k(c_i) f(Y_i). What s stages do not resolve begins with γ_s; to the end
//! point it is passed by the part of the flow's derivative that is orthogonal to all polynomials of degree below s, which decays alike. So
//! the end point, of order 2s, has an error of about the *square* of the relative size of γ_s:
//!
//! $$ \mathrm{est} = \max_{g \in \{q, p\}} \theta_g^2, \qquad
//!    \theta = \max\Big( \theta_{s-1}^{s/(s-1)}, \theta_{s-2}^{s/(s-2)} \Big), \qquad \theta_k = \frac{h \lVert \gamma_k \rVert}{\max(h \max_j \lVert \gamma_j \rVert, a)} . $$
//!
//! The powers extrapolate a geometric decay to k = s; two coefficients are used because every other one vanishes where the motion is
//! even or odd about the middle of the step. Norms are maximum norms over the positions and over the momenta. Relative to the motion in
//! the step, not to the state: that knows no origin and sees a close encounter of two bodies among many. Motion below the absolute
//! scale a is not resolved further; a = √tolerance times the largest component of the group unless the user says otherwise.
//!
//! The same coefficients tell where the motion gets faster. By least squares γ_k ≈ w γ_{k−1}; if what limits
//! the convergence is a singularity on the axis of time, w = 1/ρ and it lies at half a step divided by 1/z = 2w/(1 + w²) from the middle of the step,
//! ahead if w > 0, behind if w < 0 (Bernstein ellipses). Of the last two w the smaller one counts, and none if they differ in sign, as those
//! of an oscillation do, which gets no faster anywhere.
//!
//! Cost: s² n multiplications, no evaluation of H.

use crate::stages::Stages;
use crate::state::State;
use equip_scalar::Float;

/// What the coefficients of a step say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Estimate {
    /// Error of the end point relative to the motion in the step.
    pub(crate) error: f64,
    /// 1/z: half a step divided by the signed distance from its middle to what the motion is about to meet, or leaves behind; within ±1.
    pub(crate) nearness: f64,
}

#[derive(Debug)]
pub(crate) struct Decay<T: Float> {
    /// Absolute scales of positions and momenta, where the user gave them.
    scales: [Option<T>; 2],
    /// √tolerance.
    share: T,
    /// h γ_k.
    coefficient: Vec<T>,
    /// h γ_{k−1}.
    before: Vec<T>,
    /// ⟨γ_k, γ_{k−1}⟩ and ⟨γ_{k−1}, γ_{k−1}⟩ of positions and momenta, both with h².
    products: Vec<[[T; 2]; 2]>,
    /// h‖γ_k‖ of positions and momenta.
    norms: Vec<[T; 2]>,
}

impl<T: Float> Decay<T> {
    pub(crate) fn new(s: usize, n: usize, tolerance: T, scales: [Option<T>; 2]) -> Self {
        Decay {
            scales,
            share: tolerance.sqrt(),
            coefficient: vec![T::int(0); n],
            before: vec![T::int(0); n],
            products: vec![[[T::int(0); 2]; 2]; s],
            norms: vec![[T::int(0); 2]; s],
        }
    }

    /// The estimate for the step from `y` whose increments are `l`.
    pub(crate) fn estimate(&mut self, stages: &Stages<T>, l: &[T], y: &State<T>) -> Estimate {
        let (s, n) = (stages.count(), stages.n);
        for k in 0..s {
            std::mem::swap(&mut self.before, &mut self.coefficient);
            self.coefficient.fill(T::int(0));
            for (&p, l) in stages.gauss.legendre(k).iter().zip(l.chunks_exact(n)) {
                let sums = self.coefficient.iter_mut().zip(l);
                sums.for_each(|(sum, &l)| *sum += p * l);
            }
            self.norms[k] = group_norms(&self.coefficient);
            self.products[k] = [
                group_products(&self.coefficient, &self.before),
                group_products(&self.before, &self.before),
            ];
        }
        let sizes = group_norms(&y.hi);
        let units = [0, 1].map(|g| {
            let least = self.scales[g].unwrap_or(self.share * sizes[g]);
            self.norms.iter().fold(least, |a, norm| a.max(norm[g]))
        });
        Estimate {
            error: self.error(units, s),
            nearness: self.nearness(units, s),
        }
    }

    /// 1/z from the last two ratios w of coefficients, the smaller one, and none if they differ in sign.
    fn nearness(&self, units: [T; 2], s: usize) -> f64 {
        let ratio = |k: usize| {
            let [across, along] = self.products[k].map(|x| {
                let parts = x.iter().zip(units).filter(|(_, unit)| *unit > T::int(0));
                parts.fold(0.0, |sum, (&x, unit)| sum + (x / (unit * unit)).to_f64())
            });
            if along > 0.0 { across / along } else { 0.0 }
        };
        let last = ratio(s - 1);
        let before = if s > 2 { ratio(s - 2) } else { last };
        let w = if last * before > 0.0 {
            last.abs().min(before.abs()).copysign(last)
        } else {
            0.0
        };
        2.0 * w / (1.0 + w * w)
    }

    /// max θ_g², infinite if it is not a number.
    fn error(&self, units: [T; 2], s: usize) -> f64 {
        let mut worst = 0.0;
        for (g, unit) in units.into_iter().enumerate() {
            if unit == T::int(0) {
                continue;
            }
            let theta = |k: usize| (self.norms[k][g] / unit).to_f64().powf(s as f64 / k as f64);
            let before = if s > 2 { theta(s - 2) } else { 0.0 };
            let theta = theta(s - 1).max(before);
            if !(theta * theta <= worst) {
                worst = theta * theta;
            }
        }
        if worst.is_nan() { f64::INFINITY } else { worst }
    }
}

/// Maximum norms of the positions and of the momenta.
fn group_norms<T: Float>(y: &[T]) -> [T; 2] {
    let (q, p) = y.split_at(y.len() / 2);
    [q, p].map(|x| x.iter().fold(T::int(0), |a, x| a.max(x.abs())))
}

/// Scalar products of the positions and of the momenta.
fn group_products<T: Float>(x: &[T], y: &[T]) -> [T; 2] {
    let m = x.len() / 2;
    let product = |x: &[T], y: &[T]| x.iter().zip(y).fold(T::int(0), |sum, (&x, &y)| sum + x * y);
    [product(&x[..m], &y[..m]), product(&x[m..], &y[m..])]
}
