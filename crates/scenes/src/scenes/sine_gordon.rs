//! The sine-Gordon equation on a ring of grid points.
//!
//! u_tt = u_xx − sin u on [−L/2, L/2] with n points Δ apart, H divided by Δ:
//!
//! H = Σ [½p_j² + (q_{j+1} − q_j)²/(2Δ²) + 1 − cos q_j].
//!
//! Start: the breather of the continuous equation at its greatest height, [Drazin, Johnson, Solitons, 1989],
//! q_j = 4 atan(√(1 − ω²)/(ω cosh(√(1 − ω²) x_j))), at rest.

use crate::entry::scene;
use crate::model::{Model, State, View};
use equip_autodiff::Var;
use equip_scalar::{Constant, Float};

scene! {
    /// Σ [½p² + (Δq)²/(2Δ²) + 1 − cos q] on a ring.
    pub struct SineGordon {
        n: usize = "64" in closed(2.0, 4096.0), "number of grid points";
        length: Constant = "40" in closed(1.0, 1e3), "length of the ring";
        omega: Constant = "0.6" in open(0.0, 1.0), "frequency of the breather";
    }
    name: "sine-gordon",
    title: "Sine-Gordon breather on a grid",
    formula: "H = sum [p_j^2/2 + (q_{j+1} - q_j)^2/(2 D^2) + 1 - cos q_j], D = length/n, ring",
    source: "Drazin, Johnson, Solitons: an introduction, Cambridge (1989); second differences in space",
    invariants: "none besides H (the grid breaks the momentum)",
    solution: "none stored; the continuous breather has period 2 pi/omega",
    hard: "fine grids: fastest frequency 2 n/length, so n = 4096 on length 10 has 819; omega -> 0 is nearly a pair of kinks",
    units: "",
    period: "of the continuous breather",
}

impl Model for SineGordon {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let density = Var::from(self.n as f64) / self.length;
        let kinetic: Var = p.iter().map(|&p| p * p).sum();
        let neighbours = q.iter().cycle().skip(1).zip(q);
        let stretch: Var = neighbours.map(|(&next, &q)| (next - q) * (next - q)).sum();
        let local: Var = q.iter().map(|&q| 1.0 - q.cos()).sum();
        0.5 * kinetic + 0.5 * (density * density * stretch) + local
    }

    fn initial<T: Float>(&self) -> State<T> {
        let omega = self.omega.to::<T>();
        let root = ((T::int(1) - omega) * (T::int(1) + omega)).sqrt();
        let half = T::ratio(1, 2);
        let n = T::int(self.n as i64);
        let breather = |j: usize| {
            let x = (T::int(j as i64) / n - half) * self.length.to::<T>();
            T::int(4) * (root / (omega * (root * x).cosh())).atan()
        };
        ((0..self.n).map(breather).collect(), vec![T::int(0); self.n])
    }

    /// That of the continuous breather.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::two_pi() / self.omega.to::<T>()
    }

    fn step(&self) -> f64 {
        self.length.to::<f64>() / (4.0 * self.n as f64)
    }

    fn view(&self) -> View {
        View::Profile
    }
}
