//! Replays a tape: the values of all slots from those of the inputs.
//!
//! Each operation is the very function of [`Scalar`] the energy called, in its order: the result has every bit
//! of the energy evaluated directly. Cost: one evaluation of H.

use crate::op::Op;
use crate::tape::{Access, Run, Tape};
use equip_scalar::{Constant, Scalar};

/// Computes the given runs, the slots before them being known. `exponents` are those of the tape, in a form
/// that is cheap to read.
#[rustfmt::skip]
pub(crate) fn forward<S: Scalar>(tape: &Tape, runs: &[Run], exponents: &[Constant], values: &mut [S]) {
    for run in runs {
        let (known, rest) = values.split_at_mut(run.slots.start);
        let step = Step { tape, run, known, results: &mut rest[..run.slots.len()] };
        match run.op {
            Op::Constant(_) | Op::Input(_) => {}
            Op::Sum(k) => step.sum(k as usize),
            Op::Add => step.binary(|x, y| x + y),
            Op::Sub => step.binary(|x, y| x - y),
            Op::Mul => step.binary(|x, y| x * y),
            Op::Div => step.binary(|x, y| x / y),
            Op::Square => step.unary(|x| x * x),
            Op::Neg => step.unary(|x| -x),
            Op::Recip => step.unary(S::recip),
            Op::Sqrt => step.unary(S::sqrt),
            // A constant exponent lets the compiler unroll the multiplications.
            Op::Powi(3) => step.unary(|x| S::powi(x, 3)),
            Op::Powi(4) => step.unary(|x| S::powi(x, 4)),
            Op::Powi(6) => step.unary(|x| S::powi(x, 6)),
            Op::Powi(n) => step.unary(|x| S::powi(x, n)),
            Op::Powf(k) => { let c = exponents[k as usize]; step.listed(|x, _| S::powf(x, c)) }
            Op::Pow => step.listed(S::pow),
            Op::Abs => step.listed(|x, _| S::abs(x)),
            Op::Exp => step.listed(|x, _| S::exp(x)),
            Op::Ln => step.listed(|x, _| S::ln(x)),
            Op::ExpM1 => step.listed(|x, _| S::exp_m1(x)),
            Op::Ln1p => step.listed(|x, _| S::ln_1p(x)),
            Op::Sin => step.listed(|x, _| S::sin(x)),
            Op::Cos => step.listed(|x, _| S::cos(x)),
            Op::Tan => step.listed(|x, _| S::tan(x)),
            Op::Asin => step.listed(|x, _| S::asin(x)),
            Op::Acos => step.listed(|x, _| S::acos(x)),
            Op::Atan => step.listed(|x, _| S::atan(x)),
            Op::Atan2 => step.listed(S::atan2),
            Op::Sinh => step.listed(|x, _| S::sinh(x)),
            Op::Cosh => step.listed(|x, _| S::cosh(x)),
            Op::Tanh => step.listed(|x, _| S::tanh(x)),
            Op::Hypot => step.listed(S::hypot),
            Op::Min => step.listed(S::min),
            Op::Max => step.listed(S::max),
        }
    }
}

/// One run with what it reads and writes.
struct Step<'a, S> {
    tape: &'a Tape,
    run: &'a Run,
    known: &'a [S],
    results: &'a mut [S],
}

impl<S: Scalar> Step<'_, S> {
    #[inline(always)]
    fn binary(self, f: impl Fn(S, S) -> S) {
        let slots = self.run.slots.clone();
        let (left, right) = (
            self.tape.left[slots.start] as usize,
            self.tape.right[slots.start] as usize,
        );
        match self.run.access {
            Access::Listed => self.listed(f),
            Access::Slices => {
                let x = &self.known[left..left + slots.len()];
                let y = &self.known[right..right + slots.len()];
                for ((result, &x), &y) in self.results.iter_mut().zip(x).zip(y) {
                    *result = f(x, y);
                }
            }
            Access::FixedLeft => {
                let x = self.known[left];
                let y = &self.known[right..right + slots.len()];
                for (result, &y) in self.results.iter_mut().zip(y) {
                    *result = f(x, y);
                }
            }
            Access::FixedRight => {
                let x = &self.known[left..left + slots.len()];
                let y = self.known[right];
                for (result, &x) in self.results.iter_mut().zip(x) {
                    *result = f(x, y);
                }
            }
        }
    }

    #[inline(always)]
    fn unary(self, f: impl Fn(S) -> S) {
        let slots = self.run.slots.clone();
        if self.run.access == Access::Slices {
            let left = self.tape.left[slots.start] as usize;
            let x = &self.known[left..left + slots.len()];
            for (result, &x) in self.results.iter_mut().zip(x) {
                *result = f(x);
            }
        } else {
            self.listed(|x, _| f(x));
        }
    }

    #[inline(always)]
    fn listed(self, f: impl Fn(S, S) -> S) {
        let slots = self.run.slots.clone();
        let (left, right) = (&self.tape.left[slots.clone()], &self.tape.right[slots]);
        for ((result, &i), &j) in self.results.iter_mut().zip(left).zip(right) {
            *result = f(self.known[i as usize], self.known[j as usize]);
        }
    }

    fn sum(self, k: usize) {
        let mut total: Option<S> = None;
        let mut take = |x: S, minus: bool| {
            total = Some(match total {
                None => x,
                Some(total) if minus => total - x,
                Some(total) => total + x,
            });
        };
        for segment in &self.tape.segments[self.tape.sums[k].clone()] {
            match segment.first {
                Some(first) => self.known[first..first + segment.terms.len()]
                    .iter()
                    .for_each(|&x| take(x, segment.minus)),
                None => self.tape.terms[segment.terms.clone()]
                    .iter()
                    .for_each(|&i| take(self.known[i as usize], segment.minus)),
            }
        }
        if let (Some(total), [result]) = (total, self.results) {
            *result = total;
        }
    }
}
