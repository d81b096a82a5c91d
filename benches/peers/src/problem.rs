//! The systems with their derivatives written by hand, as every peer that takes them is given them.

use equip::prelude::*;
use equip::scenes::energies::{
    Fpu, FputBeta, HenonHeiles, Kepler, OuterSolarSystem, SpringPendulum,
};

/// An energy with y' = (∂H/∂p, −∂H/∂q) written by hand, in any float type.
pub trait Problem: Energy + Clone + 'static {
    /// q' and p' at (q, p).
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]);

    /// The same for states in one piece.
    #[inline(always)]
    fn slope<T: Float>(&self, y: &[T], dy: &mut [T]) {
        let m = y.len() / 2;
        let ((q, p), (velocity, force)) = (y.split_at(m), dy.split_at_mut(m));
        self.derivative(q, p, velocity, force);
    }
}

impl Problem for Kepler {
    #[inline(always)]
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]) {
        let r2 = q[0] * q[0] + q[1] * q[1];
        let pull = T::int(-1) / (r2 * r2.sqrt());
        velocity.copy_from_slice(p);
        (force[0], force[1]) = (pull * q[0], pull * q[1]);
    }
}

impl Problem for HenonHeiles {
    #[inline(always)]
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]) {
        velocity.copy_from_slice(p);
        let product = q[0] * q[1];
        force[0] = -q[0] - (product + product);
        force[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
    }
}

impl Problem for SpringPendulum {
    #[inline(always)]
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]) {
        let r = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let pull = self.k.to::<T>() * (r - T::int(1)) / r;
        velocity.copy_from_slice(p);
        force[0] = -pull * q[0];
        force[1] = -pull * q[1] - self.g.to::<T>();
    }
}

impl Problem for Fpu {
    #[inline(always)]
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]) {
        let m = self.m;
        let (slow, fast) = q.split_at(m);
        velocity.copy_from_slice(p);
        let omega = self.omega.to::<T>();
        let stiffness = omega * omega;
        for i in 0..m {
            force[i] = T::int(0);
            force[m + i] = -stiffness * fast[i];
        }
        let cube = |d: T| d * d * d;
        let first = cube(slow[0] - fast[0]);
        force[0] -= first;
        force[m] += first;
        for i in 1..m {
            let f = cube(slow[i] - fast[i] - slow[i - 1] - fast[i - 1]);
            force[i] -= f;
            force[m + i] += f;
            force[i - 1] += f;
            force[m + i - 1] += f;
        }
        let last = cube(slow[m - 1] + fast[m - 1]);
        force[m - 1] -= last;
        force[2 * m - 1] -= last;
    }
}

impl Problem for FputBeta {
    #[inline(always)]
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]) {
        velocity.copy_from_slice(p);
        let beta = self.beta.to::<T>();
        let spring = |d: T| d + beta * (d * d * d);
        let mut left = spring(q[0]);
        for (f, pair) in force.iter_mut().zip(q.windows(2)) {
            let right = spring(pair[1] - pair[0]);
            *f = right - left;
            left = right;
        }
        let last = self.n - 1;
        force[last] = spring(-q[last]) - left;
    }
}

/// G of the outer solar system.
const G: f64 = 0.000295912208286;
/// G m of its bodies: the doubles of the scene.
pub const GM: [f64; 6] = [
    0.00029591397690000476,
    2.825328644881507e-07,
    8.450771312727215e-08,
    1.293944677450143e-08,
    1.532112500187004e-08,
    2.276247756046154e-12,
];

/// The mass that goes with a component of the outer solar system.
#[inline(always)]
pub fn outer_mass<T: Float>(component: usize) -> T {
    T::exact(GM[component / 3]) / T::exact(G)
}

impl Problem for OuterSolarSystem {
    #[inline(always)]
    fn derivative<T: Float>(&self, q: &[T], p: &[T], velocity: &mut [T], force: &mut [T]) {
        for k in 0..3 * GM.len() {
            velocity[k] = p[k] / outer_mass(k);
            force[k] = T::int(0);
        }
        for i in 0..GM.len() {
            for j in 0..i {
                let d = [0, 1, 2].map(|k| q[3 * i + k] - q[3 * j + k]);
                let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                // G m_i m_j / r³
                let pull = T::exact(GM[i]) * outer_mass::<T>(3 * j) / (r2 * r2.sqrt());
                for (k, &d) in d.iter().enumerate() {
                    force[3 * i + k] -= pull * d;
                    force[3 * j + k] += pull * d;
                }
            }
        }
    }
}

/// A problem whose hand-written derivative is its gradient: the third way to give H, beside closure and trait.
#[derive(Debug, Clone)]
pub struct ByHand<P>(pub P);

impl<P: Problem> Energy for ByHand<P> {
    fn degrees_of_freedom(&self) -> usize {
        self.0.degrees_of_freedom()
    }

    #[inline(always)]
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        self.0.energy(q, p)
    }

    #[inline(always)]
    fn gradient<T: Float>(&self, q: &[T], p: &[T], dq: &mut [T], dp: &mut [T]) -> bool {
        self.0.derivative(q, p, dp, dq);
        dq.iter_mut().for_each(|x| *x = -*x);
        true
    }
}
