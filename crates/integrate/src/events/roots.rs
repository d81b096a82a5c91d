//! All roots of a smooth function on [0, 1], separated by Chebyshev coefficients.
//!
//! On an interval g is interpolated at N + 1 Chebyshev points (ends included), g ≈ Σ a_k T_k. Let E be an
//! estimate of the remainder:
//!
//! - |a_0| > Σ_{k≥1} |a_k| + E: no root, since |T_k| ≤ 1;
//! - the derivative with coefficients d_k satisfies |d_0| > Σ_{k≥1} |d_k| + N² E: g is monotone, with one
//!   root if the signs at the ends differ, and none otherwise;
//! - otherwise the interval is halved.
//!
//! A root is then enclosed by regula falsi with bisection, until the enclosure reaches the resolution.
//!
//! *Rounding.* On a short interval the coefficients of a smooth g decay at once, so those of degree N/2 and
//! above are the rounding of g. If they are as large as all the others, g touches zero within its rounding,
//! and the signs at the ends decide. The same holds for an interval at the resolution. Rounding above √ε of
//! the largest |g| counts as roughness, and is an error.
//!
//! Cost: 17 evaluations of g if there is no root, about 20 more per root, and about 1500 if g touches zero.

use crate::control::policy::SHORT;
use equip_scalar::Float;

/// N.
const DEGREE: usize = 16;
/// The number of intervals after which g is considered too rough, and of further ones for each root on a
/// monotone piece: a long step may contain many roots of a smooth g. // intervals; at most 9.8 for each root
/// of 40 random sums of a sine and a cosine, 50 roots and more in a step
const MOST_INTERVALS: usize = 2000;
const MOST_PER_ROOT: usize = 16;

/// Workspace.
#[derive(Debug)]
pub(crate) struct Roots<T> {
    /// cos(jπ/N), j = 0 … 2N − 1.
    cosines: Vec<T>,
    values: [T; DEGREE + 1],
    stack: Vec<Interval<T>>,
    /// The largest |g| so far.
    largest: T,
    /// The roots found, in ascending order, and whether g rises.
    pub(crate) found: Vec<(T, bool)>,
}

/// An interval with the values at its ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval<T> {
    pub(crate) a: T,
    pub(crate) b: T,
    pub(crate) at_a: T,
    pub(crate) at_b: T,
}

/// g changes sign more often than its rounding lets us resolve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TooRough;

impl<T: Float> Roots<T> {
    pub(crate) fn new() -> Self {
        let step = T::pi() / T::int(DEGREE as i64);
        Roots {
            cosines: (0..2 * DEGREE as i64)
                .map(|j| (T::int(j) * step).cos())
                .collect(),
            values: [T::int(0); DEGREE + 1],
            stack: Vec::with_capacity(64),
            largest: T::int(0),
            found: Vec::new(),
        }
    }

    /// Finds the roots of `g` on [0, 1], separated down to `resolution`, and stores them in `found`.
    pub(crate) fn find(
        &mut self,
        mut g: impl FnMut(T) -> T,
        resolution: T,
    ) -> Result<(), TooRough> {
        let (a, b) = (T::int(0), T::int(1));
        let (at_a, at_b) = (g(a), g(b));
        self.found.clear();
        self.stack.clear();
        self.largest = T::int(0);
        self.stack.push(Interval { a, b, at_a, at_b });
        let (mut looked_at, mut most) = (0, MOST_INTERVALS);
        while let Some(interval) = self.stack.pop() {
            looked_at += 1;
            if looked_at > most {
                return Err(TooRough);
            }
            let Interval { a, b, at_a, at_b } = interval;
            let changes = positive(at_a) != positive(at_b);
            if b - a <= resolution {
                if changes {
                    self.found.push((b, positive(at_b)));
                }
                continue;
            }
            match self.look(&mut g, &interval) {
                Look::NoRoot => {}
                Look::Noise if changes => self.found.push((b, positive(at_b))),
                Look::Noise => {}
                Look::Monotone if !changes => {}
                Look::Monotone => {
                    let root = enclose(&mut g, interval, resolution);
                    self.found.push((root, positive(at_b)));
                    most += MOST_PER_ROOT;
                }
                Look::Unknown => {
                    let middle = (a + b) / T::int(2);
                    let at_middle = g(middle);
                    // The left half is examined first, so the roots are found in order.
                    self.stack.push(Interval {
                        a: middle,
                        at_a: at_middle,
                        ..interval
                    });
                    self.stack.push(Interval {
                        b: middle,
                        at_b: at_middle,
                        ..interval
                    });
                }
            }
        }
        Ok(())
    }

    fn look(&mut self, g: &mut impl FnMut(T) -> T, interval: &Interval<T>) -> Look {
        let (a, b) = (interval.a, interval.b);
        let (middle, half) = ((a + b) / T::int(2), (b - a) / T::int(2));
        for j in 1..DEGREE {
            self.values[j] = g(middle + half * self.cosines[j]);
        }
        self.values[0] = interval.at_b;
        self.values[DEGREE] = interval.at_a;
        let largest = self.values.iter().fold(self.largest, |a, v| a.max(v.abs()));
        self.largest = largest;
        if self.values.iter().all(|&v| v == T::int(0)) {
            return Look::NoRoot;
        }
        let coefficients = self.coefficients();
        let sum = |x: &[T]| x.iter().fold(T::int(0), |sum, x| sum + x.abs());
        // The remainder after the last coefficients by geometric decay, estimated from three of them, since
        // every other one may vanish.
        let rest = T::int(4) * sum(&coefficients[DEGREE - 2..]);
        if coefficients[0].abs() > sum(&coefficients[1..]) + rest {
            return Look::NoRoot;
        }
        let noise = sum(&coefficients[DEGREE / 2..]);
        let size = sum(&coefficients[..DEGREE / 2]);
        let rough = noise > T::EPSILON.sqrt() * self.largest;
        if b - a < T::ratio(1, SHORT) && !rough && T::int(8) * noise >= size {
            return Look::Noise;
        }
        let gradients = derivative(&coefficients);
        let rest = T::int((DEGREE * DEGREE) as i64) * rest;
        if gradients[0].abs() > sum(&gradients[1..]) + rest {
            return Look::Monotone;
        }
        Look::Unknown
    }

