//! The linearised stage equations for the α's: columns M⁻¹ T_k L, and how the ends of the step answer to them.
//!
//! Their direction must not depend on the age of H̄, nor differ for the step made backwards, so the columns are
//! solved for with M itself: Hessians of all stages once per step in which α's move, and M x = b iterated,
//! x ← x + M̃⁻¹(b − M x), until its corrections are at √ε, the accuracy to which the stages are known then.

use crate::displacement::TRUSTED;
use crate::hessians::{StageHessians, turned};
use crate::linearised::Linearised;
use crate::outcome::Counts;
use crate::stages::Stages;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use nalgebra::DVector;

/// Iterations of M x = b.
const MAX_REFINEMENTS: u32 = 60;

impl<T: Float> Linearised<T> {
    /// To be called before columns of α's are solved for at the current stages; `stale` asks for a full factorisation
    /// that is of these very stages. Returns whether it was found.
    pub(crate) fn prepare_columns<E: Evaluate<T>>(
        &mut self,
        stages: &Stages<T>,
        energy: &mut E,
        (h, stale): (T, bool),
        counts: &mut Counts,
    ) -> bool {
        if self.is_simplified() {
            self.hessians.take(stages, energy, h, counts);
        } else if stale && let Some(full) = &mut self.full {
            self.hessians.take(stages, energy, h, counts);
            counts.factorisations += 1;
            return full.refresh(stages, &self.hessians).is_ok();
        }
        true
    }

    /// Whether a column once solved for serves for the rest of the step: it does not change as long as M is that of the
    /// same Hessians.
    pub(crate) fn keeps_columns(&self) -> bool {
        self.is_simplified()
    }

    /// x ← M⁻¹ x. Returns whether it was found.
    pub(crate) fn solve_column(&mut self, stages: &Stages<T>, x: &mut DVector<T>) -> bool {
        self.solve_to(self.columns_to, stages, x)
    }

    /// The same, with simplified Newton to a relative `tolerance` of the largest component.
    pub(crate) fn solve_to(
        &mut self,
        tolerance: T,
        stages: &Stages<T>,
        x: &mut DVector<T>,
    ) -> bool {
        if self.is_simplified() {
            return self.refine(stages, x, tolerance, false);
        }
        self.solve(x);
        true
    }

    /// u = Σ_i B_i x_i for a column x of an α, in units of the state.
    pub(crate) fn column_end(&self, stages: &Stages<T>, x: &DVector<T>, u: &mut [T]) {
        self.hessians.end_displacement(stages, x, u);
    }

    /// u' = −Ψ⁻¹ u for the step map Ψ linearised at fixed α: how the *start* point moves when the end point is held.
    /// Returns whether it was found.
    ///
    /// Ψ = I + Σ B_i (M⁻¹ 1⊗I)_i is symplectic, so Ψ⁻¹ = −J Ψᵀ J: one solve with Mᵀ.
    pub(crate) fn column_start(&mut self, stages: &Stages<T>, u: &[T], back: &mut [T]) -> bool {
        let n = stages.n;
        let mut x = std::mem::replace(&mut self.work, DVector::zeros(0));
        self.hessians.pull_back(stages, u, &mut x);
        let found = if self.is_simplified() {
            self.refine(stages, &mut x, self.columns_to, true)
        } else {
            if let Some(full) = &mut self.full {
                full.solve_transposed(&mut x);
            }
            true
        };
        for row in 0..n {
            let sum = (0..stages.count()).fold(T::int(0), |sum, i| sum + x[i * n + row]);
            // J Ψᵀ J u = J (J u + Σ_i w_i) = −u + J Σ_i w_i.
            let (r, sign) = turned::<T>(row, n);
            back[r] = sign * sum / stages.scale[row] - u[r];
        }
        self.work = x;
        found
    }

    /// Whether there is motion that the step did not resolve, at the Hessians of all stages taken last.
    pub(crate) fn is_unresolved(&self) -> bool {
        self.hessians.any_rho_exceeds(T::int(TRUSTED))
    }

    /// How far each component is from being resolved by the step.
    pub(crate) fn resolution(&self, weights: &mut [T]) {
        self.hessians.resolution(weights);
    }

    /// x ← M⁻¹ x or M⁻ᵀ x by iteration with M̃. Returns whether it converged.
    fn refine(
        &mut self,
        stages: &Stages<T>,
        x: &mut DVector<T>,
        tolerance: T,
        transposed: bool,
    ) -> bool {
        let Some(simplified) = &mut self.simplified else {
            return false;
        };
        self.rest.copy_from(x);
        x.fill(T::int(0));
        let mut last = T::INFINITY;
        for _ in 0..MAX_REFINEMENTS {
            // The correction replaces the residual, M times the correction comes off it.
            self.step.copy_from(&self.rest);
            if transposed {
                simplified.solve_transposed(&mut self.step);
            } else {
                simplified.solve(&mut self.step);
            }
            *x += &self.step;
            let size = self.step.amax();
            if size <= tolerance * x.amax() {
                return true;
            }
            if !(size < last) {
                return size <= T::EPSILON.sqrt() * x.amax();
            }
            last = size;
            let (x, r) = (&self.step, &mut self.rest);
            subtract_product(&self.hessians, stages, x, r, &mut self.parts, transposed);
        }
        false
    }
}

/// r ← r − M x, or r − Mᵀ x; `parts` are two vectors of length n to work with.
fn subtract_product<T: Float>(
    hessians: &StageHessians<T>,
    stages: &Stages<T>,
    x: &DVector<T>,
    r: &mut DVector<T>,
    parts: &mut [Vec<T>; 2],
    transposed: bool,
) {
    let (s, n) = (stages.count(), stages.n);
    let k = |i: usize, j: usize| T::ratio(1, 2) + stages.u[i * s + j];
    *r -= x;
    let (x, r) = (x.as_slice(), r.as_mut_slice());
    let [sum, part] = parts;
    for j in 0..s {
        if transposed {
            sum.fill(T::int(0));
            for (i, x) in x.chunks_exact(n).enumerate() {
                add(sum, k(i, j), x);
            }
            hessians.turn_transposed(stages, j, sum, part);
            add(&mut r[j * n..][..n], T::int(1), part);
        } else {
            hessians.turn(stages, j, &x[j * n..][..n], part);
            for (i, r) in r.chunks_exact_mut(n).enumerate() {
                add(r, k(i, j), part);
            }
        }
    }
}

/// y ← y + a x.
fn add<T: Float>(y: &mut [T], a: T, x: &[T]) {
    y.iter_mut().zip(x).for_each(|(y, &x)| *y += a * x);
}
