//! [`TangentMap`]: how a small deviation moves along a run.
//!
//! The variational equations solved by the step itself: with the stages Y_i and α's of a step and B_i = h b_i J∇²H(Y_i),
//!
//! $$ \delta Z_i = \sum_j K_{ij}(\alpha) B_j (\delta y_0 + \delta Z_j), \qquad \delta y_1 = \delta y_0 + \sum_j B_j (\delta y_0 + \delta Z_j) . $$
//!
//! This is the derivative of the step at fixed α, a symplectic map to rounding. What the solved α adds, ∂α/∂y0, is of the size of the step's
//! error and is left out.
//!
//! Cost per step: s Hessians; per deviation sweeps δZ ← K(α)∘B (δy0 + δZ) of 2 s nnz + s² n operations each, as many as the stages themselves take. Where
//! these do not contract (about hω > 1), one dense factorisation of size s·2m per step, made only then.

use crate::adaptive_stepper::AdaptiveStepper;
use crate::dense::Part;
use crate::error::IntegrateError;
use crate::hessians::StageHessians;
use crate::linearisation::Linearisation;
use crate::outcome::Counts;
use crate::reversible_stepper::ReversibleStepper;
use crate::stages::Stages;
use crate::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use nalgebra::DVector;

/// Sweeps for a deviation before a factorisation is made; the stages take up to 20.
const MOST_SWEEPS: u32 = 60;
/// Increments below this many units of the last place are round-off.
const ROUND_OFF: i64 = 64;

/// A run whose steps can be followed by a [`TangentMap`].
pub trait Steps<T: Float, E>: sealed::Inner<T, E> {}

impl<T: Float, E: Evaluate<T>> Steps<T, E> for Stepper<T, E> {}
impl<T: Float, E: Evaluate<T>> Steps<T, E> for AdaptiveStepper<T, E> {}
impl<T: Float, E: Evaluate<T>> Steps<T, E> for ReversibleStepper<T, E> {}

mod sealed {
    use crate::adaptive_stepper::AdaptiveStepper;
    use crate::reversible_stepper::ReversibleStepper;
    use crate::stepper::Stepper;
    use equip_scalar::Float;

    pub trait Inner<T: Float, E> {
        fn inner(&self) -> &Stepper<T, E>;
        fn inner_mut(&mut self) -> &mut Stepper<T, E>;
    }

    impl<T: Float, E> Inner<T, E> for Stepper<T, E> {
        fn inner(&self) -> &Stepper<T, E> {
            self
        }

        fn inner_mut(&mut self) -> &mut Stepper<T, E> {
            self
        }
    }

    impl<T: Float, E> Inner<T, E> for AdaptiveStepper<T, E> {
        fn inner(&self) -> &Stepper<T, E> {
            &self.inner
        }

        fn inner_mut(&mut self) -> &mut Stepper<T, E> {
            &mut self.inner
        }
    }

    impl<T: Float, E> Inner<T, E> for ReversibleStepper<T, E> {
        fn inner(&self) -> &Stepper<T, E> {
            &self.inner
        }

        fn inner_mut(&mut self) -> &mut Stepper<T, E> {
            &mut self.inner
        }
    }
}

/// The tangent map along a run.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_solver::{Equip, TangentMap};
///
/// let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0]))?;
/// let mut run = Equip::stages(4).step(0.1).start(&oscillator, &[1.0], &[0.0], 0.0)?;
/// let mut tangent = TangentMap::new(&oscillator, &mut run);
/// let mut deviation = vec![1.0, 0.0];
/// for _ in 0..10 {
///     run.advance()?;
///     tangent.carry(&run, &mut deviation)?;
/// }
/// assert!((deviation[0] - 1f64.cos()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TangentMap<T: Float, E> {
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

impl<T: Float, E: Evaluate<T>> TangentMap<T, E> {
    /// Follows `run`, made of the same `system`, from its next step on.
    pub fn new<H: System<Evaluator<T> = E>>(system: &H, run: &mut impl Steps<T, E>) -> Self {
        let core = &mut run.inner_mut().core;
        core.parts.wanted = true;
        let (s, n) = (core.stages.count(), core.stages.n);
        TangentMap {
            energy: system.evaluator::<T>(),
            stages: Stages::new(core.stages.gauss.clone(), n),
            hessians: StageHessians::new(s, system.structure().hessian.to_pattern()),
            linearised: None,
            is_factored: false,
            turned: vec![T::int(0); s * n],
            x: DVector::zeros(s * n),
            part: vec![T::int(0); n],
            products: vec![T::int(0); s * n],
        }
    }

    /// Carries `deviations`, one after the other, each of length 2m, over the step that `run` made last.
    ///
    /// # Errors
    /// [`IntegrateError::Singular`] if the linearised stages cannot be solved for; the step could then not have been made by Newton's
    /// method either.
    ///
    /// # Panics
    /// When the length of `deviations` is no multiple of 2m.
    pub fn carry(
        &mut self,
        run: &impl Steps<T, E>,
        deviations: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        let n = self.stages.n;
        assert_eq!(deviations.len() % n, 0, "a deviation has 2m components");
        for part in run.inner().core.parts.all() {
            self.linearise(part);
            for deviation in deviations.chunks_exact_mut(n) {
                self.carry_over_part(deviation, part)?;
            }
        }
        Ok(())
    }

    fn linearise(&mut self, part: &Part<T>) {
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

    fn carry_over_part(
        &mut self,
        deviation: &mut [T],
        part: &Part<T>,
    ) -> Result<(), IntegrateError<T>> {
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
            self.factor(part)?;
            mix(&self.stages, &self.turned, self.x.as_mut_slice());
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
            let (change, size) = mix(&self.stages, &self.products, self.x.as_mut_slice());
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

    /// Factorises the linearised stages of `part`, unless that is done.
    fn factor(&mut self, part: &Part<T>) -> Result<(), IntegrateError<T>> {
        if self.is_factored {
            return Ok(());
        }
        let (s, n) = (self.stages.count(), self.stages.n);
        let linearised = (self.linearised).get_or_insert_with(|| Linearisation::new(s, n));
        linearised
            .refresh(&self.stages, &self.hessians)
            .map_err(|_| IntegrateError::Singular {
                time: part.time,
                step: part.h,
                halvings: 0,
            })?;
        self.is_factored = true;
        Ok(())
    }
}

/// x ← K(α) `products`, block by block; returns the largest change of x and the largest x.
fn mix<T: Float>(stages: &Stages<T>, products: &[T], x: &mut [T]) -> (T, T) {
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
