//! What the gradient of a component on a stiff spring κ will have changed by when a sweep is made.
//!
//! Z_q = F(L_p), F linear, and L_p are the forces that are there, or foreseen. With δ the forces at Z_q less those that Z_q was made with, a sweep as
//! it is would change Z_q by h w K B K δ. But as Z_q changes so does the force, by −h b κ ΔZ_q:
//!
//! $$ \Delta Z = h w\, M K B K\, \delta, \qquad M = (1 + h^2 w \kappa\, K B K B)^{-1} , $$
//!
//! and with κ ΔZ added to the gradient a sweep of any form, draft or not, does just this. At Z = 0, where there is nothing to compare with,
//! ΔZ = M (h c (w p + b) − h² w K B K B ∇U). With α ≠ 0 the M of α = 0 is as good as any: what is solved does not depend on it.
//!
//! The start: of the last step the gradient less κ(q − q1), q1 being where it ended, is prolonged, for it has no part in the fast motion. K + Kᵀ = 1 1ᵀ, so
//! the stages are Y = q1 − Kᵀ L_q.
//!
//! Cost: s² products for each spring in a sweep, 3 s² in the start of a step.

use crate::aligned::{Aligned, Places};
use crate::half::force;
use crate::linear::DenseLu;
use crate::product::applied;
use crate::prolongation::View;
use crate::row::{
    Row, add, difference, in_memory, lanes_of, literal, rows, rows_mut, scaled, stride_for, times,
};
use crate::springs::Spring;
use crate::twice;
use equip_scalar::{Float, InstructionSet, Kernel};
use equip_tableau::Gauss;
use nalgebra::DVector;
use std::array::from_fn;

/// A task's `rows` for the rows that `s` stages of the float stand in.
macro_rules! by_rows {
    ($float:ty, $s:expr, $task:ident) => {
        match (stride_for::<$float>($s), lanes_of::<$float>($s)) {
            (4, 4) => $task.rows::<1, 4>(),
            (8, 8) => $task.rows::<1, 8>(),
            (16, 8) => $task.rows::<2, 8>(),
            (24, 8) => $task.rows::<3, 8>(),
            (32, 8) => $task.rows::<4, 8>(),
            _ => {}
        }
    };
}

/// M for one stiffness.
#[derive(Debug)]
pub(crate) struct Matrix<T> {
    /// h M K B K, column by column.
    by_force: Aligned<T>,
    /// h M c.
    by_velocity: Vec<T>,
}

impl<T: Float> Matrix<T> {
    /// For steps of size h, h² w κ being the stiffness.
    pub(crate) fn new(gauss: &Gauss<T>, h: T, stiffness: T) -> Option<Self> {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let mut places = Places::default();
        let twice = twice::of(InstructionSet::best(), gauss, &mut places);
        let mut lu = DenseLu::new(s);
        let m = lu.matrix_mut();
        for (j, &b) in gauss.weights().iter().enumerate() {
            for i in 0..s {
                m[(i, j)] = T::int(i64::from(i == j)) + stiffness * (twice[j * stride + i] * b);
            }
        }
        lu.factor().ok()?;
        let solved = |column: &[T]| {
            let mut x = DVector::from_column_slice(&column[..s]);
            lu.solve(&mut x);
            x * h
        };
        let mut by_force = places.zeros(stride * stride);
        for (to, from) in (by_force.chunks_exact_mut(stride))
            .zip(twice.chunks_exact(stride))
            .take(s)
        {
            to[..s].copy_from_slice(solved(from).as_slice());
        }
        let mut by_velocity = vec![T::int(0); stride];
        by_velocity[..s].copy_from_slice(solved(gauss.nodes()).as_slice());
        Some(Matrix {
            by_force,
            by_velocity,
        })
    }
}

/// Where the gradients are from.
pub(crate) enum From<'a, T> {
    /// Z, which was made with this L.
    Made(&'a [T]),
    /// Z = 0, the start (hi, b).
    Nothing(&'a [T], &'a [T]),
    /// The last step.
    Last(&'a [T], &'a [T], Last<'a, T>),
}

/// The last step, and how it is prolonged.
#[derive(Clone, Copy)]
pub(crate) struct Last<'a, T> {
    pub(crate) prolongation: View<'a, T>,
    pub(crate) l: &'a [T],
    /// Its size over that of this step.
    pub(crate) ratio: T,
    /// ∇H at the start of this step, if it is known.
    pub(crate) known: Option<&'a [T]>,
}

/// Adds κ ΔZ to the gradients.
pub(crate) struct Foresee<'a, T: Float> {
    pub(crate) springs: &'a [Spring<T>],
    pub(crate) matrices: &'a [Matrix<T>],
    /// −Kᵀ, column by column.
    pub(crate) back: &'a [T],
    pub(crate) from: From<'a, T>,
    pub(crate) hb: &'a [T],
    pub(crate) gradients: &'a mut [T],
    /// Degrees of freedom.
    pub(crate) m: usize,
    pub(crate) s: usize,
}

impl<T: Float> Kernel for Foresee<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_rows!(T, self.s, self);
    }
}

