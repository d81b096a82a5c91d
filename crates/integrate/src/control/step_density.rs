//! [`StepDensity`]: 1/σ, how many steps per ε a unit of time takes, as a function of the state alone and even
//! in p.
//!
//! *Given.* σ(q, p) is the user's; ∇σ comes with it.
//!
//! *Automatic.* The pace of the linearised motion: A = J∇²H has eigenvalues ±iω for oscillations and ±λ where
//! neighbours part, and
//!
//! $$ \frac1\sigma = \Big( \tfrac12 |\mathrm{tr} A^4| \Big)^{1/4} = \Big| \sum_k \omega_k^4 + \sum_k
//! \lambda_k^4 \Big|^{1/4} $$
//!
//! is the fastest of them, smooth, independent of the units of q and p and of the choice of coordinates in
//! which A is written, and the same for flipped momenta. For Kepler's problem it is a multiple of r^{−3/2}. ε
//! is then the phase that the fastest motion turns by in a step: 6.3 / ε steps a turn.
//!
//! Its derivative along the motion is a difference over ±δ on a parabola: odd under reversal whatever δ, so
//! that reversible steps remain reversible.
//!
//! Cost of the automatic one: one Hessian and at most n nnz operations per value; a rate takes two values, a
//! gradient and a product ∇²H v.

use crate::control::first_step::turn;
use crate::control::policy::PART;
use crate::error::IntegrateError;
use crate::time::direction::TimeDirection;
use equip_autodiff::{Evaluator, Hamiltonian, Pattern};
use equip_scalar::Float;
use equip_solver::Counts;

/// Most unknowns 2m for which A² is made.
const MOST_UNKNOWNS: usize = 512;

#[derive(Debug)]
pub(crate) struct StepDensity<T: Float> {
    source: Source<T>,
    f: Vec<T>,
    second: Vec<T>,
    slope: Vec<T>,
    point: Vec<T>,
}

#[derive(Debug)]
enum Source<T: Float> {
    /// σ.
    Given(Box<Evaluator<T>>),
    Automatic {
        pattern: Pattern,
        entries: Vec<T>,
        /// A², row by row.
        square: Vec<T>,
    },
}

impl<T: Float> StepDensity<T> {
    /// That of `sigma`, or the automatic one.
    pub(crate) fn new(
        system: &Hamiltonian,
        sigma: Option<&Hamiltonian>,
    ) -> Result<Self, IntegrateError<T>> {
        let (m, zero) = (system.degrees_of_freedom(), T::int(0));
        let n = 2 * m;
        // Of (t, q, p) it is a function of the state where that has time in it.
        let sigma = sigma.map(Hamiltonian::alone);
        let source = match sigma {
            Some(sigma) if sigma.degrees_of_freedom() != m => {
                return Err(IntegrateError::WrongLength {
                    what: "sigma",
                    expected: m,
                    found: sigma.degrees_of_freedom(),
                });
            }
            Some(sigma) => Source::Given(Box::new(sigma.evaluator::<T>())),
            None if n > MOST_UNKNOWNS => {
                return Err(IntegrateError::Option {
                    option: "degrees of freedom",
                    value: T::int(i64::try_from(m).unwrap_or(i64::MAX)),
                    expected: "at most 256 for the automatic σ; give σ as a function for more",
                });
            }
            None => {
                let pattern = system.structure().hessian.to_pattern();
                Source::Automatic {
                    entries: vec![zero; pattern.len()],
                    pattern,
                    square: vec![zero; n * n],
                }
            }
        };
        Ok(StepDensity {
            source,
            f: vec![zero; n],
            second: vec![zero; n],
            slope: vec![zero; n],
            point: vec![zero; n],
        })
    }

    /// 1/σ at `y`.
    pub(crate) fn at(
        &mut self,
        y: &[T],
        energy: &mut Evaluator<T>,
        counts: &mut Counts,
    ) -> Result<T, IntegrateError<T>> {
        self.source.at(y, energy, counts)
    }

