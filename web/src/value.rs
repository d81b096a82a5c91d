//! Arithmetic on numbers and recorded variables. Numbers stay numbers, so that the exponent of a power is
//! known: an integer is one to [`Var::powi`].

use crate::functions::{Function, Kind};
use equip::prelude::Var;

#[derive(Debug, Clone, Copy)]
pub(crate) enum Value {
    Number(f64),
    Recorded(Var),
}

use Value::{Number, Recorded};

impl Value {
    /// As a variable of the recording.
    pub(crate) fn recorded(self) -> Var {
        match self {
            Number(x) => Var::from(x),
            Recorded(x) => x,
        }
    }

    pub(crate) fn negated(self) -> Value {
        match self {
            Number(x) => Number(-x),
            Recorded(x) => Recorded(-x),
        }
    }

    /// `self` and `other` with one of `+ - * / ^` between them.
    pub(crate) fn operate(self, sign: char, other: Value) -> Value {
        match (self, other, sign) {
            (Number(x), Number(y), '+') => Number(x + y),
            (Number(x), Number(y), '-') => Number(x - y),
            (Number(x), Number(y), '*') => Number(x * y),
            (Number(x), Number(y), '/') => Number(x / y),
            (Number(x), Number(y), _) => Number(x.powf(y)),
            (x, y, '+') => Recorded(x.recorded() + y.recorded()),
            (x, y, '-') => Recorded(x.recorded() - y.recorded()),
            (x, y, '*') => Recorded(x.recorded() * y.recorded()),
            (x, y, '/') => Recorded(x.recorded() / y.recorded()),
            (Recorded(x), Number(y), _) => Recorded(power(x, y)),
            (x, Recorded(y), _) => Recorded(x.recorded().pow(y)),
        }
    }

    /// The function of the arguments; of `second` too if it has two.
    pub(crate) fn call(function: &Function, first: Value, second: Option<Value>) -> Value {
        match (&function.kind, first, second.unwrap_or(Number(0.0))) {
            (Kind::One { number, .. }, Number(x), _) => Number(number(x)),
            (Kind::One { recorded, .. }, x, _) => Recorded(recorded(x.recorded())),
            (Kind::Two { number, .. }, Number(x), Number(y)) => Number(number(x, y)),
            (Kind::Two { recorded, .. }, x, y) => Recorded(recorded(x.recorded(), y.recorded())),
        }
    }
}

fn power(x: Var, exponent: f64) -> Var {
    let is_integer = exponent.fract() == 0.0 && exponent.abs() <= f64::from(i32::MAX);
    match is_integer {
        true => x.powi(exponent as i32),
        false => x.powf(exponent),
    }
}
