//! The discrete nonlinear Schrödinger equation on a ring.
//!
//! With ψ_j = (q_j + i p_j)/√2: i ψ̇_j = −(ψ_{j+1} − 2ψ_j + ψ_{j−1}) − γ|ψ_j|²ψ_j comes from, [Kevrekidis,
//! The Discrete Nonlinear Schrödinger Equation, 2009, 1.1],
//!
//! H = ½ Σ [(q_{j+1} − q_j)² + (p_{j+1} − p_j)²] − (γ/8) Σ (q_j² + p_j²)².
//!
//! The norm ½ Σ (q_j² + p_j²) is kept. Start q_j = A(1 + δ cos(2πj/n)), p = 0; with δ = 0 the ring turns as
//! one, q_j + i p_j = A e^{iγA²t/2}.

use crate::entry::scene;
use crate::invariant::{Invariant, InvariantKind};
use crate::model::{Model, State, View, period_of, scaled};
use equip_autodiff::{BuildError, Var};
use equip_scalar::{Constant, Float, Num, ratio};

scene! {
    /// ½ Σ |Δψ|² − (γ/8) Σ |ψ|⁴ on a ring, with ψ = q + ip.
    pub struct Dnls {
        n: usize = "16" in closed(1.0, 4096.0), "number of sites";
        gamma: Constant = "1" in closed(-1e3, 1e3), "nonlinearity, positive for focusing";
        amplitude: Constant = "1" in above(0.0, 100.0), "amplitude of the start";
        modulation: Constant = "0.1" in closed(-1.0, 1.0), "relative modulation of the start";
    }
    name: "dnls",
    title: "Discrete nonlinear Schrödinger ring",
    formula: "H = sum [(q_{j+1} - q_j)^2 + (p_{j+1} - p_j)^2]/2 - gamma/8 sum (q_j^2 + p_j^2)^2",
    source: "Kevrekidis, The Discrete Nonlinear Schrödinger Equation, Springer (2009)",
    invariants: "norm sum (q_j^2 + p_j^2)/2 (quadratic)",
    solution: "closed form when modulation = 0",
    hard: "not separable; gamma amplitude^2 > 4 sin^2(pi/n) makes the uniform state unstable",
    units: "",
    period: "of the uniform state",
}

impl Dnls {
    fn is_uniform(&self) -> bool {
        self.modulation.to::<f64>() == 0.0
    }

    /// γA²/2.
    fn turning<T: Float>(&self) -> T {
        let amplitude = self.amplitude.to::<T>();
        self.gamma.to::<T>() * amplitude * amplitude * T::ratio(1, 2)
    }
}

impl Model for Dnls {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let hop = |j: usize| {
            let (dq, dp) = (q[(j + 1) % self.n] - q[j], p[(j + 1) % self.n] - p[j]);
            dq * dq + dp * dp
        };
        let square = |j: usize| (q[j] * q[j] + p[j] * p[j]).powi(2);
        let hopping: Var = (0..self.n).map(hop).sum();
        let local: Var = (0..self.n).map(square).sum();
        0.5 * hopping - ratio(1, 8) * (self.gamma * local)
    }

    fn initial<T: Float>(&self) -> State<T> {
        let (amplitude, modulation) = (self.amplitude.to::<T>(), self.modulation.to::<T>());
        let angle = T::two_pi() / T::int(self.n as i64);
        let wave = |j: usize| (angle * T::int(j as i64)).cos();
        let q = (0..self.n)
            .map(|j| amplitude * (T::int(1) + modulation * wave(j)))
            .collect();
        (q, vec![T::int(0); self.n])
    }

    /// One turn of the uniform state; 2π if it stands still.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        period_of(self.turning())
    }

    fn step(&self) -> f64 {
        0.5 / (2.0 + self.turning::<f64>().abs())
    }

    fn view(&self) -> View {
        View::row(self.n)
    }

    fn invariants(&self) -> Result<Vec<Invariant>, BuildError> {
        let norm = Invariant::record("norm", InvariantKind::Quadratic, self.n, |q, p| {
            let twice: Num<_> = q.iter().zip(p).map(|(&q, &p)| q * q + p * p).sum();
            0.5 * twice
        })?;
        Ok(vec![norm])
    }

    fn exact<T: Float>(&self, t: T) -> Option<State<T>> {
        let (q, _) = self.initial::<T>();
        let (sin, cos) = (self.turning::<T>() * t).sin_cos();
        self.is_uniform().then(|| scaled(&q, cos, sin))
    }
}
