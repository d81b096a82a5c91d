//! The linearised stage equations, solved by iteration: the response of a step to small perturbations.
//!
//! With B_i = h b_i J∇²H(Y_i), a perturbation r of the right-hand side and a perturbation x of one end change
//! the stages by
//!
//! $$ X = K\,\delta L + r \quad\text{(start held)}, \qquad X = r - K^T \delta L \quad\text{(end held)},
//! \qquad \delta L_i = B_i X_i , $$
//!
//! and the other end by Σ δL_i. K is that of the initial α_k unless `set_k` replaces it. Each iteration
//! updates the momenta first, then the positions. For H = T(p) + U(q) the momenta are eliminated
//! ([`crate::linear::positions`]). With a preconditioner M both are computed from the same X, and the change
//! of X by an iteration is multiplied by M⁻¹.
//!
//! *Layout.* As for the stages, one right-hand side (side) after the other: component c of side k of stage i
//! is at `(k·n + c)·stride + i`.
//!
//! Cost: an iteration costs nnz·s + 2m s² products for each side, and less than half of this if the positions
//! alone are unknown. Nothing is allocated.

use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::{Held, Preconditioner};
use crate::linear::positions::{Iteration, Positions};
use crate::linear::stage_hessians::StageHessians;
use crate::policy::{MOST_ITERATIONS, STEEPEST, STILL};
use equip_autodiff::Pattern;
use equip_scalar::{Float, mix_stages};
use equip_tableau::Coefficients;

/// ∇²H at all stages, and the linear iteration.
#[derive(Debug)]
pub struct LinearIteration<T: Float> {
    pub(super) hessians: StageHessians<T>,
    /// K and −Kᵀ, column by column: one for each end that may be fixed.
    k: [Vec<T>; 2],
    /// K δL, and δL.
    mixed: Vec<T>,
    dl: Vec<T>,
    /// X before the iteration.
    before: Vec<T>,
    /// Σ_i δL_i, component c of side k at `k·n + c`, and its value before the iteration.
    sums: Vec<T>,
    sums_before: Vec<T>,
    /// For each side, the last relative change of Σ_i δL_i.
    changes: Vec<T>,
    /// The data of iterations for the positions alone, if H is separable.
    positions: Option<Positions<T>>,
}

/// Right-hand sides r, their solutions X, and the stopping criterion.
pub(crate) struct Sides<'a, T> {
    pub(super) r: &'a [T],
    pub(super) x: &'a mut [T],
    /// The weights of the components of Σ_i δL_i, and its relative tolerance.
    pub(super) weights: &'a [T],
    pub(super) tolerance: T,
}

impl<T: Float> LinearIteration<T> {
    pub(crate) fn make(
        method: &Coefficients<T>,
        iterate: &Iterate<T>,
        pattern: Pattern,
        sides: usize,
    ) -> Self {
        let (n, stride) = (iterate.n, iterate.stride);
        let zeros = |len: usize| vec![T::int(0); len];
        let k = iterate.k_start.to_vec();
        let mut back = zeros(k.len());
        for (at, back) in back.iter_mut().enumerate() {
            *back = -k[at % stride * stride + at / stride];
        }
        let k = [k, back];
        let positions = n / 2 * sides;
        let len = n * sides * stride;
        LinearIteration {
            hessians: StageHessians::new(iterate, pattern),
            positions: iterate
                .is_twofold()
                .then(|| Positions::new(method, &k, positions)),
            k,
            mixed: zeros(len),
            dl: zeros(len),
            before: zeros(len),
            sums: zeros(n * sides),
            sums_before: zeros(n * sides),
            changes: zeros(sides),
        }
    }

    pub(crate) fn weigh(&mut self, iterate: &Iterate<T>) -> bool {
        self.hessians.weigh(iterate)
    }

    pub(crate) fn bounds_angle(&mut self, most: f64) -> bool {
        self.hessians.is_within(most)
    }

    /// Replaces K, given row by row. All components of the iterate must be unknowns.
    pub fn set_k(&mut self, k: &[T], (s, stride): (usize, usize)) {
        let [forward, back] = &mut self.k;
        for j in 0..s {
            for i in 0..s {
                forward[j * stride + i] = k[i * s + j];
                back[j * stride + i] = -k[j * s + i];
            }
        }
    }

    /// Whether the positions alone are unknown. The momenta of X are not computed then.
    pub fn knows_momenta(&self) -> bool {
        self.positions.is_some()
    }

    /// Σ_i δL_i, component c of side k at `k·n + c`.
    pub fn sums(&self) -> &[T] {
        &self.sums
    }

