//! DOP853: the explicit Runge–Kutta method of order 8 of Dormand and Prince with step size control by errors
//! of orders 5 and 3, [Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.10], without
//! dense output.
//!
//! Twelve gradients a step. Autonomous systems only: y' = J∇H(y).

use super::dop853_tableau::{A, B, B3, E5};
use super::flow::Flow;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// Stages.
const STAGES: usize = 12;
/// Steps after which the method gives up.
const MOST_STEPS: u64 = 2_000_000;

/// Coefficients in the float type of the run, zeros left out.
#[derive(Debug, Clone)]
struct Tableau<T> {
    a: Vec<Vec<(usize, T)>>,
    b: Vec<(usize, T)>,
    e5: Vec<(usize, T)>,
    e3: Vec<(usize, T)>,
}

impl<T: Float> Tableau<T> {
    fn new() -> Self {
        let read = |&(j, text): &(usize, &str)| (j, T::decimal(text).unwrap_or(T::NAN));
        let row = |row: &[(usize, &str)]| row.iter().map(read).collect::<Vec<_>>();
        let mut e3 = row(&B);
        for (j, b3) in row(&B3) {
            e3.iter_mut()
                .filter(|(k, _)| *k == j)
                .for_each(|(_, e)| *e -= b3);
        }
        Tableau {
            a: A.iter().map(|&r| row(r)).collect(),
            b: row(&B),
            e5: row(&E5),
            e3,
        }
    }
}

/// A run of DOP853.
#[derive(Debug)]
pub(crate) struct Dop853<T: Float, E> {
    flow: Flow<T, E>,
    tableau: Tableau<T>,
    tolerance: T,
    k: Vec<Vec<T>>,
    stage: Vec<T>,
    increment: Vec<T>,
    pub(crate) y: Vec<T>,
    h: T,
    t: T,
    pub(crate) steps: u64,
    pub(crate) gradients: u64,
}

impl<T: Float, E: Evaluate<T>> Dop853<T, E> {
    /// A run from `y` with relative and absolute tolerance `tolerance`, and a first step `h` to try.
    pub(crate) fn new(flow: Flow<T, E>, y: Vec<T>, h: T, tolerance: T) -> Self {
        let zero = vec![T::int(0); y.len()];
        let mut run = Dop853 {
            flow,
            tableau: Tableau::new(),
            tolerance,
            k: vec![zero.clone(); STAGES],
            stage: zero.clone(),
            increment: zero,
            y,
            h,
            t: T::int(0),
            steps: 0,
            gradients: 1,
        };
        run.flow.derivative(&run.y, &mut run.k[0]);
        run
    }

    /// Σ over (stage, coefficient) of the stage derivatives, component `i`.
    fn sum(k: &[Vec<T>], coefficients: &[(usize, T)], i: usize) -> T {
        coefficients
            .iter()
            .fold(T::int(0), |sum, &(j, c)| sum + c * k[j][i])
    }

    /// One accepted step towards `end`; `false` once it is reached.
    ///
    /// # Errors
    /// If the step shrinks to nothing, or too many were made.
    pub(crate) fn advance(&mut self, end: T) -> Result<bool, String> {
        if !(self.t < end) {
            return Ok(false);
        }
        loop {
            let last = self.t + self.h * T::ratio(101, 100) >= end;
            let h = if last { end - self.t } else { self.h };
            if self.t + h == self.t || self.steps >= MOST_STEPS || !h.is_finite() {
                return Err(format!("DOP853 gave up at t = {}", self.t.to_f64()));
            }
            let error = self.attempt(h);
            // Factor 0.9 · error^(−1/8), between 1/3 and 6; the exponent needs no digits.
            let scale = (0.9 * error.max(1e-30).powf(-0.125)).clamp(1.0 / 3.0, 6.0);
            let scale = if error.is_finite() { scale } else { 1.0 / 3.0 };
            self.h = h * T::exact(scale);
            if error <= 1.0 {
                for (y, &d) in self.y.iter_mut().zip(&self.increment) {
                    *y += d;
                }
                self.t = if last { end } else { self.t + h };
                self.steps += 1;
                self.gradients += 1;
                self.flow.derivative(&self.y, &mut self.k[0]);
                return Ok(true);
            }
        }
    }

    /// The increment of a step of size h, and its error in units of the tolerance.
    fn attempt(&mut self, h: T) -> f64 {
        let n = self.y.len();
        for s in 1..STAGES {
            for i in 0..n {
                self.stage[i] = self.y[i] + h * Self::sum(&self.k, &self.tableau.a[s], i);
            }
            self.flow.derivative(&self.stage, &mut self.k[s]);
        }
        self.gradients += STAGES as u64 - 1;
        let (mut five, mut three) = (0.0, 0.0);
        for i in 0..n {
            self.increment[i] = h * Self::sum(&self.k, &self.tableau.b, i);
            let size = self.y[i].abs().max((self.y[i] + self.increment[i]).abs());
            let scale = self.tolerance + self.tolerance * size;
            five += (Self::sum(&self.k, &self.tableau.e5, i) / scale)
                .to_f64()
                .powi(2);
            three += (Self::sum(&self.k, &self.tableau.e3, i) / scale)
                .to_f64()
                .powi(2);
        }
        let below = five + 0.01 * three;
        let below = if below > 0.0 { below } else { 1.0 };
        h.to_f64() * five / (below * n as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::Tableau;
    use equip_scalar::{DoubleDouble, Float};

    /// Quadrature conditions Σ b_i c_i^k = 1/(k + 1), with c_i = Σ_j a_ij, to the digits of the decimals.
    #[test]
    fn the_weights_have_order_eight() {
        type D = DoubleDouble;
        let tableau = Tableau::<D>::new();
        let zero = D::int(0);
        let c: Vec<D> = tableau
            .a
            .iter()
            .map(|row| row.iter().fold(zero, |s, &(_, a)| s + a))
            .collect();
        for k in 0..8_i32 {
            let power = |x: D| (0..k).fold(D::int(1), |p, _| p * x);
            let sum = tableau
                .b
                .iter()
                .fold(zero, |s, &(i, b)| s + b * power(c[i]));
            let off = (sum - D::ratio(1, i64::from(k) + 1)).to_f64().abs();
            // Measured 2.9e-29 at most; headroom of 10.
            assert!(off < 2.9e-28, "k = {k}: {off:e}");
        }
    }
}
