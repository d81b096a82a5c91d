//! The fastest motion of the linearised system, ω = max |λ(J∇²H)|, and whether steps resolve it.
//!
//! By power iteration on A², A = J∇²H, whose largest eigenvalue is −ω² for oscillations and λ² where
//! neighbours part; squaring it keeps positions and momenta, whose units differ, apart.
//!
//! Gauss's method turns an oscillation by an angle that is off by about
//!
//! $$ \frac{(s!)^2}{(2s)!\,(2s+1)!} (h\omega)^{2s+1} $$
//!
//! in each step. Steps resolve hω up to [`equip_solver::RESOLVES`] times s, where that is 0.04, 0.01, 5e-4
//! for s = 2, 4, 8.
//!
//! Cost: one Hessian and 2·60 products with it.

use equip_autodiff::{Evaluate, Pattern, System};
use equip_scalar::Float;

/// Products with A²: neighbours 5 % apart are told to 3 %.
const ITERATIONS: u32 = 60;
/// The pattern of ∇²H, and room to work with it, which is made when it is first needed.
#[derive(Debug)]
pub(crate) struct Frequency<T> {
    pattern: Pattern,
    entries: Vec<T>,
    v: Vec<f64>,
    product: Vec<f64>,
}

impl<T: Float> Frequency<T> {
    pub(crate) fn new<H: System>(system: &H) -> Self {
        Self::of(system.structure().hessian.to_pattern())
    }

    fn of(pattern: Pattern) -> Self {
        Frequency {
            pattern,
            entries: Vec::new(),
            v: Vec::new(),
            product: Vec::new(),
        }
    }

    /// ω at `y`, per unit of time; 0 if nothing bends the motion or ∇²H is not finite.
    pub(crate) fn at<E: Evaluate<T>>(&mut self, energy: &mut E, y: &[T]) -> f64 {
        self.entries.resize(self.pattern.len(), T::int(0));
        energy.hessian(y, &mut self.entries);
        self.fastest()
    }

    fn fastest(&mut self) -> f64 {
        let n = self.pattern.dimension();
        // Every direction has a part in it, and no symmetry of a system is its own.
        self.v.clear();
        self.v
            .extend((0..n).map(|i| 1.0 + 0.5 * (1.0 + 7.3 * i as f64).sin()));
        self.product.resize(n, 0.0);
        let mut square = 0.0;
        for _ in 0..ITERATIONS {
            turn(&self.pattern, &self.entries, &self.v, &mut self.product);
            turn(&self.pattern, &self.entries, &self.product, &mut self.v);
            let size = self.v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if !(size > 0.0 && size.is_finite()) {
                return 0.0;
            }
            self.v.iter_mut().for_each(|x| *x /= size);
            square = size;
        }
        square.sqrt()
    }
}

/// `out` = J ∇²H `v`.
fn turn<T: Float>(pattern: &Pattern, entries: &[T], v: &[f64], out: &mut [f64]) {
    let m = v.len() / 2;
    for row in 0..2 * m {
        let terms = pattern.row(row);
        let sum: f64 = terms.map(|(at, k)| entries[at].to_f64() * v[k]).sum();
        if row < m {
            out[row + m] = -sum;
        } else {
            out[row - m] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Frequency;
    use equip_autodiff::Pattern;

    fn fastest(row_starts: &[usize], columns: &[usize], entries: &[f64]) -> f64 {
        let mut frequency = Frequency::of(Pattern {
            row_starts: row_starts.to_vec(),
            columns: columns.to_vec(),
        });
        frequency.entries = entries.to_vec();
        frequency.fastest()
    }

    /// ½ k q² + ½ p²/m with (k, m) = (9, 1) and (1, 4), the first one's unit of length changed; a saddle; a
    /// free particle.
    #[test]
    fn springs_in_any_unit() {
        let (rows, columns) = ([0, 1, 2, 3, 4], [0, 1, 2, 3]);
        for unit in [1.0, 1e-8, 1e9] {
            let found = fastest(&rows, &columns, &[9.0 / unit, 1.0, unit, 0.25]);
            assert!((found - 3.0).abs() < 0.05, "{unit:e}: {found}");
        }
        let saddle = fastest(&rows, &columns, &[-9.0, 1.0, 1.0, 0.25]);
        assert!((saddle - 3.0).abs() < 0.05, "{saddle}");
        let free = fastest(&[0, 0, 1], &[1], &[1.0]);
        assert!(free.abs() < f64::MIN_POSITIVE);
    }
}