    /// d ln(1/σ)/dt along the motion at `y`, t growing the way that a run goes.
    pub(crate) fn rate(
        &mut self,
        y: &[T],
        direction: TimeDirection,
        energy: &mut Evaluator<T>,
        counts: &mut Counts,
    ) -> Result<T, IntegrateError<T>> {
        counts.gradients += 1;
        energy.gradient(y, &mut self.slope);
        turn(&self.slope, &mut self.f);
        (self.f.iter_mut()).for_each(|f| *f = direction.signed(*f));
        if let Source::Given(sigma) = &mut self.source {
            let value = checked(sigma.gradient(y, &mut self.slope))?;
            return Ok(-(dot(&self.slope, &self.f) / value));
        }
        energy.hessian_vector(y, &self.f, &mut self.slope);
        turn(&self.slope, &mut self.second);
        (self.second.iter_mut()).for_each(|x| *x = direction.signed(*x));
        let now = self.source.at(y, energy, counts)?;
        let delta = T::ratio(1, PART) / now;
        let mut end = |delta: T| {
            let half = delta * delta / T::int(2);
            for (j, x) in self.point.iter_mut().enumerate() {
                *x = y[j] + (delta * self.f[j] + half * self.second[j]);
            }
            self.source.at(&self.point, energy, counts)
        };
        let (ahead, behind) = (end(delta)?, end(-delta)?);
        // ln(ahead/behind)/2δ, odd in δ to the last bit.
        let x = (ahead - behind) / (ahead + behind);
        let square = x * x;
        let series = (1..4)
            .rev()
            .fold(T::int(0), |sum, k| (sum + T::ratio(1, 2 * k + 1)) * square);
        Ok(x * (T::int(1) + series) / delta)
    }
}

impl<T: Float> Source<T> {
    fn at(
        &mut self,
        y: &[T],
        energy: &mut Evaluator<T>,
        counts: &mut Counts,
    ) -> Result<T, IntegrateError<T>> {
        let sigma = match self {
            Source::Given(sigma) => sigma.value(y),
            Source::Automatic {
                pattern,
                entries,
                square,
            } => {
                counts.hessians += 1;
                energy.hessian(y, entries);
                T::int(1) / pace(pattern, entries, square, y.len())
            }
        };
        checked(sigma).map(|sigma| T::int(1) / sigma)
    }
}

/// (½ |tr A⁴|)^{1/4} for the Hessian with these `entries`; A² goes to `square`.
fn pace<T: Float>(pattern: &Pattern, entries: &[T], square: &mut [T], n: usize) -> T {
    square.fill(T::int(0));
    for row in 0..n {
        let (r, sign) = turned::<T>(row, n);
        let out = &mut square[r * n..][..n];
        for (position, k) in pattern.row(row) {
            // Row k of A is this row of ∇²H, with the sign that J gives it.
            let partner = turned::<T>(k, n).0;
            let x = sign * turned::<T>(partner, n).1 * entries[position];
            for (position, j) in pattern.row(partner) {
                out[j] += x * entries[position];
            }
        }
    }
    let rows = square.chunks_exact(n).enumerate();
    let trace = rows.fold(T::int(0), |sum, (i, row)| {
        let column = square[i..].iter().step_by(n);
        row.iter()
            .zip(column)
            .fold(sum, |sum, (&a, &b)| sum + a * b)
    });
    (trace.abs() / T::int(2)).sqrt().sqrt()
}

fn checked<T: Float>(sigma: T) -> Result<T, IntegrateError<T>> {
    if sigma > T::int(0) && sigma.is_finite() {
        Ok(sigma)
    } else {
        Err(IntegrateError::Option {
            option: "sigma",
            value: sigma,
            expected: "positive and finite along the whole run",
        })
    }
}

/// Scalar product.
fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}

/// Row `row` of a matrix A stands in row r of J A, with a sign. J = (0 I; −I 0) takes it there and back
/// alike.
fn turned<T: Float>(row: usize, n: usize) -> (usize, T) {
    let m = n / 2;
    if row < m {
        (row + m, -T::int(1))
    } else {
        (row - m, T::int(1))
    }
}
