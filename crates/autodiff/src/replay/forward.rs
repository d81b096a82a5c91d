//! Replays a tape: computes the values of all slots from the inputs.
//!
//! Each operation calls the same function of [`Scalar`](equip_scalar::Scalar) as the energy, in the same
//! order, so the result agrees bit for bit with a direct evaluation. Cost: one evaluation of the traced
//! operations.

use crate::recording::op::Op;
use crate::replay::tape::{Run, Tape};
use equip_scalar::{Constant, Float, Kernel, Scalar};

/// `result = $f` for all operations of a run with the operands `$x` and `$y`. It is a macro because closures
/// are not always inlined, and code that is not inlined into a kernel has no vector instructions.
macro_rules! each {
    ($step:ident, |$x:ident, $y:ident| $f:expr) => {{
        let (operands, before, results) = $step.split();
        for (result, &[i, j]) in results.iter_mut().zip(operands) {
            let ($x, $y) = (before[i as usize], before[j as usize]);
            *result = $f;
        }
    }};
    ($step:ident, |$x:ident| $f:expr) => {{
        let (operands, before, results) = $step.split();
        for (result, &[i, _]) in results.iter_mut().zip(operands) {
            let $x = before[i as usize];
            *result = $f;
        }
    }};
}

const fn half(n: i32) -> Constant {
    Constant::double(0.5 * n as f64)
}

/// Computes the given runs, whose operands are known. `exponents` are those of the tape, in a form that is
/// read quickly.
#[rustfmt::skip]
#[inline(always)]
pub(crate) fn forward<S: Scalar>(tape: &Tape, runs: &[Run], exponents: &[Constant], values: &mut [S]) {
    for run in runs {
        let step = Step { tape, run, values };
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
            Op::HalfPower(3) => each!(step, |x| S::powf(x, half(3))),
            Op::HalfPower(-3) => each!(step, |x| S::powf(x, half(-3))),
            Op::HalfPower(n) => { let c = half(n); each!(step, |x| S::powf(x, c)) }
            Op::Powf(k) => { let c = exponents[k as usize]; each!(step, |x| S::powf(x, c)) }
            Op::PowfDerivative(k) => { let c = exponents[k as usize]; each!(step, |x, f| S::powf_derivative(x, f, c)) }
            Op::Pow => each!(step, |x, y| S::pow(x, y)),
            Op::Abs => each!(step, |x| S::abs(x)),
            Op::Cbrt => each!(step, |x| S::cbrt(x)),
            Op::Exp2 => each!(step, |x| S::exp2(x)),
            Op::Exp => each!(step, |x| S::exp(x)),
            Op::Ln => each!(step, |x| S::ln(x)),
            Op::ExpM1 => each!(step, |x| S::exp_m1(x)),
            Op::Ln1p => each!(step, |x| S::ln_1p(x)),
            Op::Sin => each!(step, |x| S::sin(x)),
            Op::Cos => each!(step, |x| S::cos(x)),
            Op::Tan => each!(step, |x| S::tan(x)),
            Op::Asin => each!(step, |x| S::asin(x)),
            Op::Acos => each!(step, |x| S::acos(x)),
            Op::Atan => each!(step, |x| S::atan(x)),
            Op::Atan2 => each!(step, |y, x| S::atan2(y, x)),
            Op::Sinh => each!(step, |x| S::sinh(x)),
            Op::Cosh => each!(step, |x| S::cosh(x)),
            Op::Tanh => each!(step, |x| S::tanh(x)),
            Op::Asinh => each!(step, |x| S::asinh(x)),
            Op::Acosh => each!(step, |x| S::acosh(x)),
            Op::Atanh => each!(step, |x| S::atanh(x)),
            Op::Erf => each!(step, |x| S::erf(x)),
            Op::Erfc => each!(step, |x| S::erfc(x)),
            Op::Outside { function, orders } => {
                let f = &tape.functions[function as usize];
                each!(step, |x, y| S::outside(f, orders, [x, y]))
            }
            Op::Hypot => each!(step, |x, y| S::hypot(x, y)),
            Op::Min => each!(step, |x, y| S::min(x, y)),
            Op::Max => each!(step, |x, y| S::max(x, y)),
            Op::Sign => each!(step, |x| S::signum(x)),
            Op::AtMost => each!(step, |x, y| S::at_most(x, y)),
            Op::WhereNonzero => each!(step, |x, y| S::where_nonzero(x, y)),
        }
    }
}

