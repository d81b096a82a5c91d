//! What of a displacement is slow: its part in motion that the step resolves.
//!
//! Around a point y the flow turns with A = hJ∇²H(y), whose eigenvalues are ±ihω for an oscillation of frequency ω. The filter
//!
//! $$ F = (I + A^4)^{-1} $$
//!
//! leaves a displacement of slow motion as it is and takes 1/(1 + (hω)⁴) of one of an oscillation that the step does not resolve, in
//! whatever direction that oscillation points. Weights of single components do that only where the fast motion has components of its own.
//!
//! Cost: a Hessian, 3 n³ operations; for each displacement 2 n².

use crate::hessians::turned;
use crate::linear::DenseLu;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;
use nalgebra::{DMatrix, DVector};

/// Up to this dimension the filters are made: they are dense.
pub(crate) const LARGEST: usize = 64;

/// The filters at both ends of a step.
#[derive(Debug)]
pub(crate) struct Slow<T: Float> {
    pub(crate) start: Filter<T>,
    pub(crate) end: Filter<T>,
}

/// F at one point.
#[derive(Debug)]
pub(crate) struct Filter<T: Float> {
    pattern: Pattern,
    entries: Vec<T>,
    a: DMatrix<T>,
    square: DMatrix<T>,
    lu: DenseLu<T>,
    x: DVector<T>,
    /// Units of the components.
    sizes: Vec<T>,
}

impl<T: Float> Slow<T> {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        Slow {
            start: Filter::new(pattern),
            end: Filter::new(pattern),
        }
    }

    /// Takes the filters at both ends of a step of size `h`, components in units of `sizes`. Returns whether there are any.
    pub(crate) fn take<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        (start, end): (&[T], &[T]),
        h: T,
        sizes: &[T],
    ) -> bool {
        self.start.take(energy, start, h, sizes) && self.end.take(energy, end, h, sizes)
    }
}

impl<T: Float> Filter<T> {
    fn new(pattern: &Pattern) -> Self {
        let n = pattern.dimension();
        Filter {
            entries: vec![T::int(0); pattern.len()],
            pattern: pattern.clone(),
            a: DMatrix::zeros(n, n),
            square: DMatrix::zeros(n, n),
            lu: DenseLu::new(n),
            x: DVector::zeros(n),
            sizes: vec![T::int(1); n],
        }
    }

    fn take<E: Evaluate<T>>(&mut self, energy: &mut E, y: &[T], h: T, sizes: &[T]) -> bool {
        let n = y.len();
        energy.hessian(y, &mut self.entries);
        self.sizes.copy_from_slice(sizes);
        self.a.fill(T::int(0));
        for row in 0..n {
            let (r, sign) = turned::<T>(row, n);
            for (position, column) in self.pattern.row(row) {
                let x = sign * self.entries[position] * (sizes[column] / sizes[r]);
                self.a[(r, column)] = h * x;
            }
        }
        self.a.mul_to(&self.a, &mut self.square);
        let matrix = self.lu.matrix_mut();
        self.square.mul_to(&self.square, matrix);
        for j in 0..n {
            matrix[(j, j)] += T::int(1);
        }
        self.lu.factor().is_ok()
    }

    /// u ← F u.
    pub(crate) fn apply(&mut self, u: &mut [T]) {
        for ((x, &u), &size) in self.x.iter_mut().zip(&*u).zip(&self.sizes) {
            *x = u / size;
        }
        self.lu.solve(&mut self.x);
        for ((u, &x), &size) in u.iter_mut().zip(self.x.iter()).zip(&self.sizes) {
            *u = x * size;
        }
    }
}