    pub(crate) fn iterate(
        &mut self,
        held: Held,
        Sides {
            r,
            x,
            weights,
            tolerance,
        }: Sides<'_, T>,
        iterate: &Iterate<T>,
        mut m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let sides = x.len() / (iterate.n * iterate.stride);
        x.copy_from_slice(r);
        if self.knows_momenta() {
            self.by_positions(held, |positions, of| {
                positions.begin(of, r, iterate);
                positions.constant_part_into(x, iterate);
            });
        }
        for made in 0..MOST_ITERATIONS {
            std::mem::swap(&mut self.sums, &mut self.sums_before);
            if m.is_some() {
                self.before[..x.len()].copy_from_slice(x);
            }
            if self.knows_momenta() {
                let before = std::mem::take(&mut self.before);
                let from = m.is_some().then_some(before.as_slice());
                self.by_positions(held, |positions, of| {
                    positions.iteration(of, (x, from), iterate);
                });
                self.before = before;
                if made + 2 >= STILL {
                    self.by_positions(held, |positions, of| positions.sum(of, sides, iterate));
                }
            } else {
                self.iteration(held, (r, x), iterate, m.is_some());
            }
            if let Some(m) = m.as_deref_mut() {
                let unknown = iterate.unknowns() * iterate.stride;
                let side = iterate.n * iterate.stride;
                let before = self.before.chunks_exact(side);
                for (x, before) in x.chunks_exact_mut(side).zip(before) {
                    let (x, before) = (&mut x[..unknown], &before[..unknown]);
                    x.iter_mut()
                        .zip(before)
                        .for_each(|(x, &before)| *x -= before);
                    m.apply(held, x);
                    x.iter_mut()
                        .zip(before)
                        .for_each(|(x, &before)| *x += before);
                }
            }
            if made + 1 >= STILL - 1 {
                match self.have_converged(sides, weights, tolerance, made + 1 >= STILL) {
                    Some(true) => return true,
                    Some(false) => {}
                    None => return false,
                }
            }
        }
        false
    }

    fn by_positions(&mut self, held: Held, run: impl FnOnce(&mut Positions<T>, Iteration<'_, T>)) {
        if let Some(positions) = &mut self.positions {
            run(
                positions,
                Iteration {
                    pattern: &self.hessians.pattern,
                    entries: &self.hessians.entries,
                    k: &self.k[held as usize],
                    held,
                    mixed: &mut self.mixed,
                    dl: &mut self.dl,
                    sums: &mut self.sums,
                },
            );
        }
    }

    /// δL_p = −h b ∂²H/∂q∂y X, then the momenta; δL_q = h b ∂²H/∂p∂y X, then the positions. If `from_same`,
    /// both are computed from the same X.
    fn iteration(
        &mut self,
        held: Held,
        (r, x): (&[T], &mut [T]),
        iterate: &Iterate<T>,
        from_same: bool,
    ) {
        let (s, stride, m) = (iterate.s, iterate.stride, iterate.n / 2);
        let (side, half) = (iterate.n * stride, m * stride);
        let k = &self.k[held as usize];
        for (rows, at) in [(0, half), (m, 0)] {
            let from = if from_same {
                &self.before[..x.len()]
            } else {
                &*x
            };
            self.hessians.times((rows, m), from, &mut self.dl);
            for at in (at..x.len()).step_by(side) {
                let (dl, mixed) = (&self.dl[at..][..half], &mut self.mixed[..half]);
                mix_stages(iterate.set, k, dl, mixed, s, stride);
                for ((x, &r), &z) in x[at..].iter_mut().zip(&r[at..]).zip(&*mixed) {
                    *x = r + z;
                }
            }
        }
        let rows = self.dl[..x.len()].chunks_exact(stride);
        for (sum, dl) in self.sums.iter_mut().zip(rows) {
            *sum = dl[..s].iter().fold(T::int(0), |sum, &x| sum + x);
        }
    }

    /// Whether the sums of all sides have converged; `None` if they are not finite. If `can_compare`, the
    /// previous changes are known.
    fn have_converged(
        &mut self,
        sides: usize,
        weights: &[T],
        tolerance: T,
        can_compare: bool,
    ) -> Option<bool> {
        let mut all = can_compare;
        let n = weights.len();
        let sums = self
            .sums
            .chunks_exact(n)
            .zip(self.sums_before.chunks_exact(n));
        for ((new, old), last) in sums.zip(&mut self.changes).take(sides) {
            let (mut changes, mut sizes) = ([T::int(0); 4], [T::int(0); 4]);
            for (c, ((&new, &old), &w)) in new.iter().zip(old).zip(weights).enumerate() {
                changes[c % 4] += ((new - old) * w).abs();
                sizes[c % 4] += (new * w).abs();
            }
            let of = |sums: [T; 4]| (sums[0] + sums[1]) + (sums[2] + sums[3]);
            let (change, size) = (of(changes), of(sizes));
            if !size.is_finite() {
                return None;
            }
            let ratio = (change / std::mem::replace(last, change)).max(T::ratio(1, STEEPEST));
            all &= change * ratio.min(T::int(1)) <= tolerance * size || change == T::int(0);
        }
        Some(all)
    }
}
