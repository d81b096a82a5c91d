//! For H = T(p) + U(q), T = ½ Σ w_c p_c² + b·p, the momenta are eliminated and the equations solved for the
//! positions:
//!
//! $$ X_q = R + h w\, (K B K)\, \delta L_p, \qquad R = r_q + K h B w\, r_p, \qquad \delta L_p = -h B\,
//! \nabla^2 U\, X_q , $$
//!
//! If the end is fixed, K − 1 1ᵀ replaces K. The other end changes by Σ δL_q = h w (Σ b r_p + κ·δL_p), κ = Kᵀ
//! b, and by Σ δL_p.
//!
//! Cost: an iteration costs nnz(∇²U)·s + m s² products for each side.

use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::Held;
use crate::layout::row::{add, by_groups, fused, fused_each, scaled, stride_for, times};
use crate::linear::stage_hessians::row_times;
use crate::matrix::product::product_any;
use crate::matrix::twofold::add_product;
use equip_autodiff::Pattern;
use equip_scalar::{Float, InstructionSet, Kernel, Pack, mix_stages};
use equip_tableau::Coefficients;

/// The data for each end that may be fixed, and for each row of X_q.
#[derive(Debug)]
pub(crate) struct Positions<T> {
    /// K B K, column by column.
    twofold: [Vec<T>; 2],
    /// κ.
    kappa: [Vec<T>; 2],
    /// R.
    rest: Vec<T>,
    /// Σ h b w r_p.
    drift: Vec<T>,
}

impl<T: Float> Positions<T> {
    /// Allocates `rows` rows. `k` holds K for each end.
    pub(crate) fn new(method: &Coefficients<T>, k: &[Vec<T>; 2], rows: usize) -> Self {
        let stride = stride_for::<T>(method.stages());
        let twofold = |k: &Vec<T>| {
            let mut product = vec![T::int(0); stride * stride];
            add_product(InstructionSet::best(), k, method, &mut product);
            product
        };
        let kappa = |k: &Vec<T>| {
            let columns = k.chunks_exact(stride);
            let weighed = columns.map(|column| {
                let pairs = column.iter().zip(method.weights());
                pairs.fold(T::int(0), |sum, (&k, &b)| sum + k * b)
            });
            weighed.collect()
        };
        Positions {
            twofold: k.each_ref().map(twofold),
            kappa: k.each_ref().map(kappa),
            rest: vec![T::int(0); rows * stride],
            drift: vec![T::int(0); rows],
        }
    }
}

/// The input and output of an iteration of several sides.
pub(crate) struct Iteration<'a, T: Float> {
    /// ∂²H/∂y∂y and its entries at the stages.
    pub(crate) pattern: &'a Pattern,
    pub(crate) entries: &'a [T],
    /// K column by column, for the end that is fixed.
    pub(crate) k: &'a [T],
    pub(crate) held: Held,
    /// K δL, and δL.
    pub(crate) mixed: &'a mut [T],
    pub(crate) dl: &'a mut [T],
    pub(crate) sums: &'a mut [T],
}

impl<T: Float> Positions<T> {
    /// Computes R from r of all sides.
    pub(crate) fn begin(&mut self, of: Iteration<'_, T>, r: &[T], iterate: &Iterate<T>) {
        let half = iterate.n / 2 * iterate.stride;
        let drifts = self.drift.chunks_exact_mut(iterate.n / 2);
        let have_converged = self.rest.chunks_exact_mut(half);
        for ((r, rest), drift) in r.chunks_exact(2 * half).zip(have_converged).zip(drifts) {
            let (r_q, r_p) = r.split_at(half);
            let (dl, mixed) = (&mut of.dl[..half], &mut of.mixed[..half]);
            iterate.set.run(&mut Drift {
                hb: &iterate.hb,
                w: iterate.inverse_masses().unwrap_or_default(),
                r_p,
                dl,
                sums: drift,
            });
            mix_stages(iterate.set, of.k, dl, mixed, iterate.s, iterate.stride);
            for ((x, &r), &z) in rest.iter_mut().zip(r_q).zip(&*mixed) {
                *x = r + z;
            }
        }
    }

    /// Sets X_q = R, its value without δL_p.
    pub(crate) fn constant_part_into(&self, x: &mut [T], iterate: &Iterate<T>) {
        let half = iterate.n / 2 * iterate.stride;
        for (x, rest) in x
            .chunks_exact_mut(2 * half)
            .zip(self.rest.chunks_exact(half))
        {
            x[..half].copy_from_slice(rest);
        }
    }

    /// One iteration for X_q and its δL. A row uses the rows before it as already updated, unless all rows
    /// are computed `from` another X.
    pub(crate) fn iteration(
        &self,
        of: Iteration<'_, T>,
        (x, from): (&mut [T], Option<&[T]>),
        iterate: &Iterate<T>,
    ) {
        iterate.set.run(&mut Row {
            pattern: of.pattern,
            entries: of.entries,
            twofold: &self.twofold[of.held as usize],
            h: iterate.h,
            w: iterate.inverse_masses().unwrap_or_default(),
            rest: &self.rest,
            x,
            from,
            dl: of.dl,
            s: iterate.s,
            stride: iterate.stride,
        });
    }

    /// Σ_i δL_i of the last iteration.
    pub(crate) fn sum(&self, of: Iteration<'_, T>, sides: usize, iterate: &Iterate<T>) {
        iterate.set.run(&mut Sums {
            h: iterate.h,
            w: iterate.inverse_masses().unwrap_or_default(),
            dl: of.dl,
            kappa: &self.kappa[of.held as usize],
            drift: &self.drift,
            sums: of.sums,
            sides,
        });
    }
}

