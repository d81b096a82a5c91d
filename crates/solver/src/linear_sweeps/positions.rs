//! For H = T(p) + U(q), T = ½ Σ w_c p_c² + b·p: the momenta put in, the positions are what is solved for,
//!
//! $$ X_q = R + h w\, (K B K)\, \delta L_p, \qquad R = r_q + K h B w\, r_p, \qquad \delta L_p = -h B\, \nabla^2 U\, X_q , $$
//!
//! and with the other end held K − 1 1ᵀ in place of K. At the end Σ δL_q = h w (Σ b r_p + κ·δL_p), κ = Kᵀ b.
//!
//! Cost: a sweep of one side nnz(∇²U)·s + m s² products.

use super::{Held, LinearSweeps, Plus};
use crate::row::{add, by_groups, fused, fused_each, scaled, stride_for, times};
use crate::sweep::Iterate;
use crate::twice;
use equip_autodiff::Kinetic;
use equip_scalar::{Float, InstructionSet, Kernel, Pack, mix_stages};
use equip_tableau::Gauss;

/// For each end that may be held, and each row of X_q.
#[derive(Debug)]
pub(super) struct Positions<T> {
    /// K B K, column by column.
    twice: [Vec<T>; 2],
    /// κ.
    kappa: [Vec<T>; 2],
    /// R.
    rest: Vec<T>,
    /// Σ h b w r_p.
    drift: Vec<T>,
}

impl<T: Float> Positions<T> {
    /// For so many `rows`, `k` being K for each end.
    pub(super) fn new(gauss: &Gauss<T>, k: &[Vec<T>; 2], rows: usize) -> Self {
        let stride = stride_for::<T>(gauss.stages());
        let twice = |k: &Vec<T>| {
            let mut twice = vec![T::int(0); stride * stride];
            twice::add_product(InstructionSet::best(), k, gauss, &mut twice);
            twice
        };
        let kappa = |k: &Vec<T>| {
            let columns = k.chunks_exact(stride);
            let weighed = columns.map(|column| {
                let pairs = column.iter().zip(gauss.weights());
                pairs.fold(T::int(0), |sum, (&k, &b)| sum + k * b)
            });
            weighed.collect()
        };
        Positions {
            twice: k.each_ref().map(twice),
            kappa: k.each_ref().map(kappa),
            rest: vec![T::int(0); rows * stride],
            drift: vec![T::int(0); rows],
        }
    }
}

/// M⁻¹, if T is as it is asked for.
fn inverse_masses<T: Float>(iterate: &Iterate<T>) -> &[T] {
    iterate
        .kinetic
        .as_ref()
        .and_then(Kinetic::diagonal)
        .unwrap_or_default()
}

impl<T: Float> LinearSweeps<T> {
    /// R, and X as it is before the forces change.
    pub(super) fn begin_positions(
        &mut self,
        held: Held,
        r: &[T],
        x: &mut [T],
        iterate: &Iterate<T>,
    ) {
        let Some(positions) = &mut self.positions else {
            return;
        };
        let (r_q, r_p) = r.split_at(r.len() / 2);
        let dl = &mut self.dl[..r_p.len()];
        let mixed = &mut self.mixed[..r_p.len()];
        let rest = &mut positions.rest[..r_q.len()];
        self.set.run(&mut Drift {
            hb: &iterate.hb,
            w: inverse_masses(iterate),
            r_p,
            dl,
            sums: &mut positions.drift,
        });
        let k = &self.k[held as usize];
        mix_stages(self.set, k, dl, mixed, self.s, self.stride);
        self.set.run(&mut Plus {
            x: rest,
            r: r_q,
            z: mixed,
        });
        x[..rest.len()].copy_from_slice(rest);
    }

    pub(super) fn sweep_positions(&mut self, held: Held, x: &mut [T], iterate: &Iterate<T>) {
        let half = x.len() / 2;
        self.times((0, self.m), self.m, (x, half), (held, iterate));
        let Some(positions) = &self.positions else {
            return;
        };
        let dl = &self.dl[half..2 * half];
        let mixed = &mut self.mixed[..half];
        let twice = &positions.twice[held as usize];
        mix_stages(self.set, twice, dl, mixed, self.s, self.stride);
        self.set.run(&mut Place {
            h: iterate.h,
            w: inverse_masses(iterate),
            rest: &positions.rest,
            mixed,
            x: &mut x[..half],
            dl,
            kappa: &positions.kappa[held as usize],
            drift: &positions.drift,
            sums: &mut self.sums,
        });
    }
}

/// h b w r_p, and its sums.
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
        let sides = r_p.len() / (groups * self.w.len());
        let w = self.w.iter().flat_map(|w| std::iter::repeat_n(w, sides));
        let rows = dl.chunks_exact_mut(groups).zip(r_p.chunks_exact(groups));
        for (((dl, r_p), sum), &w) in rows.zip(&mut *self.sums).zip(w) {
            let mut total = [T::int(0); N];
            for g in 0..groups {
                dl[g] = scaled(&times(&hb[g], &r_p[g]), w);
                add(&mut total, &dl[g]);
            }
            *sum = folded(&total);
        }
    }
}