    /// a_k of the interpolant through `values` at the points cos(jπ/N).
    fn coefficients(&self) -> [T; DEGREE + 1] {
        let half = T::ratio(1, 2);
        let mut out = [T::int(0); DEGREE + 1];
        for (k, out) in out.iter_mut().enumerate() {
            for (j, &value) in self.values.iter().enumerate() {
                let end = j == 0 || j == DEGREE;
                let value = if end { half * value } else { value };
                *out += value * self.cosines[(j * k) % (2 * DEGREE)];
            }
            let end = k == 0 || k == DEGREE;
            *out /= T::int(DEGREE as i64) * T::int(if end { 2 } else { 1 });
        }
        out
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    NoRoot,
    Monotone,
    /// Only rounding.
    Noise,
    Unknown,
}

/// Zero counts as positive.
fn positive<T: Float>(x: T) -> bool {
    x >= T::int(0)
}

/// The Chebyshev coefficients of the derivative, by d_{k−1} = d_{k+1} + 2k a_k.
fn derivative<T: Float>(a: &[T; DEGREE + 1]) -> [T; DEGREE + 1] {
    let mut d = [T::int(0); DEGREE + 1];
    for k in (1..=DEGREE).rev() {
        let beyond = d.get(k + 1).copied().unwrap_or(T::int(0));
        d[k - 1] = beyond + T::int(2 * k as i64) * a[k];
    }
    d[0] /= T::int(2);
    d
}

/// The root of a function whose signs at the ends differ, by regula falsi (Anderson & Björck 1973), with a
/// bisection whenever three steps have not halved the enclosure. Returns the end of the last enclosure with
/// the smaller |g|.
pub(crate) fn enclose<T: Float>(
    g: &mut impl FnMut(T) -> T,
    interval: Interval<T>,
    resolution: T,
) -> T {
    let Interval {
        mut a,
        mut b,
        at_a,
        at_b,
    } = interval;
    // The function values, and the values that regula falsi uses.
    let (mut true_a, mut true_b) = (at_a, at_b);
    let (mut low, mut high) = (at_a, at_b);
    let (mut wanted, mut count) = (b - a, 0);
    while b - a > resolution {
        count += 1;
        let mut x = if count % 4 == 0 && b - a > wanted {
            (a + b) / T::int(2)
        } else {
            b - high * ((b - a) / (high - low))
        };
        if count % 4 == 0 {
            wanted = (b - a) / T::int(4);
        }
        if !(x > a && x < b) {
            x = (a + b) / T::int(2);
            if !(x > a && x < b) {
                break;
            }
        }
        let value = g(x);
        if value == T::int(0) {
            return x;
        }
        let shrunk = |before: T| {
            let share = T::int(1) - value / before;
            if share > T::int(0) {
                share
            } else {
                T::ratio(1, 2)
            }
        };
        if positive(value) == positive(true_b) {
            low *= shrunk(high);
            (b, high, true_b) = (x, value, value);
        } else {
            high *= shrunk(low);
            (a, low, true_a) = (x, value, value);
        }
    }
    if true_a.abs() < true_b.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::{Roots, TooRough};

    fn roots(g: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut roots = Roots::new();
        roots.find(g, 1e-16).unwrap();
        roots.found.iter().map(|(root, _)| *root).collect()
    }

    #[test]
    fn polynomials_with_known_roots() {
        assert_eq!(roots(|_| 1.0), Vec::<f64>::new());
        assert_eq!(roots(|_| 0.0), Vec::<f64>::new());
        assert_eq!(roots(|x| x - 0.25), [0.25]);
        for gap in [1e-2, 1e-4, 1e-6] {
            let found = roots(|x| (x - 0.3) * (x - 0.3 - gap));
            assert_eq!(found.len(), 2, "{gap}");
            assert!((found[0] - 0.3).abs() < 2e-16 && (found[1] - 0.3 - gap).abs() < 2e-16);
        }
        // Expanded, the gap disappears in rounding below √ε: two roots above, any even number below.
        let found = roots(|x| x * x - (0.6 + 1e-7) * x + 0.3 * (0.3 + 1e-7));
        assert_eq!(found.len() % 2, 0);
        // Touching from above, without a sign change.
        assert_eq!(roots(|x| (x - 0.5) * (x - 0.5)), Vec::<f64>::new());
        assert_eq!(roots(|x| (x - 0.3).powi(3)).len(), 1);
    }

    #[test]
    fn many_roots_in_order() {
        let found = roots(|x| (40.0 * x).sin());
        assert_eq!(found.len(), 12);
        for (i, root) in found.iter().enumerate() {
            let exact = (i + 1) as f64 * std::f64::consts::PI / 40.0;
            assert!((root - exact).abs() < 3e-16, "{root} {exact}");
        }
    }

    #[test]
    fn noise_is_refused() {
        let mut roots = Roots::new();
        let noise = |x: f64| ((x * 1e6).sin() * 43758.5).fract() - 0.1;
        assert_eq!(roots.find(noise, 1e-16), Err(TooRough));
    }
}
