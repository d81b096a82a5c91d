//! The systems with their derivatives written by hand, as every peer that takes them is given them.

use equip::autodiff::BuildError;
use equip::scalar::Float;
use equip::prelude::*;
use equip::scenes::energies::{
    Fpu, FputBeta, HenonHeiles, Kepler, Model, OuterSolarSystem, Pythagorean, SpringPendulum,
};

/// An energy Σ p²/(2m) + U(q) with its derivatives written by hand, in any float type.
pub trait Problem: Model + Clone + Send + Sync + 'static {
    /// p' = −∇U at q.
    fn force<T: Float>(&self, q: &[T], force: &mut [T]);

    /// q' = p/m.
    #[inline(always)]
    fn velocity<T: Float>(&self, p: &[T], velocity: &mut [T]) {
        velocity.copy_from_slice(p);
    }

    /// q += by · p/m.
    #[inline(always)]
    fn drift<T: Float>(&self, q: &mut [T], p: &[T], by: T) {
        q.iter_mut().zip(p).for_each(|(q, &p)| *q += by * p);
    }

    /// (q', p') of a state in one piece.
    #[inline(always)]
    fn slope<T: Float>(&self, y: &[T], dy: &mut [T]) {
        let m = y.len() / 2;
        let ((q, p), (velocity, force)) = (y.split_at(m), dy.split_at_mut(m));
        self.velocity(p, velocity);
        self.force(q, force);
    }

    /// H with its gradient by hand, as `Hamiltonian::with_gradient` takes it, for doubles.
    ///
    /// # Errors
    /// As [`Model::hamiltonian`].
    fn with_gradient_by_hand(&self) -> Result<Hamiltonian, BuildError> {
        let problem = self.clone();
        Ok(self.hamiltonian()?.with_gradient(move |q, p, dq, dp| {
            problem.velocity(p, dp);
            problem.force(q, dq);
            dq.iter_mut().for_each(|x| *x = -*x);
        }))
    }
}

impl Problem for Kepler {
    #[inline(always)]
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
        let r2 = q[0] * q[0] + q[1] * q[1];
        let pull = T::int(-1) / (r2 * r2.sqrt());
        (force[0], force[1]) = (pull * q[0], pull * q[1]);
    }
}

impl Problem for HenonHeiles {
    #[inline(always)]
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
        let product = q[0] * q[1];
        force[0] = -q[0] - (product + product);
        force[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
    }
}

impl Problem for SpringPendulum {
    #[inline(always)]
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
        let r = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let pull = self.k.to::<T>() * (r - T::int(1)) / r;
        force[0] = -pull * q[0];
        force[1] = -pull * q[1] - self.g.to::<T>();
    }
}

impl Problem for Fpu {
    #[inline(always)]
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
        let m = self.m;
        let (slow, fast) = q.split_at(m);
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
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
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

/// Masses of the Pythagorean problem, in the order of its bodies.
const PYTHAGOREAN: [i32; 3] = [5, 4, 3];

/// The mass that goes with a component of the Pythagorean problem.
pub fn pythagorean_mass(component: usize) -> f64 {
    f64::from(PYTHAGOREAN[component / 2])
}

impl Problem for Pythagorean {
    #[inline(always)]
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
        force.fill(T::int(0));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
            let r2 = x * x + y * y;
            let product = T::int(i64::from(PYTHAGOREAN[i] * PYTHAGOREAN[j]));
            let pull = product / (r2 * r2.sqrt());
            for (k, d) in [x, y].into_iter().enumerate() {
                force[2 * i + k] -= pull * d;
                force[2 * j + k] += pull * d;
            }
        }
    }

    #[inline(always)]
    fn velocity<T: Float>(&self, p: &[T], velocity: &mut [T]) {
        for (k, (v, &p)) in velocity.iter_mut().zip(p).enumerate() {
            *v = p * T::ratio(1, i64::from(PYTHAGOREAN[k / 2]));
        }
    }

    #[inline(always)]
    fn drift<T: Float>(&self, q: &mut [T], p: &[T], by: T) {
        for (k, (q, &p)) in q.iter_mut().zip(p).enumerate() {
            *q += by * (p * T::ratio(1, i64::from(PYTHAGOREAN[k / 2])));
        }
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

/// 1/m that goes with a component of the outer solar system.
#[inline(always)]
fn outer_inverse_mass<T: Float>(component: usize) -> T {
    T::exact(G) / T::exact(GM[component / 3])
}

impl Problem for OuterSolarSystem {
    #[inline(always)]
    fn force<T: Float>(&self, q: &[T], force: &mut [T]) {
        force.fill(T::int(0));
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

    #[inline(always)]
    fn velocity<T: Float>(&self, p: &[T], velocity: &mut [T]) {
        for (k, (v, &p)) in velocity.iter_mut().zip(p).enumerate() {
            *v = p * outer_inverse_mass(k);
        }
    }

    #[inline(always)]
    fn drift<T: Float>(&self, q: &mut [T], p: &[T], by: T) {
        for (k, (q, &p)) in q.iter_mut().zip(p).enumerate() {
            *q += by * (p * outer_inverse_mass(k));
        }
    }
}
