//! The error estimate of a step, from the decay of the Legendre coefficients of its stage derivatives.
//!
//! The stages define u'(τ) = Σ_{k<s} γ_k P_k(τ), γ_k = Σ_i b_i P_k(c_i) f(Y_i). The part of f that s stages
//! do not resolve begins with γ_s. It affects the end point through the component of the flow's derivative
//! that is orthogonal to all polynomials of degree below s, and that component decays at the same rate. If
//! the coefficients decay by a factor ϱ each, the error of the end point is therefore about ϱ^{2s}, in
//! agreement with the order 2s. For each component separately, in units of its own change over the step,
//!
//! $$ \mathrm{est} = \varrho^{2s}, \qquad
//!    \varrho = \max_c \min_{j=0,1} \max_{k = s-1, s} \Big( \frac{|\gamma_k|}{a_j} \Big)^{1/(k-j)} ,
//!    \qquad a_0 = \max_j |\gamma_j|, \quad a_1 = |\gamma_1| . $$
//!
//! Two coefficients are used because every other one vanishes if the motion is even or odd about the middle
//! of the step. The decay may be measured from degree 1 because the coefficient of degree 0 vanishes at a
//! turning point.
//!
//! The coefficients from degree s on follow from the residual of the polynomial at the ends of the step,
//! where it has no node,
//!
//! $$ \gamma_s P_s(\tau) + \gamma_{s+1} P_{s+1}(\tau) = f(u(\tau)) - \sum_{k<s} \gamma_k P_k(\tau) ,
//!    \qquad \tau = 0, 1 . $$
//!
//! *If the coefficients stop decaying*, as near a discontinuity of a derivative of H, the decay is not
//! extrapolated. If the last coefficients are smaller than the ones before by a factor r each,
//!
//! $$ \mathrm{est} \ge \max_c \frac{g}{\max(a_0, a_1/r)}\, r^s , \qquad
//!    g = \max(|\gamma_s|, |\gamma_{s+1}|), \quad
//!    r = \min\Big( 1, \frac{g}{|\gamma_{s-1}|}, \Big( \frac{g}{|\gamma_{s-2}|} \Big)^{1/2} \Big) . $$
//!
//! The estimate is relative to the change over the step, not to the state. It therefore depends neither on
//! the origin nor on units and masses, and detects a close encounter of two bodies among many. Changes below
//! √tolerance of the size of a component are not resolved further, nor are changes below ε of the largest
//! component, or change, in the group (positions or momenta): a component that is constant by symmetry
//! changes by rounding. A component that changes by less than the tolerance of its size is not estimated: no
//! step need be shorter for it, for any H. If H is smooth, neither is a component that is zero at the start
//! of a step up to ε^{1/4} of the proposed size. It may begin like τ^k, k > s, which no step resolves, and
//! then its change is below ε^{s/4} of that in a step of the proposed size.
//!
//! If the admissible error of a component differs from the tolerance of its change (`rtol`, `atol`), its
//! estimate is divided by the ratio of both, together with the factor of the flow.
//!
//! If a step is longer than allowed, a multiple of the rounding error of the derivatives is subtracted from
//! its coefficients ([`Decay::estimate`]). Near the rest length of a stiff spring, far from the origin, and
//! along a smooth chain, ∇H has few correct digits, and shorter steps do not give more of them
//! (docs/adr/0024).
//!
//! The same coefficients show whether the motion accelerates. By least squares γ_k ≈ w γ_{k−1}. If a
//! singularity on the real axis of time limits the convergence, w = 1/ρ, and its distance from the middle of
//! the step is half a step divided by 1/z = 2w/(1 + w²); it lies ahead if w > 0, behind if w < 0 (Bernstein
//! ellipses). The smaller one of the last two w is used, and none if their signs differ. The signs of an
//! oscillation differ, and an oscillation does not accelerate.
//!
//! Cost: s² n multiplications, and ∇H at the end of the step.

use crate::control::policy::{NOISE, ROUNDING};
use crate::control::rate::{Rate, Sizes};
use equip_scalar::power::power;
use equip_scalar::{Float, InstructionSet, mix_stages};
use equip_solver::{State, stride_for};
use equip_tableau::{Coefficients, legendre_at};

/// The admissible error of each component: relative to its change over the step, and absolute.
#[derive(Debug, Clone)]
pub(crate) struct Allowed<T> {
    pub(crate) relative: Vec<T>,
    pub(crate) absolute: Vec<T>,
}

