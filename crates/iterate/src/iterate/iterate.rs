//! The stages of a step during the iteration: Z, L(Z), and the workspace of the iteration.
//!
//! Component c of stage i is at `c·stride + i`, so that the stages lie side by side in SIMD registers. The
//! entries from s to `stride` are padding.
//!
//! K is stored with K_ij + K_ji = 1 exactly, so the solution conserves quadratic invariants to rounding.
//!
//! Cost of an iteration: s gradients (of H, or of U) and 2m s² products. Nothing is allocated.

use crate::layout::aligned::{Aligned, Places};
use crate::layout::row::{by_groups, placed, stride_for};
use crate::layout::state::State;
use crate::matrix::inverse::InverseK;
use crate::matrix::product::columns_into;
use crate::matrix::twofold;
use equip_autodiff::Kinetic;
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Coefficients;

/// The stages, and the data of the method that an iteration needs.
#[derive(Debug)]
pub struct Iterate<T: Float> {
    pub(crate) s: usize,
    pub(crate) stride: usize,
    pub(crate) n: usize,
    /// T(p), if it is quadratic with a diagonal M⁻¹.
    pub(crate) kinetic: Option<Kinetic<T>>,
    pub(crate) set: InstructionSet,
    /// Workspace for K row by row.
    rows: Vec<T>,
    /// K(α), and K of the initial α_k, column by column.
    pub(crate) k: Aligned<T>,
    pub(crate) k_start: Aligned<T>,
    /// Whether K differs from K of the initial α_k.
    pub(crate) k_has_moved: bool,
    /// h b_i.
    pub(crate) hb: Aligned<T>,
    pub(crate) h: T,
    /// L of the last iteration, and of the last step.
    pub(crate) l: Aligned<T>,
    pub(crate) l_before: Aligned<T>,
    /// K⁻¹ of the initial α_k, if the stage equations are linear.
    pub(crate) inverse_k: Option<InverseK<T>>,
    /// Workspace for ΔL of incremental iterations, and K L − Z of preconditioned ones.
    pub(crate) delta: Aligned<T>,
    /// Z of the unknown components, and a copy.
    pub(crate) z: Aligned<T>,
    pub(crate) z_before: Aligned<T>,
    /// The stages. Those of momenta that are not unknowns are valid if `has_momenta`.
    pub(crate) points: Aligned<T>,
    pub(crate) has_momenta: bool,
    pub(crate) gradients: Aligned<T>,
    /// The size of each component over the step, and its inverse.
    pub(crate) scale: Vec<T>,
    pub(crate) inverse_scale: Vec<T>,
    /// K B K if iterations may be incremental: for separable H and α = 0.
    pub(crate) twofold: Option<Aligned<T>>,
    /// Whether Z = K(α) L, as incremental iterations require.
    pub(crate) z_is_k_l: bool,
    /// Whether the last iteration was incremental. L is then incomplete.
    pub(crate) is_incremental: bool,
    /// Whether the last iteration was preconditioned, and its residual is in `delta`, its Z in `z_before`.
    pub(crate) has_residual: bool,
    /// Whether the sizes were measured on stages near the solution.
    pub(crate) is_measured: bool,
}

impl<T: Float> Iterate<T> {
    /// For n components. `alphas` are the initial α_k of every step.
    pub fn new(
        method: &Coefficients<T>,
        n: usize,
        kinetic: Option<Kinetic<T>>,
        alphas: &[T],
    ) -> Self {
        let mut places = Places::default();
        let s = method.stages();
        let stride = stride_for::<T>(s);
        let set = InstructionSet::best();
        // One column for each entry of L. The columns of the padding are zero.
        let mut k = places.zeros(stride * stride);
        let mut k_start = places.zeros(stride * stride);
        let mut by_rows = vec![T::int(0); s * s];
        columns_into(method, alphas, &mut by_rows, &mut k_start);
        k.copy_from_slice(&k_start);
        let kinetic = kinetic.filter(|kinetic| kinetic.diagonal().is_some());
        let hb = places.zeros(stride);
        let is_unperturbed = alphas.iter().all(|&alpha| alpha == T::int(0));
        let mut rows = || places.zeros(n * stride);
        let [l, l_before, delta, z, z_before, points, gradients] = [(); 7].map(|()| rows());
        let twofold = (kinetic.is_some() && is_unperturbed)
            .then(|| twofold::of(set, method, &k_start, &mut places));
        Iterate {
            s,
            stride,
            n,
            kinetic,
            set,
            rows: by_rows,
            k,
            k_start,
            k_has_moved: false,
            hb,
            h: T::int(0),
            l,
            l_before,
            inverse_k: None,
            delta,
            z,
            z_before,
            points,
            has_momenta: false,
            gradients,
            scale: vec![T::int(0); n],
            inverse_scale: vec![T::int(0); n],
            twofold,
            z_is_k_l: true,
            is_incremental: false,
            has_residual: false,
            is_measured: false,
        }
    }

