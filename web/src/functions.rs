//! The functions that a formula may call: those of the library's variables, by the same names.

use equip::prelude::Var;
use equip::scalar::Num;

/// A function of one or of two arguments, of numbers and of recorded variables.
#[derive(Debug)]
pub(crate) struct Function {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
}

#[derive(Debug)]
pub(crate) enum Kind {
    One {
        number: fn(f64) -> f64,
        recorded: fn(Var) -> Var,
    },
    Two {
        number: fn(f64, f64) -> f64,
        recorded: fn(Var, Var) -> Var,
    },
}

macro_rules! functions {
    ($($one:ident)*; $($two:ident)*) => {
        &[
            $(Function {
                name: stringify!($one),
                kind: Kind::One { number: |x| Num(x).$one().0, recorded: |x| x.$one() },
            },)*
            $(Function {
                name: stringify!($two),
                kind: Kind::Two {
                    number: |x, y| Num(x).$two(Num(y)).0,
                    recorded: |x, y| x.$two(y),
                },
            },)*
        ]
    };
}

const ALL: &[Function] = functions!(
    sqrt cbrt exp exp2 ln log10 sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh abs erf erfc;
    atan2 hypot min max
);

pub(crate) fn function(name: &str) -> Option<&'static Function> {
    ALL.iter().find(|function| function.name == name)
}

/// What to write in place of a function that is not there.
pub(crate) fn in_place_of(name: &str) -> String {
    match name {
        "log" => "ln for the natural logarithm, or log10".to_owned(),
        "pow" => "the power as x^y".to_owned(),
        _ => {
            let names: Vec<&str> = ALL.iter().map(|function| function.name).collect();
            format!("one of {}; a product needs *", names.join(", "))
        }
    }
}

impl Function {
    /// Number of arguments.
    pub(crate) fn arguments(&self) -> usize {
        match self.kind {
            Kind::One { .. } => 1,
            Kind::Two { .. } => 2,
        }
    }
}