/// h b w r_p, and its sum over the stages.
struct Drift<'a, T> {
    hb: &'a [T],
    w: &'a [T],
    r_p: &'a [T],
    dl: &'a mut [T],
    sums: &'a mut [T],
}

impl<T: Float> Kernel for Drift<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.hb.len(), self);
    }
}

impl<T: Float> Drift<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let (hb, r_p) = (self.hb.as_chunks::<N>().0, self.r_p.as_chunks::<N>().0);
        let dl = self.dl.as_chunks_mut::<N>().0;
        let rows = dl.chunks_exact_mut(groups).zip(r_p.chunks_exact(groups));
        for (((dl, r_p), sum), &w) in rows.zip(&mut *self.sums).zip(self.w) {
            let mut total = [T::int(0); N];
            for g in 0..groups {
                dl[g] = scaled(&times(&hb[g], &r_p[g]), w);
                add(&mut total, &dl[g]);
            }
            *sum = folded(&total);
        }
    }
}

/// δL_p = −h B ∇²U X_q and X_q = R + h w (K B K) δL_p, row by row.
struct Row<'a, T> {
    pattern: &'a Pattern,
    /// h b ∇²H.
    entries: &'a [T],
    twofold: &'a [T],
    h: T,
    w: &'a [T],
    rest: &'a [T],
    x: &'a mut [T],
    from: Option<&'a [T]>,
    dl: &'a mut [T],
    s: usize,
    stride: usize,
}

impl<T: Float> Kernel for Row<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.stride, self);
    }
}

impl<T: Float> Row<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let m = self.w.len();
        let sides = self.x.len() / (2 * m * self.stride);
        for row in 0..m {
            let mut side = 0;
            while side < sides {
                // With other types one side fills the registers.
                side += if const { T::IS_DOUBLE } {
                    match sides - side {
                        1 => self.block::<N, 1>((row, side), groups),
                        2 => self.block::<N, 2>((row, side), groups),
                        _ => self.block::<N, 3>((row, side), groups),
                    }
                } else {
                    self.block::<N, 1>((row, side), groups)
                };
            }
        }
    }

    /// One row of S sides. Returns S.
    #[inline(always)]
    fn block<const N: usize, const S: usize>(
        &mut self,
        (row, side): (usize, usize),
        groups: usize,
    ) -> usize {
        let m = self.w.len();
        let dl = self.dl.as_chunks_mut::<N>().0;
        for g in 0..groups {
            let x = self.from.unwrap_or(self.x);
            let at = (side, groups, g);
            let sums = row_times::<T, N, S>(self.pattern, self.entries, (row, m), x, at);
            for (k, sum) in sums.iter().enumerate() {
                dl[((side + k) * 2 * m + m + row) * groups + g] = scaled(sum, -T::int(1));
            }
        }
        let by = self.h * self.w[row];
        let (twofold, rest) = (
            self.twofold.as_chunks::<N>().0,
            self.rest.as_chunks::<N>().0,
        );
        let x = self.x.as_chunks_mut::<N>().0;
        for side in side..side + S {
            let dl = &dl[(side * 2 * m + m + row) * groups..][..groups];
            for g in 0..groups {
                let moved = product_any(twofold, dl, g, self.s);
                let rest = &rest[(side * m + row) * groups + g];
                x[(side * 2 * m + row) * groups + g] = fused(&moved, by, rest);
            }
        }
        S
    }
}

/// Σ_i δL_i.
struct Sums<'a, T> {
    h: T,
    w: &'a [T],
    dl: &'a [T],
    kappa: &'a [T],
    drift: &'a [T],
    sums: &'a mut [T],
    sides: usize,
}

impl<T: Float> Kernel for Sums<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.kappa.len(), self);
    }
}

impl<T: Float> Sums<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let m = self.w.len();
        let (kappa, dl) = (self.kappa.as_chunks::<N>().0, self.dl.as_chunks::<N>().0);
        let sides = self
            .sums
            .chunks_exact_mut(2 * m)
            .zip(self.drift.chunks_exact(m));
        for (side, (sums, drift)) in sides.enumerate().take(self.sides) {
            let (by_q, by_p) = sums.split_at_mut(m);
            let dl = dl[(side * 2 + 1) * m * groups..].chunks_exact(groups);
            for (c, dl) in dl.enumerate().take(m) {
                let (mut moved, mut pushed) = (times(&kappa[0], &dl[0]), dl[0]);
                for g in 1..groups {
                    moved = fused_each(&kappa[g], &dl[g], &moved);
                    add(&mut pushed, &dl[g]);
                }
                by_q[c] = drift[c] + self.h * self.w[c] * folded(&moved);
                by_p[c] = folded(&pushed);
            }
        }
    }
}

/// The sum of all lanes, by halving.
#[inline(always)]
fn folded<T: Float, const N: usize>(lanes: &[T; N]) -> T {
    let fours = lanes.as_chunks::<4>().0;
    let four = match fours {
        [a, b] => (T::Pack::<4>::of(a) + T::Pack::<4>::of(b)).numbers(),
        [a] => *a,
        _ => return lanes[0],
    };
    let [a, b, c, d] = four;
    let two = T::Pack::<2>::of(&[a, b]) + T::Pack::<2>::of(&[c, d]);
    let [a, b] = two.numbers();
    a + b
}
