//! The stage equations linearised, solved by sweeps: how a step answers to small changes.
//!
//! With B_i = h b_i J∇²H(Y_i) a change r of the right-hand side and a change x of an end point move the
//! stages by
//!
//! $$ X = K\,\delta L + r \quad\text{(start held)}, \qquad X = r - K^T \delta L \quad\text{(end held)}, \qquad \delta L_i = B_i X_i , $$
//!
//! and the other end by Σ δL_i, K being that of α = 0. Both are iterated, momenta first, then positions; for
//! H = T(p) + U(q) the momenta are put in ([`crate::linear::positions`]). With a preconditioner M the change
//! that a sweep makes is multiplied by M⁻¹.
//!
//! *Layout.* As of the stages, with several right-hand sides: component c of side k of stage i stands at
//! `(c·sides + k)·stride + i`.
//!
//! Cost: a sweep of one side nnz·s + 2m s² products, of positions alone less than half of that. Nothing is
//! allocated.

use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::{Held, Preconditioner};
use crate::linear::positions::{Positions, Sides};
use crate::linear::stage_hessians::StageHessians;
use crate::policy::{MOST_ITERATIONS, STILL};
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::{Float, mix_stages};
use equip_tableau::Gauss;

/// ∇²H at all stages, and what is solved with it.
#[derive(Debug)]
pub struct LinearSweeps<T: Float> {
    hessians: StageHessians<T>,
    /// K and −Kᵀ, column by column: for each end that may be held.
    k: [Vec<T>; 2],
    /// K δL, and δL.
    mixed: Vec<T>,
    dl: Vec<T>,
    /// X before a sweep.
    before: Vec<T>,
    /// Σ_i δL_i: component c of side k at `c·sides + k`; and of the sweep before.
    sums: Vec<T>,
    sums_before: Vec<T>,
    /// What sweeps of positions alone need, if there are any.
    positions: Option<Positions<T>>,
}

impl<T: Float> LinearSweeps<T> {
    /// With the K that a step starts from, for `sides` right-hand sides at most.
    pub fn new(gauss: &Gauss<T>, iterate: &Iterate<T>, pattern: Pattern, sides: usize) -> Self {
        let (n, stride) = (iterate.n, iterate.stride);
        let zeros = |len: usize| vec![T::int(0); len];
        let k = iterate.k_start.to_vec();
        let mut back = zeros(k.len());
        for (at, back) in back.iter_mut().enumerate() {
            *back = -k[at % stride * stride + at / stride];
        }
        let k = [k, back];
        let rows = n / 2 * sides;
        let len = n * sides * stride;
        LinearSweeps {
            hessians: StageHessians::new(iterate, pattern),
            positions: iterate
                .is_twofold()
                .then(|| Positions::new(gauss, &k, rows)),
            k,
            mixed: zeros(len),
            dl: zeros(len),
            before: zeros(len),
            sums: zeros(n * sides),
            sums_before: zeros(n * sides),
        }
    }

    /// Takes ∇²H at the stages of an iterate that has converged, all of which are there: s Hessians. Returns
    /// whether it is finite.
    pub fn linearise<E: Evaluate<T>>(&mut self, iterate: &Iterate<T>, energy: &mut E) -> bool {
        self.hessians.take(iterate, energy)
    }

    /// Whether the fastest motion of what was linearised turns by an angle hω of at most `most`.
    pub fn is_within(&mut self, most: f64) -> bool {
        self.hessians.is_within(most)
    }

    /// From now on with this K, row by row, for an iterate with all components unknown.
    pub fn set_k(&mut self, k: &[T], (s, stride): (usize, usize)) {
        let [forward, back] = &mut self.k;
        for j in 0..s {
            for i in 0..s {
                forward[j * stride + i] = k[i * s + j];
                back[j * stride + i] = -k[j * s + i];
            }
        }
    }

    /// Whether the positions alone are unknown: the momenta of X are not made then.
    pub fn knows_momenta(&self) -> bool {
        self.positions.is_some()
    }

    /// Σ_i δL_i of side k, component c at `c·sides + k`.
    pub fn sums(&self) -> &[T] {
        &self.sums
    }

