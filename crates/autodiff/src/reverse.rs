//! The reverse sweep: ∂H/∂(every slot), from H down to the inputs.
//!
//! With w̄ the adjoint of a result w = f(x, y), every operand receives x̄ += w̄ ∂f/∂x. Results stand after
//! their operands, so one pass backwards over the runs does it. Cost: two to three evaluations of H, whatever the
//! number of inputs (Griewank, Walther 2008, section 3.3).
//!
//! At kinks: |x| has derivative 0 at 0, hypot has (0, 0) at the origin, min and max give all to their first argument
//! at a tie. √x has the derivative ∞ at 0. The derivative of xʸ by y is 0 where xʸ is 0.

use crate::op::Op;
use crate::tape::{Access, Run, Tape};
use equip_scalar::{Constant, Piecewise};

/// An exponent c with c − 1, both in a form that is cheap to read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exponent {
    pub(crate) c: Constant,
    pub(crate) less_one: Constant,
    pub(crate) is_zero: bool,
}

/// Adjoints of all slots after the constants, `values` being those of a replay.
#[rustfmt::skip]
pub(crate) fn reverse<S: Piecewise>(tape: &Tape, exponents: &[Exponent], values: &[S], adjoints: &mut [S]) {
    let number = |x: f64| S::constant(Constant::Double(x));
    let (zero, one) = (number(0.0), number(1.0));
    adjoints.fill(zero);
    adjoints[tape.root] = one;
    for run in tape.runs.iter().rev() {
        let (operands, rest) = adjoints.split_at_mut(run.slots.start);
        let results = &rest[..run.slots.len()];
        let step = Step { tape, run, values, operands, adjoints: results };
        match run.op {
            Op::Constant(_) | Op::Input(_) => {}
            Op::Sum(k) => step.sum(k as usize),
            Op::Add => step.binary(|_, _, _, w| w, |_, _, _, w| w),
            Op::Sub => step.binary(|_, _, _, w| w, |_, _, _, w| -w),
            Op::Mul => step.binary(|_, y, _, w| w * y, |x, _, _, w| w * x),
            Op::Div => step.binary(|_, y, _, w| w / y, |_, y, f, w| -(w / y * f)),
            Op::Square => step.unary(|x, _, w| { let half = w * x; half + half }),
            Op::Neg => step.unary(|_, _, w| -w),
            Op::Recip => step.unary(|_, f, w| -(w * f * f)),
            Op::Sqrt => step.unary(|_, f, w| w / (f + f)),
            Op::Powi(0) => {}
            Op::Powi(n) => {
                let factor = number(f64::from(n));
                match n {
                    3 => step.unary(|x, _, w| w * factor * (x * x)),
                    4 => step.unary(|x, _, w| w * factor * S::powi(x, 3)),
                    6 => step.unary(|x, _, w| w * factor * S::powi(x, 5)),
                    _ => step.unary(|x, _, w| w * factor * S::powi(x, n.saturating_sub(1))),
                }
            }
            Op::Powf(k) => {
                let Exponent { c, less_one, is_zero } = exponents[k as usize];
                let factor = S::constant(c);
                if !is_zero {
                    step.curved(|x, _, w| w * factor * S::powf(x, less_one));
                }
            }
            Op::Pow => step.listed(
                |x, y, _, w| w * y * S::pow(x, y - one),
                |x, _, f, w| w * S::where_nonzero(f * S::ln(x), f),
            ),
            Op::Abs => step.curved(|x, _, w| w * S::sign(x)),
            Op::Exp => step.curved(|_, f, w| w * f),
            Op::Ln => step.curved(|x, _, w| w / x),
            Op::ExpM1 => step.curved(|x, _, w| w * S::exp(x)),
            Op::Ln1p => step.curved(|x, _, w| w / (one + x)),
            Op::Sin => step.curved(|x, _, w| w * S::cos(x)),
            Op::Cos => step.curved(|x, _, w| -(w * S::sin(x))),
            Op::Tan => step.curved(|_, f, w| w * (one + f * f)),
            Op::Asin => step.curved(|x, _, w| w / S::sqrt((one - x) * (one + x))),
            Op::Acos => step.curved(|x, _, w| -(w / S::sqrt((one - x) * (one + x)))),
            Op::Atan => step.curved(|x, _, w| w / (one + x * x)),
            // Divided by the radius twice, where its square could overflow.
            Op::Atan2 => step.listed(
                |y, x, _, w| { let r = S::hypot(x, y); w * (x / r / r) },
                |y, x, _, w| { let r = S::hypot(x, y); -(w * (y / r / r)) },
            ),
            Op::Sinh => step.curved(|x, _, w| w * S::cosh(x)),
            Op::Cosh => step.curved(|x, _, w| w * S::sinh(x)),
            // 1/cosh² from e^{−|x|}: 1 − tanh² has no correct digit left from x = 19 on, and cosh overflows.
            Op::Tanh => step.curved(|x, _, w| {
                let u = S::exp(-S::abs(x));
                let sech = (u + u) / (one + u * u);
                w * (sech * sech)
            }),
            Op::Hypot => step.listed(
                |x, _, f, w| w * S::where_nonzero(x / f, f),
                |_, y, f, w| w * S::where_nonzero(y / f, f),
            ),
            Op::Min => step.listed(
                |x, y, _, w| w * S::at_most(x, y),
                |x, y, _, w| w * (one - S::at_most(x, y)),
            ),
            Op::Max => step.listed(
                |x, y, _, w| w * S::at_most(y, x),
                |x, y, _, w| w * (one - S::at_most(y, x)),
            ),
        }
    }
}

