//! L of stiff components, from Z, if the stage equations are linear.
//!
//! L = h b J∇H(Y) amplifies the rounding errors of Y by about hω, the phase per step. The linear equation
//! Z = K(α) L does not: K⁻¹ has a norm of 5 (s = 2) to 33 (s = 32). It is used for the same reason in
//! E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", section IV.8 (docs/adr/0034).
//!
//! A preconditioned iteration computes ΔZ = M⁻¹ r, with r = K L − Z. Of the new Z + ΔZ
//!
//! $$ L + \delta L, \qquad \delta L = K^{-1} (\Delta Z - r), $$
//!
//! satisfies the linear equation. If the positions alone are unknowns, h b M⁻¹ δP = δL_q and K δL_p = δP.
//! The correction is rounding itself where it is below ε ‖K⁻¹‖ |Z|, and is then left out. If the equations
//! are not linear, M⁻¹ does not damp the rounding of r in every direction, and L of the stages is more
//! accurate.

use crate::iterate::iterate::Iterate;
use crate::layout::row::{add, by_groups, stride_for};
use crate::matrix::inverse::InverseK;
use crate::matrix::product::product_any;
use equip_autodiff::Kinetic;
use equip_scalar::{Float, Kernel};

impl<T: Float> Iterate<T> {
    /// Corrects L of the last preconditioned iteration.
    pub(crate) fn correct_increments(&mut self) {
        let Some(inverse) = &self.inverse_k else {
            return;
        };
        let unknowns = self.unknowns();
        let (l, l_p) = self.l.split_at_mut(unknowns * self.stride);
        self.set.run(&mut Correct {
            inverse,
            z: &self.z,
            z_before: &mut self.z_before,
            residual: &mut self.delta,
            l,
            l_p,
            inverse_masses: self.kinetic.as_ref().and_then(Kinetic::diagonal),
            hb: &self.hb,
            s: self.s,
        });
    }
}

struct Correct<'a, T> {
    inverse: &'a InverseK<T>,
    /// Z + ΔZ, Z and r.
    z: &'a [T],
    z_before: &'a mut [T],
    residual: &'a mut [T],
    /// L of the unknown components, and of the momenta if they are not among them.
    l: &'a mut [T],
    l_p: &'a mut [T],
    inverse_masses: Option<&'a [T]>,
    hb: &'a [T],
    s: usize,
}

impl<T: Float> Kernel for Correct<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.s, self)
    }
}

impl<T: Float> Correct<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let (s, row) = (self.s, groups * N);
        let inverse = self.inverse.columns.as_chunks::<N>().0;
        for c in 0..self.l.len() / row {
            let at = c * row..(c + 1) * row;
            let z = &self.z[at.clone()];
            let residual = &mut self.residual[at.clone()];
            let correction = &mut self.z_before[at.clone()];
            for ((r, &z), &before) in residual.iter_mut().zip(z).zip(&*correction) {
                *r = (z - before) - *r;
            }
            let largest = |row: &[T]| row.iter().fold(T::int(0), |most, x| most.max(x.abs()));
            let rounding = T::EPSILON * self.inverse.norm * largest(z);
            let (residual, _) = residual.as_chunks_mut::<N>();
            let (correction, _) = correction.as_chunks_mut::<N>();
            for (g, correction) in correction.iter_mut().enumerate() {
                *correction = product_any(inverse, residual, g, s);
            }
            if !(largest(correction.as_flattened()) > rounding) {
                continue;
            }
            let l = self.l[at.clone()].as_chunks_mut::<N>().0;
            for (l, correction) in l.iter_mut().zip(&*correction) {
                add(l, correction);
            }
            let Some(&w) = self.inverse_masses.and_then(|masses| masses.get(c)) else {
                continue;
            };
            let change = correction.as_flattened()[..s].iter().zip(self.hb);
            for (change_of_p, (&change, &hb)) in residual.as_flattened_mut().iter_mut().zip(change)
            {
                *change_of_p = change / (hb * w);
            }
            let l_p = self.l_p[at].as_chunks_mut::<N>().0;
            for (g, l) in l_p.iter_mut().enumerate() {
                add(l, &product_any(inverse, residual, g, s));
            }
        }
    }
}
