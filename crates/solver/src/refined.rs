//! Dense systems in wide numbers: factorised in doubles, solved to the last digit by refinement.
//!
//! x ← x + (L U)⁻¹ (b − M x), with the residual in the wide numbers: each pass adds the digits that a double has, less those that the condition of M
//! takes [Higham, *Accuracy and Stability of Numerical Algorithms*, ch. 12]. Systems of stages are in units of the state, so their numbers are of ordinary
//! sizes.
//!
//! Cost: 2/3 N³ operations in doubles to factorise; a solve takes some three passes of 2 N² in doubles and as many in wide numbers, side by side in vectors.

use crate::linear::{DenseLu, Singular};
use equip_scalar::{Float, InstructionSet, Kernel, Pack};
use nalgebra::DVector;

/// Numbers of a column that are worked on together.
const LANES: usize = 8;
/// Passes at most: with a condition of 10¹² each still adds 4 digits.
const MAX_PASSES: usize = 12;

/// M, its factors in doubles, and room to work in.
#[derive(Debug)]
pub(crate) struct Refined<T: Float> {
    set: InstructionSet,
    /// Column by column.
    matrix: Vec<T>,
    /// M and Mᵀ as products read them: of each group of rows column after column.
    packed: [Vec<[T::Pack<LANES>; 1]>; 2],
    lu: DenseLu<f64>,
    correction: DVector<f64>,
    rest: Vec<T>,
    x: Vec<T>,
}

impl<T: Float> Refined<T> {
    pub(crate) fn new(dimension: usize) -> Self {
        let groups = dimension.div_ceil(LANES);
        let zeros = |len: usize| vec![T::int(0); len];
        let packs = vec![[T::Pack::splat(T::int(0))]; groups * dimension];
        Refined {
            set: InstructionSet::best(),
            matrix: zeros(dimension * dimension),
            packed: [packs.clone(), packs],
            lu: DenseLu::new(dimension),
            correction: DVector::zeros(dimension),
            rest: zeros(groups * LANES),
            x: zeros(dimension),
        }
    }

    /// Sets M to the identity.
    pub(crate) fn reset(&mut self) {
        let n = self.x.len();
        self.matrix.fill(T::int(0));
        let diagonal = self.matrix.iter_mut().step_by(n + 1);
        diagonal.for_each(|x| *x = T::int(1));
    }

    pub(crate) fn subtract(&mut self, (row, column): (usize, usize), x: T) {
        self.matrix[column * self.x.len() + row] -= x;
    }

    pub(crate) fn factor(&mut self) -> Result<(), Singular> {
        let n = self.x.len();
        for (to, x) in self.lu.matrix_mut().iter_mut().zip(&self.matrix) {
            *to = x.to_f64();
        }
        // From one row and from one column to the next.
        for (packed, [by_row, by_column]) in self.packed.iter_mut().zip([[1, n], [n, 1]]) {
            for (group, packed) in packed.chunks_exact_mut(n).enumerate() {
                let rows = group * LANES..n.min((group + 1) * LANES);
                for (column, packed) in packed.iter_mut().enumerate() {
                    let mut numbers = [T::int(0); LANES];
                    for (x, row) in numbers.iter_mut().zip(rows.clone()) {
                        *x = self.matrix[row * by_row + column * by_column];
                    }
                    *packed = [T::Pack::of(&numbers)];
                }
            }
        }
        self.lu.factor()
    }

    /// x ← M⁻¹ x, or M⁻ᵀ x.
    pub(crate) fn solve(&mut self, x: &mut DVector<T>, transposed: bool) {
        let n = x.len();
        self.rest[..n].copy_from_slice(x.as_slice());
        x.fill(T::int(0));
        let mut last = f64::INFINITY;
        for _ in 0..MAX_PASSES {
            for (to, rest) in self.correction.iter_mut().zip(&self.rest) {
                *to = rest.to_f64();
            }
            if transposed {
                self.lu.solve_transposed(&mut self.correction);
            } else {
                self.lu.solve(&mut self.correction);
            }
            let mut size = 0.0;
            for ((x, step), &by) in x.iter_mut().zip(&mut self.x).zip(&self.correction) {
                *step = T::exact(by);
                *x += *step;
                size = by.abs().max(size);
            }
            // What the next correction would be; also what is not a number ends this.
            let next = size * (size / last).min(1.0);
            let next = if last.is_finite() { next } else { size };
            let rounding = T::EPSILON.to_f64() * x.amax().to_f64();
            if !(next > rounding && size < last / 2.0) {
                return;
            }
            last = size;
            self.set.run(&mut Residual {
                system: self,
                transposed,
            });
        }
    }
}

/// b − M x from what was left before the last correction, or with Mᵀ.
struct Residual<'a, T: Float> {
    system: &'a mut Refined<T>,
    transposed: bool,
}

impl<T: Float> Kernel for Residual<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let system = &mut *self.system;
        let packed = &system.packed[usize::from(self.transposed)];
        let rest = system.rest.as_chunks_mut::<LANES>().0;
        for (rest, packed) in rest.iter_mut().zip(packed.chunks_exact(system.x.len())) {
            let product = T::Pack::dot(packed, 0, &system.x);
            *rest = (T::Pack::of(rest) - product).numbers();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::DoubleDouble;

    /// Both ways to 30 digits, of a matrix whose condition is some thousands; factors in doubles alone have twelve.
    #[test]
    fn solves_to_the_last_digit() {
        let n = 13;
        let entry = |i: usize, j: usize| {
            let smooth = DoubleDouble::ratio(1, (i + 2 * j + 1) as i64);
            if i == j {
                smooth + DoubleDouble::ratio(1, 64)
            } else {
                smooth
            }
        };
        let mut system = Refined::<DoubleDouble>::new(n);
        system.reset();
        for i in 0..n {
            for j in 0..n {
                let identity = DoubleDouble::int(i64::from(i == j));
                system.subtract((i, j), identity - entry(i, j));
            }
        }
        system.factor().unwrap();
        let expected: Vec<_> = (0..n)
            .map(|i| DoubleDouble::ratio(i as i64 - 5, 7))
            .collect();
        for transposed in [false, true] {
            let row = |i: usize| {
                (0..n).fold(DoubleDouble::int(0), |sum, j| {
                    let m = if transposed { entry(j, i) } else { entry(i, j) };
                    sum + m * expected[j]
                })
            };
            let mut x = DVector::from_fn(n, |i, _| row(i));
            system.solve(&mut x, transposed);
            for (x, &expected) in x.iter().zip(&expected) {
                let off = (*x - expected).abs().to_f64();
                assert!(off < 1e-26, "{transposed}: {off:e}");
            }
        }
    }

    #[test]
    fn names_a_singular_matrix() {
        let mut system = Refined::<DoubleDouble>::new(2);
        system.reset();
        system.subtract((0, 0), DoubleDouble::int(1));
        assert_eq!(system.factor(), Err(Singular));
    }
}