/// A sum by compensated summation: the errors of all additions are computed exactly (Knuth, vol. 2, 4.2.2)
/// and added at the end. Four partial sums shorten the chain of dependent additions.
pub(crate) struct CompensatedSum<'a, T> {
    pub(crate) tape: &'a Tape,
    pub(crate) sum: usize,
    pub(crate) run: &'a Run,
    pub(crate) values: &'a mut [T],
}

impl<T: Float> Kernel for CompensatedSum<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let (tape, values) = (self.tape, &mut *self.values);
        let mut sums = Compensated::<T, 4>::zero();
        for segment in &tape.segments[tape.sums[self.sum].clone()] {
            let minus = segment.minus;
            let (fours, rest) = tape.terms[segment.terms.clone()].as_chunks::<4>();
            for [a, b, c, d] in fours {
                sums.add(&[*a, *b, *c, *d].map(|slot| values[slot as usize]), minus);
            }
            for &slot in rest {
                sums.add_to(0, values[slot as usize], minus);
            }
        }
        let mut total = Compensated::<T, 1>::zero();
        for (sum, error) in sums.sum.into_iter().zip(sums.error) {
            total.add_to(0, sum, false);
            total.error[0] += error;
        }
        values[self.run.slots.start] = total.sum[0] + total.error[0];
    }
}

/// Sums and their errors.
struct Compensated<T, const N: usize> {
    sum: [T; N],
    error: [T; N],
}

impl<T: Float, const N: usize> Compensated<T, N> {
    #[inline(always)]
    fn zero() -> Self {
        Compensated {
            sum: [T::int(0); N],
            error: [T::int(0); N],
        }
    }

    #[inline(always)]
    fn add(&mut self, terms: &[T; N], minus: bool) {
        for (i, &term) in terms.iter().enumerate() {
            self.add_to(i, term, minus);
        }
    }

    #[inline(always)]
    fn add_to(&mut self, i: usize, term: T, minus: bool) {
        let term = if minus { -term } else { term };
        let sum = self.sum[i];
        let total = sum + term;
        let added = total - sum;
        self.error[i] += (sum - (total - added)) + (term - added);
        self.sum[i] = total;
    }
}

/// One run, with its input and output.
struct Step<'a, S> {
    tape: &'a Tape,
    run: &'a Run,
    values: &'a mut [S],
}

impl<'a, S: Scalar> Step<'a, S> {
    /// The slots of the operands, all values before the results, and the results.
    #[inline(always)]
    fn split(self) -> (&'a [[u32; 2]], &'a [S], &'a mut [S]) {
        let (before, results) = self.values.split_at_mut(self.run.slots.start);
        let results = &mut results[..self.run.slots.len()];
        (&self.tape.operands[self.run.operands..], before, results)
    }

    #[inline(always)]
    fn sum(self, k: usize) {
        let mut total: Option<S> = None;
        for segment in &self.tape.segments[self.tape.sums[k].clone()] {
            let mut terms = self.tape.terms[segment.terms.clone()].iter();
            let mut sum = match total {
                Some(total) => total,
                None => match terms.next() {
                    Some(&first) => self.values[first as usize],
                    None => continue,
                },
            };
            if segment.minus {
                for &slot in terms {
                    sum = sum - self.values[slot as usize];
                }
            } else {
                for &slot in terms {
                    sum = sum + self.values[slot as usize];
                }
            }
            total = Some(sum);
        }
        if let Some(total) = total {
            self.values[self.run.slots.start] = total;
        }
    }
}