    /// For linear stage equations, as of a quadratic H: L of preconditioned iterations is computed from Z.
    pub fn assume_linear(&mut self, method: &Coefficients<T>, alphas: &[T]) {
        self.inverse_k = Some(InverseK::new(method, alphas));
    }

    /// The number of stages s.
    pub fn stages(&self) -> usize {
        self.s
    }

    /// The number of components n = 2m of the state.
    pub fn components(&self) -> usize {
        self.n
    }

    /// The length of a row: component c of stage i is at `c·stride + i`.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The number of unknown components: all, or the positions.
    pub fn unknowns(&self) -> usize {
        match self.kinetic {
            Some(_) => self.n / 2,
            None => self.n,
        }
    }

    /// Whether an iteration goes from the positions to the momenta and back.
    pub fn is_twofold(&self) -> bool {
        self.kinetic.is_some()
    }

    /// The diagonal of M⁻¹ in T(p), if the positions are the unknowns.
    pub fn inverse_masses(&self) -> Option<&[T]> {
        self.kinetic.as_ref().and_then(Kinetic::diagonal)
    }

    /// Whether L belongs to the last iteration.
    pub fn has_increments(&self) -> bool {
        !self.is_incremental
    }

    /// L of the last iteration, h b_i J∇H(Y_i), component by component.
    pub fn increments(&self) -> &[T] {
        &self.l
    }

    /// The stages Y_i, component by component. Those of the momenta are valid after
    /// [`keep_momenta`](Self::keep_momenta).
    pub fn points(&self) -> &[T] {
        &self.points
    }

    /// The size of each component over the step: max(|y_c|, max_i |Y_ic|).
    pub fn scale(&self) -> &[T] {
        &self.scale
    }

    /// The inverse sizes.
    pub fn inverse_scale(&self) -> &[T] {
        &self.inverse_scale
    }

    /// The instruction set of the kernels.
    pub fn instruction_set(&self) -> InstructionSet {
        self.set
    }

    /// y1 = y0 + Σ L_i.
    pub(crate) fn advance(&self, y: &State<T>, next: &mut State<T>) {
        y.advance_by_component(self.set, &self.l, self.s, next);
    }

    /// Computes the stages from Z.
    pub(crate) fn place(&mut self, y: &State<T>) {
        let unknowns = self.unknowns();
        self.set.run(&mut Place {
            hi: &y.hi[..unknowns],
            lo: &y.lo[..unknowns],
            z: &self.z,
            points: &mut self.points,
            s: self.s,
        });
    }

    /// Sets K of these α_k.
    pub(crate) fn fill_k(&mut self, method: &Coefficients<T>, alphas: &[T]) {
        columns_into(method, alphas, &mut self.rows, &mut self.k);
        self.k_has_moved = true;
    }
}

/// The stages y0 + Z.
struct Place<'a, T> {
    hi: &'a [T],
    lo: &'a [T],
    z: &'a [T],
    points: &'a mut [T],
    s: usize,
}

impl<T: Float> Kernel for Place<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.s, self)
    }
}

impl<T: Float> Place<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let points = self.points.as_chunks_mut::<N>().0.chunks_exact_mut(groups);
        let z = self.z.as_chunks::<N>().0.chunks_exact(groups);
        let starts = self.hi.iter().zip(self.lo);
        for ((points, z), (&hi, &lo)) in points.zip(z).zip(starts) {
            for (point, z) in points.iter_mut().zip(z) {
                *point = placed(hi, lo, z);
            }
        }
    }
}
