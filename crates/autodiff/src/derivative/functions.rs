//! The derivatives of functions as operations, in forms that preserve accuracy.

use super::reverse::Reverse;
use crate::recording::op::Op;
use equip_scalar::{Constant, DoubleDouble};

impl Reverse<'_> {
    pub(super) fn one_plus(&mut self, x: u32) -> u32 {
        let one = self.number(1.0);
        self.apply(Op::Add, one, x)
    }

    pub(super) fn one_plus_square(&mut self, x: u32) -> u32 {
        let square = self.apply(Op::Square, x, x);
        self.one_plus(square)
    }

    /// (1 − x)(1 + x).
    pub(super) fn rest_of_square(&mut self, x: u32) -> u32 {
        let one = self.number(1.0);
        let (less, more) = (self.apply(Op::Sub, one, x), self.one_plus(x));
        self.apply(Op::Mul, less, more)
    }

    /// √((1 − x)(1 + x)).
    pub(super) fn root_of_rest(&mut self, x: u32) -> u32 {
        let rest = self.rest_of_square(x);
        self.apply(Op::Sqrt, rest, rest)
    }

    /// 1/cosh² from e^{−|x|}. From x = 19 on 1 − tanh² has no correct digit, and cosh overflows.
    pub(super) fn square_of_sech(&mut self, x: u32) -> u32 {
        let size = self.apply(Op::Abs, x, x);
        let down = self.apply(Op::Neg, size, size);
        let u = self.apply(Op::Exp, down, down);
        let (above, below) = (self.apply(Op::Add, u, u), self.one_plus_square(u));
        let sech = self.apply(Op::Div, above, below);
        self.apply(Op::Square, sech, sech)
    }

    pub(super) fn twice_over(&mut self, x: u32, r: u32) -> u32 {
        let once = self.apply(Op::Div, x, r);
        self.apply(Op::Div, once, r)
    }

    /// 1/y in the form in which users write it, so that theirs is reused.
    pub(super) fn reciprocal(&mut self, y: u32) -> u32 {
        let one = self.number(1.0);
        self.apply(Op::Div, one, y)
    }

    /// √((x − 1)(x + 1)), as two roots, since the product may overflow.
    pub(super) fn root_of_excess(&mut self, x: u32) -> u32 {
        let one = self.number(1.0);
        let (less, more) = (self.apply(Op::Sub, x, one), self.one_plus(x));
        let (less, more) = (
            self.apply(Op::Sqrt, less, less),
            self.apply(Op::Sqrt, more, more),
        );
        self.apply(Op::Mul, less, more)
    }

    /// 3 f².
    pub(super) fn three_squares(&mut self, f: u32) -> u32 {
        let three = self.number(3.0);
        let square = self.apply(Op::Square, f, f);
        self.apply(Op::Mul, three, square)
    }

    /// 2/√π exp(−x²).
    pub(super) fn bell(&mut self, x: u32) -> u32 {
        let square = self.apply(Op::Square, x, x);
        let down = self.apply(Op::Neg, square, square);
        let bell = self.apply(Op::Exp, down, down);
        self.times_constant(DoubleDouble::FRAC_2_SQRT_PI, bell)
    }

    pub(super) fn ln_2_times(&mut self, f: u32) -> u32 {
        self.times_constant(DoubleDouble::LN_2, f)
    }

    /// c(c − 1)·xᶜ⁻², where c is this entry of the table of constants; `None` if the factor is 0.
    pub(super) fn second_powf_derivative(&mut self, x: u32, c: u32) -> Option<u32> {
        let [one, two] = [1.0, 2.0].map(DoubleDouble::from);
        let c: DoubleDouble = self.recorder.constants[c as usize].to();
        let factor = c * (c - one);
        if factor == DoubleDouble::from(0.0) {
            return None;
        }
        let power = self.recorder.powf(x, Constant::from(c - two));
        Some(self.times_constant(factor, power))
    }

    fn times_constant(&mut self, c: DoubleDouble, x: u32) -> u32 {
        let c = self.recorder.constant(Constant::from(c));
        self.apply(Op::Mul, c, x)
    }
}