/// The result of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Estimate {
    /// ϱ. For the tolerance 1, ϱ^{2s} is the error of the end point relative to the admissible error.
    pub(crate) decay: f64,
    /// 1/z: half a step divided by the signed distance from its middle to a singularity ahead or behind;
    /// within ±1.
    pub(crate) nearness: f64,
    /// The largest relative part of the change of a component that its s coefficients do not represent.
    pub(crate) rest: f64,
}

/// The start or the end of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End<'a, T> {
    /// ∇H at this end.
    pub(crate) gradient: &'a [T],
    /// Whether the gradient is evaluated slightly within the step, at [`Decay::inset`].
    pub(crate) is_inset: bool,
}

#[derive(Debug)]
pub(crate) struct Decay<T: Float> {
    set: InstructionSet,
    stages: usize,
    /// The degree of the method.
    s: usize,
    stride: usize,
    /// The number of positions, and of momenta, that are estimated: the first ones.
    m: usize,
    tolerance: T,
    /// `None` if the admissible error of every component is the tolerance of its change.
    allowed: Option<Allowed<T>>,
    /// ϱ of each component and its factor a: a^{2s} is the tolerance of its change divided by the admissible
    /// error. Empty if a = 1 for all components.
    rates: Vec<[f64; 2]>,
    /// P_k(c_i) at i·stride + k.
    legendre: Vec<T>,
    /// h γ_k of component c at c·stride + k.
    coefficients: Vec<T>,
    /// In steps up to this size, components that are zero at the start are not estimated.
    pub(crate) from_zero: T,
    /// The units of the components.
    units: Vec<T>,
    /// The inverse units, zero for components that do not move.
    inverse_units: Vec<T>,
    /// √(2k + 1) = P_k(1), and P_k(1 − η), for k < s.
    at_end: [Vec<T>; 2],
}

/// η s². Within η of an end of the step, a polynomial of degree s + 1 differs from its value at the end by
/// about 6 %.
const INSET: i64 = 16;

impl<T: Float> Decay<T> {
    /// For states with n components, of which the first `m` positions and momenta are estimated, not time.
    pub(crate) fn new(
        method: &Coefficients<T>,
        (n, m): (usize, usize),
        tolerance: T,
        allowed: Option<Allowed<T>>,
    ) -> Self {
        let (stages, s) = (method.stages(), method.degree());
        let stride = stride_for::<T>(stages);
        let zeros = |len: usize| vec![T::int(0); len];
        let mut legendre = zeros(stages * stride);
        for k in 0..s {
            for (i, &p) in method.legendre(k).iter().enumerate() {
                legendre[i * stride + k] = p;
            }
        }
        let mut at_end = [zeros(s), zeros(s)];
        for (values, place) in at_end.iter_mut().zip([T::int(1), T::int(1) - inset(s)]) {
            legendre_at(place, values);
        }
        Decay {
            set: InstructionSet::best(),
            stages,
            s,
            stride,
            m,
            tolerance,
            rates: vec![[0.0, 1.0]; allowed.as_ref().map_or(0, |_| n)],
            allowed,
            legendre,
            coefficients: zeros(n * stride),
            from_zero: T::int(0),
            units: zeros(n),
            inverse_units: zeros(n),
            at_end,
        }
    }

    /// η: if an end of the step is on a switch, the derivative is evaluated at η or 1 − η, since ∇H may
    /// differ on the other side.
    pub(crate) fn inset(&self) -> T {
        inset(self.s)
    }

