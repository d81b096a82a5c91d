//! The β-chain of Fermi, Pasta, Ulam and Tsingou.
//!
//! H = Σ_{i=1}^{n} ½p_i² + Σ_{i=0}^{n} [½d_i² + ¼β d_i⁴], d_i = q_{i+1} − q_i, q_0 = q_{n+1} = 0, [Fermi,
//! Pasta, Ulam, Tsingou, Los Alamos LA-1940, 1955]. Start in the first mode, q_i = A sin(πi/(n + 1)), at
//! rest. With β = 0 that mode swings with ω₁ = 2 sin(π/(2n + 2)) forever.

use crate::entry::scene;
use crate::model::{Model, State, View, scaled};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// n masses between fixed ends, springs d + βd³.
    pub struct FputBeta {
        n: usize = "32" in closed(1.0, 4096.0), "number of masses";
        beta: Constant = "0.3" in closed(0.0, 1e3), "strength of the cubic force";
        amplitude: Constant = "10" in closed(-1e3, 1e3), "amplitude of the first mode";
    }
    name: "fput-beta",
    title: "FPUT-β chain",
    formula: "H = sum p_i^2/2 + sum [d_i^2/2 + beta d_i^4/4], d_i = q_{i+1} - q_i, fixed ends",
    source: "Fermi, Pasta, Ulam, Tsingou, Studies of nonlinear problems, Los Alamos LA-1940 (1955)",
    invariants: "none besides H",
    solution: "closed form when beta = 0",
    hard: "size: sparse H, cost must grow like n; beta A^2/n^2 above 1 is strongly chaotic",
    units: "",
    period: "of the first mode of the linear chain",
}

impl FputBeta {
    fn is_linear(&self) -> bool {
        self.beta.to::<f64>() == 0.0
    }

    fn lowest_frequency<T: Float>(&self) -> T {
        let n = T::int(self.n as i64 + 1);
        T::int(2) * (T::frac_pi_2() / n).sin()
    }
}

impl Model for FputBeta {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let kinetic: Var = p.iter().map(|&p| p * p).sum();
        let inner = q.windows(2).map(|pair| pair[1] - pair[0]);
        let stretches: Vec<_> = inner.chain([q[0], q[self.n - 1]]).collect();
        let linear: Var = stretches.iter().map(|&d| d * d).sum();
        let quadratic = 0.5 * kinetic + 0.5 * linear;
        if self.is_linear() {
            return quadratic;
        }
        let quartic: Var = stretches.iter().map(|&d| d.powi(4)).sum();
        quadratic + 0.25 * (self.beta * quartic)
    }

    fn initial<T: Float>(&self) -> State<T> {
        let angle = T::pi() / T::int(self.n as i64 + 1);
        let amplitude = self.amplitude.to::<T>();
        let q = (1..=self.n)
            .map(|i| amplitude * (angle * T::int(i as i64)).sin())
            .collect();
        (q, vec![T::int(0); self.n])
    }

    /// That of the first mode of the linear chain.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / self.lowest_frequency::<T>()
    }

    fn step(&self) -> f64 {
        0.2
    }

    fn view(&self) -> View {
        View::row(self.n)
    }

    fn exact<T: Float>(&self, t: T) -> Option<State<T>> {
        let (q, _) = self.initial::<T>();
        let omega = self.lowest_frequency::<T>();
        let (sin, cos) = (omega * t).sin_cos();
        self.is_linear().then(|| scaled(&q, cos, -omega * sin))
    }
}