/// One run with what it reads and writes. Contributions are functions of the operands x and y, the result f and
/// its adjoint w.
struct Step<'a, S> {
    tape: &'a Tape,
    run: &'a Run,
    values: &'a [S],
    operands: &'a mut [S],
    adjoints: &'a [S],
}

impl<S: Piecewise> Step<'_, S> {
    #[inline(always)]
    fn binary(mut self, to_left: impl Fn(S, S, S, S) -> S, to_right: impl Fn(S, S, S, S) -> S) {
        if self.run.access == Access::Listed {
            return self.listed(to_left, to_right);
        }
        let slots = self.run.slots.clone();
        let left = self.tape.left[slots.start] as usize;
        let right = self.tape.right[slots.start] as usize;
        let [left_live, right_live] = self.run.live;
        match self.run.access {
            Access::FixedLeft => {
                if left_live {
                    self.gather(left, right, |x, y, f, w| to_left(y, x, f, w));
                }
                if right_live {
                    self.spread(right, left, |x, y, f, w| to_right(y, x, f, w));
                }
            }
            Access::FixedRight => {
                if left_live {
                    self.spread(left, right, to_left);
                }
                if right_live {
                    self.gather(right, left, to_right);
                }
            }
            _ => {
                if left_live {
                    self.slices(left, left, right, to_left);
                }
                if right_live {
                    self.slices(right, left, right, to_right);
                }
            }
        }
    }

    /// Operands x and y side by side, contributions side by side from `target` on.
    #[inline(always)]
    fn slices(&mut self, target: usize, x: usize, y: usize, to: impl Fn(S, S, S, S) -> S) {
        let n = self.run.slots.len();
        let targets = &mut self.operands[target..target + n];
        let (x, y) = (&self.values[x..x + n], &self.values[y..y + n]);
        let (f, w) = (&self.values[self.run.slots.clone()], &self.adjoints[..n]);
        for k in 0..n {
            targets[k] = targets[k] + to(x[k], y[k], f[k], w[k]);
        }
    }

    /// Operands side by side from `moving` on, which receive; the other one fixed.
    #[inline(always)]
    fn spread(&mut self, moving: usize, fixed: usize, to: impl Fn(S, S, S, S) -> S) {
        let n = self.run.slots.len();
        let targets = &mut self.operands[moving..moving + n];
        let (x, y) = (&self.values[moving..moving + n], self.values[fixed]);
        let (f, w) = (&self.values[self.run.slots.clone()], &self.adjoints[..n]);
        for k in 0..n {
            targets[k] = targets[k] + to(x[k], y, f[k], w[k]);
        }
    }

    /// Operands side by side from `moving` on; the fixed one receives the sum. `to` has the moving one first.
    #[inline(always)]
    fn gather(&mut self, fixed: usize, moving: usize, to: impl Fn(S, S, S, S) -> S) {
        let n = self.run.slots.len();
        let (x, y) = (&self.values[moving..moving + n], self.values[fixed]);
        let (f, w) = (&self.values[self.run.slots.clone()], &self.adjoints[..n]);
        let mut total = self.operands[fixed];
        for k in 0..n {
            total = total + to(x[k], y, f[k], w[k]);
        }
        self.operands[fixed] = total;
    }

    #[inline(always)]
    fn unary(mut self, to: impl Fn(S, S, S) -> S) {
        if self.run.access == Access::Slices {
            let x = self.tape.left[self.run.slots.start] as usize;
            self.slices(x, x, x, |x, _, f, w| to(x, f, w));
        } else {
            self.curved(to);
        }
    }

    #[inline(always)]
    fn curved(self, to: impl Fn(S, S, S) -> S) {
        let slots = self.run.slots.clone();
        let left = &self.tape.left[slots.clone()];
        for ((&i, &f), &w) in left.iter().zip(&self.values[slots]).zip(self.adjoints) {
            let i = i as usize;
            self.operands[i] = self.operands[i] + to(self.values[i], f, w);
        }
    }

    #[inline(always)]
    fn listed(self, to_left: impl Fn(S, S, S, S) -> S, to_right: impl Fn(S, S, S, S) -> S) {
        let slots = self.run.slots.clone();
        let [left_live, right_live] = self.run.live;
        let (left, right) = (
            &self.tape.left[slots.clone()],
            &self.tape.right[slots.clone()],
        );
        let results = self.values[slots].iter().zip(self.adjoints);
        for ((&i, &j), (&f, &w)) in left.iter().zip(right).zip(results) {
            let (i, j) = (i as usize, j as usize);
            let (x, y) = (self.values[i], self.values[j]);
            if left_live {
                self.operands[i] = self.operands[i] + to_left(x, y, f, w);
            }
            if right_live {
                self.operands[j] = self.operands[j] + to_right(x, y, f, w);
            }
        }
    }

    fn sum(self, k: usize) {
        let [w] = *self.adjoints else { return };
        for segment in &self.tape.segments[self.tape.sums[k].clone()] {
            let part = if segment.minus { -w } else { w };
            match segment.first {
                Some(first) => self.operands[first..first + segment.terms.len()]
                    .iter_mut()
                    .for_each(|x| *x = *x + part),
                None => self.tape.terms[segment.terms.clone()]
                    .iter()
                    .for_each(|&i| {
                        self.operands[i as usize] = self.operands[i as usize] + part;
                    }),
            }
        }
    }
}
