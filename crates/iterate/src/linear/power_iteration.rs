//! The largest frequency of y' = J∇²H y, ω = max |λ(J∇²H)|.
//!
//! It is computed by power iteration on A², A = J∇²H. The largest eigenvalue of A² is −ω² for oscillations
//! and λ² where neighbouring solutions separate exponentially. Squaring A keeps positions and momenta, whose
//! units differ, apart. Power iteration approaches ω from below. For a positive vector x and |A| in place of
//! A the largest ratio of components,
//!
//! $$ \omega^2 \le \max_c \frac{(|A|^2 x)_c}{x_c} , $$
//!
//! is an upper bound (Collatz 1942, Wielandt 1950). In most cases this bound suffices to show that ω is small
//! enough.
//!
//! The arithmetic is in `f64` for every float type. Cost: 2·[`ITERATIONS`] products with ∇²H, and two to
//! eight for the bound.

use crate::policy::{BOUNDS, ITERATIONS};
use equip_autodiff::{Pattern, turned};

/// ∇²H, and workspace.
#[derive(Debug, Default)]
pub struct PowerIteration {
    entries: Vec<f64>,
    x: Vec<f64>,
    once: Vec<f64>,
    twice: Vec<f64>,
}

impl PowerIteration {
    /// Allocates, so that the other methods do not.
    pub fn make_room(&mut self, pattern: &Pattern) {
        self.entries.resize(pattern.len(), 0.0);
        for x in [&mut self.x, &mut self.once, &mut self.twice] {
            x.resize(pattern.dimension(), 0.0);
        }
    }

    /// Sets the entries of ∇²H.
    pub fn set(&mut self, pattern: &Pattern, entries: impl Iterator<Item = f64>) {
        self.make_room(pattern);
        for (to, entry) in self.entries.iter_mut().zip(entries) {
            *to = entry;
        }
    }

    /// ω; 0 if A² vanishes on the iterated vector or ∇²H is not finite.
    pub fn fastest(&mut self, pattern: &Pattern) -> f64 {
        self.fastest_up_to(pattern, f64::INFINITY)
    }

    /// ω, or a lower bound as soon as it exceeds `most`.
    fn fastest_up_to(&mut self, pattern: &Pattern, most: f64) -> f64 {
        // The initial vector has components in all directions and shares no symmetry of the system.
        for (i, x) in self.x.iter_mut().enumerate() {
            *x = 1.0 + 0.5 * (1.0 + 7.3 * i as f64).sin();
        }
        // The geometric mean of two successive values, since they alternate if an oscillation and a saddle
        // have the same rate.
        let (mut before, mut square) = (0.0_f64, 0.0_f64);
        for made in 0..ITERATIONS {
            let found = (before.sqrt() * square.sqrt()).sqrt();
            if made >= BOUNDS && found > most {
                return found;
            }
            before = square;
            square = self.twice(pattern, |x| x);
            if !(square > 0.0 && square.is_finite()) {
                return 0.0;
            }
            let scaled = self.x.iter_mut().zip(&self.twice);
            scaled.for_each(|(x, twice)| *x = twice / square);
        }
        (before.sqrt() * square.sqrt()).sqrt()
    }

    /// Whether ω ≤ `most`.
    pub fn is_within(&mut self, pattern: &Pattern, most: f64) -> bool {
        self.x.fill(1.0);
        for _ in 0..BOUNDS {
            let size = self.twice(pattern, f64::abs);
            let ratios = self.twice.iter().zip(&self.x).filter(|&(_, x)| *x > 0.0);
            let bound = ratios.fold(0.0_f64, |most, (twice, x)| most.max(twice / x));
            if bound <= most * most {
                return true;
            }
            let scaled = self.x.iter_mut().zip(&self.twice);
            scaled.for_each(|(x, twice)| *x = twice / size);
        }
        self.fastest_up_to(pattern, most) <= most
    }

    /// A²x, or |A|²x. Returns the largest absolute component.
    fn twice(&mut self, pattern: &Pattern, of: impl Fn(f64) -> f64 + Copy) -> f64 {
        turn(pattern, &self.entries, of, (&self.x, &mut self.once));
        turn(pattern, &self.entries, of, (&self.once, &mut self.twice));
        self.twice.iter().fold(0.0, |most, x| most.max(x.abs()))
    }
}

/// `out` = J∇²H `x`, with `of` applied to all entries.
fn turn(
    pattern: &Pattern,
    entries: &[f64],
    of: impl Fn(f64) -> f64,
    (x, out): (&[f64], &mut [f64]),
) {
    let n = x.len();
    for c in 0..n {
        let terms = pattern.row(c);
        let sum: f64 = terms.map(|(e, column)| of(entries[e]) * x[column]).sum();
        let (row, sign) = turned::<f64>(c, n);
        out[row] = of(sign) * sum;
    }
}

#[cfg(test)]
mod tests {
    use super::PowerIteration;
    use equip_autodiff::Pattern;

    fn pattern(row_starts: &[usize], columns: &[usize]) -> Pattern {
        Pattern {
            row_starts: row_starts.to_vec(),
            columns: columns.to_vec(),
        }
    }

    fn fastest(pattern: &Pattern, entries: &[f64]) -> f64 {
        let mut iteration = PowerIteration::default();
        iteration.set(pattern, entries.iter().copied());
        let found = iteration.fastest(pattern);
        assert!(iteration.is_within(pattern, 1.01 * found));
        assert!(!iteration.is_within(pattern, 0.99 * found) || found < f64::MIN_POSITIVE);
        found
    }

    /// ½ k q² + ½ p²/m with (k, m) = (9, 1) and (1, 4), the first one in several units of length; a saddle; a
    /// free particle.
    #[test]
    fn springs_in_any_unit() {
        let diagonal = pattern(&[0, 1, 2, 3, 4], &[0, 1, 2, 3]);
        for unit in [1.0, 1e-8, 1e9] {
            let found = fastest(&diagonal, &[9.0 / unit, 1.0, unit, 0.25]);
            assert!((found - 3.0).abs() < 1e-9, "{unit:e}: {found}");
        }
        let saddle = fastest(&diagonal, &[-9.0, 1.0, 1.0, 0.25]);
        assert!((saddle - 3.0).abs() < 1e-9, "{saddle}");
        let free = fastest(&pattern(&[0, 0, 1], &[1]), &[1.0]);
        assert!(free.abs() < f64::MIN_POSITIVE);
    }

    /// If the signs of ∇²H matter, the bound is too large and does not decide: K = ((1, 1), (1, −1)) has the
    /// eigenvalues ±√2, an oscillation and a saddle, whereas |K| has 2.
    #[test]
    fn what_the_bound_cannot_tell_the_iteration_does() {
        let coupled = pattern(&[0, 2, 4, 5, 6], &[0, 1, 0, 1, 2, 3]);
        let found = fastest(&coupled, &[1.0, 1.0, 1.0, -1.0, 1.0, 1.0]);
        assert!((found - 2.0_f64.powf(0.25)).abs() < 1e-9, "{found}");
    }
}
