//! Fermi, Pasta and Ulam's chain with alternating soft nonlinear and stiff linear springs.
//!
//! [Hairer, Lubich, Wanner, I.5, (5.3)]: slow x_{0,i} and fast x_{1,i}, i = 1..m, in q = (x₀, x₁) and p =
//! (y₀, y₁),
//!
//! H = ½ Σ (y_{0,i}² + y_{1,i}²) + ½ω² Σ x_{1,i}²
//!   + ¼[(x_{0,1} − x_{1,1})⁴ + Σ_{i<m} (x_{0,i+1} − x_{1,i+1} − x_{0,i} − x_{1,i})⁴ + (x_{0,m} + x_{1,m})⁴].
//!
//! Start: x_{0,1} = y_{0,1} = y_{1,1} = 1, x_{1,1} = 1/ω, zero for the rest.

use crate::entry::scene;
use crate::model::{Model, State, View};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// m stiff springs of frequency ω between soft ones.
    pub struct Fpu {
        m: usize = "3" in closed(1.0, 100.0), "number of stiff springs";
        omega: Constant = "50" in closed(1.0, 1e6), "frequency of the stiff springs";
    }
    name: "fpu",
    title: "Modified FPU problem with stiff springs (HLW I.5)",
    formula: "H = sum (y0_i^2 + y1_i^2)/2 + w^2/2 sum x1_i^2 + [(x0_1 - x1_1)^4 + sum (x0_{i+1} - x1_{i+1} - x0_i - x1_i)^4 + (x0_m + x1_m)^4]/4",
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.5",
    invariants: "none besides H; the oscillatory energy I = sum (y1_i^2 + w^2 x1_i^2)/2 is kept up to O(1/w) only",
    solution: "reference fpu_hlw (m = 3, omega = 50, t = 200)",
    hard: "h omega >> 1: h = 1 with omega = 500 steps over 80 fast periods",
    units: "",
    period: "of the stiff springs",
}

impl Model for Fpu {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let (slow, fast) = q.split_at(self.m);
        let omega = Var::from(self.omega);
        let kinetic: Var = p.iter().map(|&y| y * y).sum();
        let stiff: Var = fast.iter().map(|&x| x * x).sum();
        let mut soft = (slow[0] - fast[0]).powi(4) + (slow[self.m - 1] + fast[self.m - 1]).powi(4);
        for i in 1..self.m {
            soft += (slow[i] - fast[i] - slow[i - 1] - fast[i - 1]).powi(4);
        }
        0.5 * kinetic + 0.5 * (omega * omega * stiff) + 0.25 * soft
    }

    fn initial<T: Float>(&self) -> State<T> {
        let mut q = vec![T::int(0); 2 * self.m];
        let mut p = q.clone();
        q[0] = T::int(1);
        q[self.m] = self.omega.to::<T>().recip();
        p[0] = T::int(1);
        p[self.m] = T::int(1);
        (q, p)
    }

    /// That of the stiff springs.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / self.omega.to::<T>()
    }

    fn step(&self) -> f64 {
        1.0 / self.omega.to::<f64>()
    }

    fn end(&self) -> f64 {
        200.0
    }

    fn view(&self) -> View {
        View::Profile
    }
}