    /// The estimate for the step of size `h` from `y`, with its two ends and these L, component c of stage i
    /// at c·stride + i. Differences within the `rounding` of ∇H, if it is given, do not count as motion.
    pub(crate) fn estimate(
        &mut self,
        (y, h): (&State<T>, T),
        l: &[T],
        ends: [End<'_, T>; 2],
        rounding: Option<&[T]>,
    ) -> Estimate {
        let (stages, s, stride) = (self.stages, self.s, self.stride);
        mix_stages(
            self.set,
            &self.legendre,
            l,
            &mut self.coefficients,
            stages,
            stride,
        );
        let half = y.hi.len() / 2;
        let (mut rate, mut rest) = (Rate::new(s), 0.0_f64);
        let is_inset = ends.map(|end| end.is_inset);
        for (group, y) in y.hi.chunks_exact(half).enumerate() {
            let largest = self.largest(group * half, y);
            // f = J∇H.
            let (sign, from) = if group == 0 { (h, half) } else { (-h, 0) };
            for (c, &y) in y[..self.m].iter().enumerate() {
                let rates = ends.map(|end| sign * end.gradient[from + c]);
                let noise =
                    rounding.map_or(T::int(0), |x| T::int(ROUNDING) * h.abs() * x[from + c]);
                let c = group * half + c;
                let begins = y == T::int(0) && h.abs() <= self.from_zero;
                let sizes = self.sizes(c, (y, largest, begins), (rates, is_inset), noise);
                rest = rest.max(sizes.map_or(f64::INFINITY, |sizes| sizes.tail));
                if self.allowed.is_none() {
                    rate.raise(sizes.as_ref());
                } else {
                    let mut own = Rate::new(s);
                    own.raise(sizes.as_ref());
                    let share = self.share(c);
                    self.rates[c] = [own.largest, share];
                    rate.largest = rate.largest.max(own.largest * share);
                }
            }
        }
        Estimate {
            decay: rate.largest,
            nearness: self.nearness(),
            rest,
        }
    }

    /// The largest of the estimated components of a group, or of their changes. The group begins with
    /// component `from`, `y` are its components at the start of the step; the changes are stored as units.
    fn largest(&mut self, from: usize, y: &[T]) -> T {
        let mut largest = T::int(0);
        let rows = self.coefficients[from * self.stride..].chunks_exact(self.stride);
        let units = self.units[from..][..self.m].iter_mut();
        for ((row, unit), y) in rows.zip(units).zip(y) {
            *unit = row[..self.s].iter().fold(T::int(0), |a, x| a.max(x.abs()));
            largest = largest.max(y.abs()).max(*unit);
        }
        largest
    }

    /// The sizes of the coefficients of component c in units of its change; these units are stored. `None` if
    /// the sizes are not finite. `y` is the component at the start of the step, `largest` the largest one of
    /// its group, and it is not estimated if it `begins`; `ends` are h f at the start and at the end, `noise`
    /// is the rounding of h f.
    fn sizes(
        &mut self,
        c: usize,
        (y, largest, begins): (T, T, bool),
        (ends, is_inset): ([T; 2], [bool; 2]),
        noise: T,
    ) -> Option<Sizes> {
        let s = self.s;
        let row = &self.coefficients[c * self.stride..][..s];
        if !row.iter().chain(&ends).all(|x| x.is_finite()) {
            return None;
        }
        let motion = self.units[c];
        let relative = (self.allowed.as_ref()).map_or(self.tolerance, |x| x.relative[c]);
        let least = (relative.sqrt() * y.abs()).max(T::EPSILON * largest);
        let unit = motion.max(least);
        let is_small = begins || motion <= relative * y.abs();
        let inverse = if is_small || unit < T::MIN_POSITIVE {
            T::int(0)
        } else {
            T::int(1) / unit
        };
        let theta = |x: T| ((x.abs() - noise) * inverse).to_f64().max(0.0);
        let [next, after] = self.beyond(row, ends, is_inset).map(theta);
        let tail = next.max(after);
        let sizes = Sizes {
            second: theta(row[1].abs().max(least)),
            before: theta(row[(s - 2).max(1)]),
            last: theta(row[s - 1]),
            next,
            tail,
            has_tail: tail > (NOISE * T::EPSILON.to_f64()).max(relative.to_f64()),
        };
        (self.units[c], self.inverse_units[c]) = (unit, inverse);
        Some(sizes)
    }

    /// (tolerance of the change of component c / its admissible error)^{1/2s}.
    fn share(&self, c: usize) -> f64 {
        let allowed = (self.allowed(c) * self.inverse_units[c] / self.tolerance).to_f64();
        if allowed > 0.0 {
            power(allowed, -1.0 / (2 * self.s) as f64)
        } else {
            1.0
        }
    }

    /// ϱ of the last estimate, `rho` by the motion alone, if errors grow until the end of the step by `flow`,
    /// the Φ_s^{1/s} of its flow.
    pub(crate) fn with_flow(&self, rho: f64, flow: f64) -> f64 {
        let with = |rho: f64| (rho * (flow * flow + rho * rho).sqrt()).sqrt();
        match &self.allowed {
            None => with(rho),
            Some(_) => {
                (self.rates.iter()).fold(0.0, |most, &[rho, share]| most.max(with(rho) * share))
            }
        }
    }

    /// Whether the unresolved part of the step, or the tolerance, is rounding.
    pub(crate) fn is_rounding(&self, estimate: &Estimate) -> bool {
        estimate.rest.min(self.tolerance.to_f64()) <= NOISE * T::EPSILON.to_f64()
    }

    /// Writes an approximation of the residual of the polynomial, h γ_{s−2} + h γ_{s−1} of the estimated
    /// components and zero for others, to `out`. It has two terms because one of two successive coefficients
    /// may vanish.
    pub(crate) fn residual(&self, out: &mut [T]) {
        for (c, (out, &unit)) in out.iter_mut().zip(&self.inverse_units).enumerate() {
            let row = &self.coefficients[c * self.stride..][..self.s];
            let is_moving = unit > T::int(0);
            *out = if is_moving {
                row[self.s - 1] + row[self.s - 2]
            } else {
                T::int(0)
            };
        }
    }

    /// The largest component of `x` in the units of the last estimate.
    pub(crate) fn in_units(&self, x: &[T]) -> f64 {
        let sizes = x.iter().zip(&self.inverse_units);
        sizes.fold(0.0, |most, (&x, &unit)| most.max((x * unit).abs().to_f64()))
    }

    /// The part of this `error` of component c of the last step, of size `h`, that the `rounding` of ∇H does
    /// not explain, relative to the admissible error. Zero for components that are not estimated.
    pub(crate) fn in_tolerances(&self, c: usize, error: T, (h, rounding): (T, &[T])) -> f64 {
        let half = self.units.len() / 2;
        let of_force = rounding[(c + half) % (2 * half)];
        let beyond = error.abs() - T::int(ROUNDING) * h.abs() * of_force;
        if c % half >= self.m || beyond <= T::int(0) {
            return 0.0;
        }
        (beyond / self.allowed(c)).to_f64()
    }

    /// The admissible error of component c in the last step.
    fn allowed(&self, c: usize) -> T {
        match &self.allowed {
            Some(allowed) => allowed.relative[c] * self.units[c] + allowed.absolute[c],
            None => self.tolerance * self.units[c],
        }
    }

    /// h γ_s and h γ_{s+1}, from the residual of the polynomial with these coefficients at both ends of the
    /// step.
    fn beyond(&self, row: &[T], ends: [T; 2], is_inset: [bool; 2]) -> [T; 2] {
        let s = self.s;
        let at_end = |k: usize| T::int(2 * k as i64 + 1).sqrt();
        let [[even, odd], [even_end, odd_end]] = is_inset.map(|is_inset| {
            let mut sums = [T::int(0); 2];
            let values = &self.at_end[usize::from(is_inset)];
            for (k, (&x, &value)) in row.iter().zip(values).enumerate() {
                sums[k % 2] += x * value;
            }
            sums
        });
        let [start, end] = [ends[0] - (even - odd), ends[1] - (even_end + odd_end)];
        let (even, odd) = ((end + start) / T::int(2), (end - start) / T::int(2));
        let [first, second] = if s.is_multiple_of(2) {
            [even, odd]
        } else {
            [odd, even]
        };
        [first / at_end(s), second / at_end(s + 1)]
    }

    /// 1/z from the smaller one of the last two ratios w of coefficients, zero if their signs differ.
    /// Positions and momenta are each in units of the component that changes most.
    fn nearness(&self) -> f64 {
        let half = self.inverse_units.len() / 2;
        let units = [0, half].map(|from| {
            let moving = self.inverse_units[from..][..half].iter();
            let least = |a: T, &x: &T| if x > T::int(0) { a.min(x) } else { a };
            let unit = moving.fold(T::INFINITY, least);
            if unit.is_finite() { unit } else { T::int(0) }
        });
        let ratio = |k: usize| {
            let (mut across, mut along) = (0.0, 0.0);
            let groups = self.coefficients.chunks_exact(half * self.stride);
            for (rows, unit) in groups.zip(units) {
                for row in rows.chunks_exact(self.stride).take(self.m) {
                    let (x, before) = ((row[k] * unit).to_f64(), (row[k - 1] * unit).to_f64());
                    across += x * before;
                    along += before * before;
                }
            }
            if along > 0.0 { across / along } else { 0.0 }
        };
        let last = ratio(self.s - 1);
        let before = if self.s > 2 { ratio(self.s - 2) } else { last };
        let w = if last * before > 0.0 {
            last.abs().min(before.abs()).copysign(last)
        } else {
            0.0
        };
        2.0 * w / (1.0 + w * w)
    }
}

/// η for a method of degree s.
fn inset<T: Float>(s: usize) -> T {
    T::ratio(1, INSET * (s * s) as i64)
}
