//! Replays a tape: the values of all slots from those of the inputs.
//!
//! Each operation is the very function of [`Scalar`](equip_scalar::Scalar) the energy called, in its order: the result has
//! every bit of the energy evaluated directly. Cost: one evaluation of what was recorded.

use crate::op::Op;
use crate::tape::{Access, Run, Tape};
use equip_scalar::{Constant, Piecewise};

/// `$results[i] = $f` for all operations of a run, `$x` and `$y` being the operands. A macro and not a function of a closure:
/// closures are not always inlined, and what is not inlined into a kernel has no vector instructions.
macro_rules! each {
    ($step:ident, |$x:ident, $y:ident| $f:expr) => {{
        let (left, right) = ($step.left(), $step.right());
        match $step.run.access {
            Access::Listed => listed!($step, |$x, $y| $f),
            Access::Slices => {
                for ((result, &$x), &$y) in $step.results.iter_mut().zip(left).zip(right) {
                    *result = $f;
                }
            }
            Access::FixedLeft => {
                let $x = left[0];
                for (result, &$y) in $step.results.iter_mut().zip(right) {
                    *result = $f;
                }
            }
            Access::FixedRight => {
                let $y = right[0];
                for (result, &$x) in $step.results.iter_mut().zip(left) {
                    *result = $f;
                }
            }
        }
    }};
    ($step:ident, |$x:ident| $f:expr) => {
        if $step.run.access == Access::Slices {
            let left = $step.left();
            for (result, &$x) in $step.results.iter_mut().zip(left) {
                *result = $f;
            }
        } else {
            listed!($step, |$x| $f)
        }
    };
}

/// The same for operands that lie anywhere.
macro_rules! listed {
    ($step:ident, |$x:ident, $y:ident| $f:expr) => {{
        let slots = $step.run.slots.clone();
        let operands = $step.tape.left[slots.clone()]
            .iter()
            .zip(&$step.tape.right[slots]);
        for (result, (&i, &j)) in $step.results.iter_mut().zip(operands) {
            let ($x, $y) = ($step.known[i as usize], $step.known[j as usize]);
            *result = $f;
        }
    }};
    ($step:ident, |$x:ident| $f:expr) => {{
        let operands = &$step.tape.left[$step.run.slots.clone()];
        for (result, &i) in $step.results.iter_mut().zip(operands) {
            let $x = $step.known[i as usize];
            *result = $f;
        }
    }};
}

/// Computes the given runs, the slots before them being known. `exponents` are those of the tape, in a form
/// that is cheap to read.
#[rustfmt::skip]
#[inline(always)]
pub(crate) fn forward<S: Piecewise>(tape: &Tape, runs: &[Run], exponents: &[Constant], values: &mut [S]) {
    for run in runs {
        let (known, rest) = values.split_at_mut(run.slots.start);
        let step = Step { tape, run, known, results: &mut rest[..run.slots.len()] };
        match run.op {
            Op::Constant(_) | Op::Input(_) => {}
            Op::Sum(k) => step.sum(k as usize),
            Op::Add => each!(step, |x, y| x + y),
            Op::Sub => each!(step, |x, y| x - y),
            Op::Mul => each!(step, |x, y| x * y),
            Op::Div => each!(step, |x, y| x / y),
            Op::Square => each!(step, |x| x * x),
            Op::Neg => each!(step, |x| -x),
            Op::Recip => each!(step, |x| S::recip(x)),
            Op::Sqrt => each!(step, |x| S::sqrt(x)),
            // A constant exponent lets the compiler unroll the multiplications.
            Op::Powi(3) => each!(step, |x| S::powi(x, 3)),
            Op::Powi(4) => each!(step, |x| S::powi(x, 4)),
            Op::Powi(5) => each!(step, |x| S::powi(x, 5)),
            Op::Powi(6) => each!(step, |x| S::powi(x, 6)),
            Op::Powi(n) => each!(step, |x| S::powi(x, n)),
            Op::Powf(k) => { let c = exponents[k as usize]; listed!(step, |x| S::powf(x, c)) }
            Op::PowfSlope(k) => { let c = exponents[k as usize]; listed!(step, |x, f| S::powf_slope(x, f, c)) }
            Op::Pow => listed!(step, |x, y| S::pow(x, y)),
            Op::Abs => listed!(step, |x| S::abs(x)),
            Op::Exp => listed!(step, |x| S::exp(x)),
            Op::Ln => listed!(step, |x| S::ln(x)),
            Op::ExpM1 => listed!(step, |x| S::exp_m1(x)),
            Op::Ln1p => listed!(step, |x| S::ln_1p(x)),
            Op::Sin => listed!(step, |x| S::sin(x)),
            Op::Cos => listed!(step, |x| S::cos(x)),
            Op::Tan => listed!(step, |x| S::tan(x)),
            Op::Asin => listed!(step, |x| S::asin(x)),
            Op::Acos => listed!(step, |x| S::acos(x)),
            Op::Atan => listed!(step, |x| S::atan(x)),
            Op::Atan2 => listed!(step, |y, x| S::atan2(y, x)),
            Op::Sinh => listed!(step, |x| S::sinh(x)),
            Op::Cosh => listed!(step, |x| S::cosh(x)),
            Op::Tanh => listed!(step, |x| S::tanh(x)),
            Op::Hypot => listed!(step, |x, y| S::hypot(x, y)),
            Op::Min => listed!(step, |x, y| S::min(x, y)),
            Op::Max => listed!(step, |x, y| S::max(x, y)),
            Op::Sign => listed!(step, |x| S::sign(x)),
            Op::AtMost => listed!(step, |x, y| S::at_most(x, y)),
            Op::WhereNonzero => listed!(step, |x, y| S::where_nonzero(x, y)),
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

impl<'a, S: Piecewise> Step<'a, S> {
    /// The left operands from the first on, side by side.
    #[inline(always)]
    fn left(&self) -> &'a [S] {
        &self.known[self.tape.left[self.run.slots.start] as usize..]
    }

    #[inline(always)]
    fn right(&self) -> &'a [S] {
        &self.known[self.tape.right[self.run.slots.start] as usize..]
    }

    #[inline(always)]
    fn sum(self, k: usize) {
        let [result] = self.results else { return };
        let segments = self.tape.segments[self.tape.sums[k].clone()].iter();
        let mut total: Option<S> = None;
        for segment in segments {
            let terms = &self.tape.terms[segment.terms.clone()];
            let mut rest = terms;
            let mut sum = match (total, terms) {
                (Some(total), _) => total,
                (None, [first, others @ ..]) => {
                    rest = others;
                    self.known[*first as usize]
                }
                (None, []) => continue,
            };
            match (segment.first, segment.minus) {
                (Some(first), minus) => {
                    let skipped = terms.len() - rest.len();
                    for &x in &self.known[first + skipped..first + terms.len()] {
                        sum = if minus { sum - x } else { sum + x };
                    }
                }
                (None, minus) => {
                    for &i in rest {
                        let x = self.known[i as usize];
                        sum = if minus { sum - x } else { sum + x };
                    }
                }
            }
            total = Some(sum);
        }
        if let Some(total) = total {
            *result = total;
        }
    }
}