impl<T: Float> Foresee<'_, T> {
    #[inline(always)]
    fn rows<const G: usize, const N: usize>(&mut self) {
        let (s, m) = (self.s, self.m);
        let hb: &Row<T, G, N> = literal(rows(self.hb).first());
        let gradients = rows_mut::<T, G, N>(self.gradients);
        for &Spring {
            c,
            kappa,
            w,
            matrix,
        } in self.springs
        {
            let matrix = &self.matrices[matrix];
            if let From::Last(_, _, last) = &self.from {
                let l = rows::<T, G, N>(last.l);
                let behind = applied(self.back, &l[c], s);
                let mut row = l[c + m];
                for g in 0..G {
                    add(
                        &mut row[g],
                        &scaled(&times(&hb[g], &behind[g]), last.ratio * kappa),
                    );
                }
                let at_start = last.known.map_or(T::int(0), |known| known[c]);
                gradients[c] = (last.prolongation).foretell(&row, s, T::int(1), at_start);
            }
            let gradient = &mut gradients[c];
            let mut forces: Row<T, G, N> = from_fn(|g| force(&hb[g], &gradient[g]));
            let velocity = match self.from {
                From::Made(l) => {
                    let l = &rows::<T, G, N>(l)[c + m];
                    forces = from_fn(|g| difference(&forces[g], &l[g]));
                    None
                }
                From::Nothing(hi, b) | From::Last(hi, b, _) => Some(w * hi[c + m] + b[c]),
            };
            let moved = applied(&matrix.by_force, in_memory(&mut forces), s);
            for g in 0..G {
                add(&mut gradient[g], &scaled(&moved[g], kappa * w));
            }
            if let Some(velocity) = velocity {
                let by_velocity: &Row<T, G, N> = literal(rows(&matrix.by_velocity).first());
                for g in 0..G {
                    add(&mut gradient[g], &scaled(&by_velocity[g], kappa * velocity));
                }
            }
        }
    }
}

/// The same for sides of linearised equations whose X was made with `made`, from the start of the step or from its end; `rows` are their δL of the
/// momenta and become what `made` will be next. Component c of side k stands at `(c·sides + k)·stride`.
pub(crate) struct ForeseeSides<'a, T: Float> {
    pub(crate) springs: &'a [Spring<T>],
    pub(crate) matrices: &'a [Matrix<T>],
    pub(crate) hb: &'a [T],
    pub(crate) made: &'a mut [T],
    pub(crate) rows: &'a mut [T],
    pub(crate) sides: usize,
    pub(crate) s: usize,
    /// From the end: −Kᵀ is K with the stages in reverse order but for the sign, and K enters twice.
    pub(crate) reversed: bool,
}

impl<T: Float> Kernel for ForeseeSides<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_rows!(T, self.s, self);
    }
}

impl<T: Float> ForeseeSides<'_, T> {
    #[inline(always)]
    fn rows<const G: usize, const N: usize>(&mut self) {
        let (s, sides) = (self.s, self.sides);
        let hb: &Row<T, G, N> = literal(rows(self.hb).first());
        let made = rows_mut::<T, G, N>(self.made);
        let found = rows_mut::<T, G, N>(self.rows);
        for (i, spring) in self.springs.iter().enumerate() {
            let matrix = &self.matrices[spring.matrix];
            for side in 0..sides {
                let made = &mut made[i * sides + side];
                let row = &mut found[spring.c * sides + side];
                let mut change: Row<T, G, N> = from_fn(|g| difference(&row[g], &made[g]));
                if self.reversed {
                    change = in_reverse(&change, s);
                }
                let mut moved = applied(&matrix.by_force, in_memory(&mut change), s);
                if self.reversed {
                    moved = in_reverse(&moved, s);
                }
                for g in 0..G {
                    let force = times(&hb[g], &scaled(&moved[g], spring.kappa * spring.w));
                    row[g] = difference(&row[g], &force);
                }
                *made = *row;
            }
        }
    }
}

#[inline(always)]
fn in_reverse<T: Float, const G: usize, const N: usize>(
    x: &Row<T, G, N>,
    s: usize,
) -> Row<T, G, N> {
    let mut reversed = *x;
    let (to, from) = (reversed.as_flattened_mut(), x.as_flattened());
    for i in 0..s {
        to[i] = from[s - 1 - i];
    }
    reversed
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::InstructionSet;

    /// On a spring alone what is foreseen is what is: κ(q + Z) for the Z that the equations have.
    #[test]
    fn a_spring_is_solved_for_at_once() {
        for s in [3, 4, 7, 8, 12, 16, 20] {
            let gauss = Gauss::<f64>::new(s).unwrap();
            let (h, kappa, w) = (0.25, 700.0, 0.5);
            let stride = stride_for::<f64>(s);
            let matrices = [Matrix::new(&gauss, h, h * h * w * kappa).unwrap()];
            let springs = [Spring {
                c: 0,
                kappa,
                w,
                matrix: 0,
            }];
            let mut hb = vec![0.0; stride];
            for (hb, &b) in hb.iter_mut().zip(gauss.weights()) {
                *hb = h * b;
            }
            let twice = twice::of(InstructionSet::best(), &gauss, &mut Places::default());
            let l = vec![0.0; 2 * stride];
            for set in InstructionSet::available() {
                // Z = 0 as a guess, or as what no force and no velocity has made.
                for p in [3.0, 0.0] {
                    let hi = [2.0, p];
                    let mut gradients = vec![kappa * hi[0]; stride];
                    set.run(&mut Foresee {
                        springs: &springs,
                        matrices: &matrices,
                        back: &[],
                        from: if p == 0.0 {
                            From::Made(&l)
                        } else {
                            From::Nothing(&hi, &[0.25])
                        },
                        hb: &hb,
                        gradients: &mut gradients,
                        m: 1,
                        s,
                    });
                    let velocity = if p == 0.0 { 0.0 } else { w * p + 0.25 };
                    for (i, &c) in gauss.nodes().iter().enumerate() {
                        let z = gradients[i] / kappa - hi[0];
                        let sum: f64 = (0..s)
                            .map(|j| twice[j * stride + i] * hb[j] * gradients[j])
                            .sum();
                        let made = h * velocity * c - h * w * sum;
                        assert!((z - made).abs() < 2e-14, "s = {s}: {z}, {made}");
                    }
                }
            }
        }
    }
}