    /// Solves for all sides, from X as it is if that `is_near`, until their sums of δL, each component
    /// weighed with `weights`, change by less than `tolerance`. Returns whether they do.
    pub fn solve(
        &mut self,
        (held, is_near): (Held, bool),
        (r, x): (&[T], &mut [T]),
        (weights, tolerance): (&[T], T),
        iterate: &Iterate<T>,
        mut m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let sides = x.len() / (iterate.n * iterate.stride);
        if !is_near {
            x.copy_from_slice(r);
        }
        if self.knows_momenta() {
            self.by_positions(held, |positions, of| {
                positions.begin(of, r, iterate);
                if !is_near {
                    positions.rest_into(x);
                }
            });
        }
        for made in 0..MOST_ITERATIONS {
            std::mem::swap(&mut self.sums, &mut self.sums_before);
            let unknown = if self.knows_momenta() {
                x.len() / 2
            } else {
                x.len()
            };
            self.before[..unknown].copy_from_slice(&x[..unknown]);
            if self.knows_momenta() {
                self.by_positions(held, |positions, of| positions.sweep(of, x, iterate));
            } else {
                self.sweep(held, (r, x), iterate, m.is_some());
            }
            if let Some(m) = m.as_deref_mut() {
                let (x, before) = (&mut x[..unknown], &self.before[..unknown]);
                x.iter_mut()
                    .zip(before)
                    .for_each(|(x, &before)| *x -= before);
                m.apply(held, x, sides);
                x.iter_mut()
                    .zip(before)
                    .for_each(|(x, &before)| *x += before);
            }
            if made + 1 >= STILL {
                match self.rests(sides, weights, tolerance) {
                    Some(true) => return true,
                    Some(false) => {}
                    None => return false,
                }
            }
        }
        false
    }

    fn by_positions(&mut self, held: Held, run: impl FnOnce(&mut Positions<T>, Sides<'_, T>)) {
        if let Some(positions) = &mut self.positions {
            run(
                positions,
                Sides {
                    hessians: &self.hessians,
                    k: &self.k[held as usize],
                    held,
                    mixed: &mut self.mixed,
                    dl: &mut self.dl,
                    sums: &mut self.sums,
                },
            );
        }
    }

    /// δL_p = −h b ∂²H/∂q∂y X, then the momenta; δL_q = h b ∂²H/∂p∂y X, then the positions; or both from the
    /// same X.
    fn sweep(
        &mut self,
        held: Held,
        (r, x): (&[T], &mut [T]),
        iterate: &Iterate<T>,
        from_same: bool,
    ) {
        let (s, stride, m) = (iterate.s, iterate.stride, iterate.n / 2);
        let half = x.len() / 2;
        let sides = half / (m * stride);
        let k = &self.k[held as usize];
        for (rows, at) in [(0, half), (m, 0)] {
            let dl = &mut self.dl[at..at + half];
            let from = if from_same {
                &self.before[..2 * half]
            } else {
                &*x
            };
            self.hessians.times((rows, m), 2 * m, (from, sides), dl);
            let mixed = &mut self.mixed[at..at + half];
            mix_stages(iterate.set, k, dl, mixed, s, stride);
            for ((x, &r), &z) in x[at..].iter_mut().zip(&r[at..at + half]).zip(&*mixed) {
                *x = r + z;
            }
        }
        let rows = self.dl[..2 * half].chunks_exact(stride);
        for (sum, dl) in self.sums.iter_mut().zip(rows) {
            *sum = dl[..s].iter().fold(T::int(0), |sum, &x| sum + x);
        }
    }

    /// Whether the sums of all sides have come to rest; `None` if they are not finite.
    fn rests(&self, sides: usize, weights: &[T], tolerance: T) -> Option<bool> {
        let mut all = true;
        for k in 0..sides {
            let (mut change, mut size) = (T::int(0), T::int(0));
            for (c, &w) in weights.iter().enumerate() {
                let (new, old) = (self.sums[c * sides + k], self.sums_before[c * sides + k]);
                change += ((new - old) * w).abs();
                size += (new * w).abs();
            }
            if !size.is_finite() {
                return None;
            }
            all &= change <= tolerance * size;
        }
        Some(all)
    }
}
