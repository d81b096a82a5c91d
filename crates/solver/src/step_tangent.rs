//! [`StepTangent`]: the derivative of a step at fixed α.
//!
//! With the stages Y_i and α's of a step and B_i = h b_i J∇²H(Y_i),
//!
//! $$ \delta Z_i = \sum_j K_{ij}(\alpha) B_j (\delta y_0 + \delta Z_j), \qquad
//!    \delta y_1 = \delta y_0 + \sum_j B_j (\delta y_0 + \delta Z_j) . $$
//!
//! Cost: s Hessians per step; per deviation sweeps δZ ← K(α)∘B (δy0 + δZ) of 2 s nnz + s² n operations each,
//! as many as the stages themselves take. Where these do not contract (about hω > 1), one dense factorisation
//! of size s·2m per step, made only then.

use crate::failure::Failure;
use crate::hessians::StageHessians;
use crate::linearisation::Linearisation;
use crate::outcome::Counts;
use crate::parts::Part;
use crate::stages::Stages;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_tableau::Gauss;
use nalgebra::DVector;

/// Sweeps for a deviation before a factorisation is made; the stages take up to 20.
const MOST_SWEEPS: u32 = 60;
/// Increments below this many units of the last place are round-off.
const ROUND_OFF: i64 = 64;

/// The tangent map of one step after the other.
#[derive(Debug)]
pub struct StepTangent<T: Float, E> {
    energy: E,
    stages: Stages<T>,
    hessians: StageHessians<T>,
    /// Made when sweeps first fail.
    linearised: Option<Linearisation<T>>,
    /// Whether it is that of the present part.
    is_factored: bool,
    /// B_j δy0, block by block.
    turned: Vec<T>,
    x: DVector<T>,
    part: Vec<T>,
    /// B_j (δy0 + δZ_j), block by block.
    products: Vec<T>,
}

impl<T: Float, E: Evaluate<T>> StepTangent<T, E> {
    /// For steps of `system` with the nodes of `gauss`.
    pub fn new<H: System<Evaluator<T> = E>>(system: &H, gauss: Gauss<T>) -> Self {
        let (s, n) = (gauss.stages(), 2 * system.degrees_of_freedom());
        StepTangent {
            energy: system.evaluator::<T>(),
            stages: Stages::new(gauss, n),
            hessians: StageHessians::new(s, system.structure().hessian.clone()),
            linearised: None,
            is_factored: false,
            turned: vec![T::int(0); s * n],
            x: DVector::zeros(s * n),
            part: vec![T::int(0); n],
            products: vec![T::int(0); s * n],
        }
    }

    /// n = 2m.
    pub fn components(&self) -> usize {
        self.stages.n
    }

    /// Takes the linearised stage equations of `part`. Costs s Hessians.
    pub fn linearise(&mut self, part: &Part<T>) {
        let stages = &mut self.stages;
        let (s, n) = (stages.count(), stages.n);
        stages.set_alphas(&part.alphas);
        stages.l.copy_from_slice(&part.l);
        for i in 0..s {
            for j in 0..n {
                let z = (0..s).fold(T::int(0), |sum, k| {
                    sum + entry(stages, i, k) * part.l[k * n + j]
                });
                stages.z[i * n + j] = z;
                stages.points[i * n + j] = part.start.hi[j] + (z + part.start.lo[j]);
            }
        }
        stages.measure(&part.start, false);
        let mut counts = Counts::default();
        self.hessians
            .take(&self.stages, &mut self.energy, part.h, &mut counts);
        self.is_factored = false;
    }

    /// Carries `deviation`, n components, over the part that has been linearised.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the linearised stages cannot be solved for.
    pub fn carry(&mut self, deviation: &mut [T]) -> Result<(), Failure<T>> {
        let (stages, n) = (&self.stages, self.stages.n);
        let s = stages.count();
        for (x, &scale) in deviation.iter_mut().zip(&stages.scale) {
            *x /= scale;
        }
        for (j, out) in self.turned.chunks_exact_mut(n).enumerate() {
            self.hessians.turn(stages, j, deviation, out);
        }
        self.x.fill(T::int(0));
        if self.is_factored || !self.sweep() {
            self.factor()?;
            times_k(&self.stages, &self.turned, self.x.as_mut_slice());
            if let Some(linearised) = &mut self.linearised {
                linearised.solve(&mut self.x);
            }
        }
        let stages = &self.stages;
        for i in 0..s {
            let z = &self.x.as_slice()[i * n..][..n];
            self.hessians.turn(stages, i, z, &mut self.part);
            let turned = &self.turned[i * n..][..n];
            for (x, (a, b)) in deviation.iter_mut().zip(turned.iter().zip(&self.part)) {
                *x += *a + *b;
            }
        }
        for (x, &scale) in deviation.iter_mut().zip(&stages.scale) {
            *x *= scale;
        }
        Ok(())
    }

    /// Sweeps from δZ = `x` until the increments are round-off; false if they do not contract.
    fn sweep(&mut self) -> bool {
        let n = self.stages.n;
        let mut before = T::INFINITY;
        for _ in 0..MOST_SWEEPS {
            let blocks = self.products.chunks_exact_mut(n).enumerate();
            for (i, product) in blocks {
                let z = &self.x.as_slice()[i * n..][..n];
                self.hessians.turn(&self.stages, i, z, product);
                let turned = &self.turned[i * n..][..n];
                product.iter_mut().zip(turned).for_each(|(x, &t)| *x += t);
            }
            let (change, size) = times_k(&self.stages, &self.products, self.x.as_mut_slice());
            if change <= T::EPSILON * size {
                return true;
            }
            if !(change < before) {
                // Increments that no longer fall are round-off, or there is no contraction.
                return change <= T::int(ROUND_OFF) * T::EPSILON * size;
            }
            before = change;
        }
        false
    }

    /// Factorises the linearised stages, unless that is done.
    fn factor(&mut self) -> Result<(), Failure<T>> {
        if self.is_factored {
            return Ok(());
        }
        let (s, n) = (self.stages.count(), self.stages.n);
        let linearised = (self.linearised).get_or_insert_with(|| Linearisation::new(s, n));
        linearised
            .refresh(&self.stages, &self.hessians)
            .map_err(|_| Failure::Singular)?;
        self.is_factored = true;
        Ok(())
    }
}

/// x ← K(α) `products`, block by block; returns the largest change of x and the largest x.
fn times_k<T: Float>(stages: &Stages<T>, products: &[T], x: &mut [T]) -> (T, T) {
    let (s, n) = (stages.count(), stages.n);
    let (mut change, mut size) = (T::int(0), T::int(0));
    for i in 0..s {
        for j in 0..n {
            let sum = (0..s).fold(T::int(0), |sum, k| {
                sum + entry(stages, i, k) * products[k * n + j]
            });
            let x = &mut x[i * n + j];
            change = change.max((sum - *x).abs());
            size = size.max(sum.abs());
            *x = sum;
        }
    }
    (change, size)
}

/// K(α)_ij.
fn entry<T: Float>(stages: &Stages<T>, i: usize, j: usize) -> T {
    T::ratio(1, 2) + stages.u[i * stages.count() + j]
}