/// X_q = R + h w Z, and the sums of δL.
struct Place<'a, T> {
    h: T,
    w: &'a [T],
    rest: &'a [T],
    /// Z.
    mixed: &'a [T],
    x: &'a mut [T],
    /// Of the momenta.
    dl: &'a [T],
    kappa: &'a [T],
    drift: &'a [T],
    sums: &'a mut [T],
}

impl<T: Float> Kernel for Place<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.kappa.len(), self);
    }
}

impl<T: Float> Place<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let kappa = self.kappa.as_chunks::<N>().0;
        let (rest, mixed) = (self.rest.as_chunks::<N>().0, self.mixed.as_chunks::<N>().0);
        let (x, dl) = (self.x.as_chunks_mut::<N>().0, self.dl.as_chunks::<N>().0);
        let sides = x.len() / (groups * self.w.len());
        let (by_q, by_p) = self.sums.split_at_mut(x.len() / groups);
        let to = x.chunks_exact_mut(groups).zip(by_q.iter_mut().zip(by_p));
        let from = (rest.chunks_exact(groups).zip(mixed.chunks_exact(groups)))
            .zip(dl.chunks_exact(groups).zip(self.drift));
        let w = self.w.iter().flat_map(|w| std::iter::repeat_n(w, sides));
        for (((x, (by_q, by_p)), ((rest, mixed), (dl, &drift))), &w) in to.zip(from).zip(w) {
            let by = self.h * w;
            let (mut moved, mut pushed) = (times(&kappa[0], &dl[0]), dl[0]);
            for g in 1..groups {
                moved = fused_each(&kappa[g], &dl[g], &moved);
                add(&mut pushed, &dl[g]);
            }
            for g in 0..groups {
                x[g] = fused(&mixed[g], by, &rest[g]);
            }
            *by_q = drift + by * folded(&moved);
            *by_p = folded(&pushed);
        }
    }
}

/// The sum of all lanes, half against half.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ahead::Once;
    use crate::outcome::Counts;
    use crate::state::State;
    use equip_autodiff::{Evaluate, Hamiltonian, System};
    use equip_scalar::DoubleDouble;

    /// The sums, and X where it is made, of the whole system and of its positions alone, in doubles and wider.
    #[test]
    fn momenta_put_in_change_nothing() {
        alone_and_together::<f64>(1e-14, 1e-13);
        alone_and_together::<DoubleDouble>(1e-28, 1e-26);
    }

    fn alone_and_together<T: Float>(tolerance: f64, most: f64) {
        let energy = Hamiltonian::new(2, |q, p| {
            let r = (q[0] * q[0] + 2.0 * q[1] * q[1]).sqrt();
            0.5 * (p[0] * p[0] + 0.25 * p[1] * p[1]) + p[1] - 1.0 / r
        });
        let energy = energy.unwrap();
        let pattern = &energy.structure().hessian;
        let mut evaluator = energy.evaluator::<T>();
        let numbers = |x: [i64; 2]| x.map(|x| T::ratio(x, 10));
        let y = State::new(&numbers([10, 3]), &numbers([-2, 9]));
        for s in [2, 3, 4, 8, 11, 16, 20] {
            let (h, gauss) = (T::ratio(4, 10), Gauss::<T>::new(s).unwrap());
            let alphas = vec![T::int(0); s - 1];
            let mut iterate = Iterate::new(&gauss, 4, evaluator.kinetic(), &alphas);
            iterate.begin(&gauss, (&y, h));
            for _ in 0..30 {
                iterate.sweep(&mut evaluator, &y, false, &mut Once);
            }
            let whole = Iterate::new(&gauss, 4, None, &alphas);
            let (sides, stride) = (3, iterate.stride);
            let mut r = vec![T::int(0); 4 * sides * stride];
            for (k, row) in r.chunks_exact_mut(stride).enumerate() {
                for (i, x) in row.iter_mut().enumerate().take(s) {
                    *x = T::ratio(((7 * k + i * i) % 11) as i64 - 5, 3);
                }
            }
            let mut both = [&whole, &iterate].map(|of| {
                let mut linear = LinearSweeps::new(&gauss, of, pattern.clone(), sides);
                assert!(linear.take(&iterate, &mut evaluator, true, &mut Counts::default()));
                linear
            });
            assert!(both[0].positions.is_none() && both[1].positions.is_some());
            for held in [Held::Start, Held::End] {
                let [together, alone] = both.each_mut().map(|linear| {
                    let mut x = vec![T::int(0); r.len()];
                    let tolerance = T::exact(tolerance);
                    let weights = vec![T::int(1); 4];
                    assert!(linear.solve(held, (&r, &mut x), &weights, tolerance, &iterate));
                    x.truncate(2 * sides * stride);
                    [linear.sums.clone(), x].concat()
                });
                assert_eq!(together.len(), alone.len());
                for (a, b) in together.into_iter().zip(alone) {
                    let off = (a - b).abs().to_f64();
                    assert!(off <= most, "s = {s}, {held:?}: {off:e}");
                }
            }
        }
    }
}
