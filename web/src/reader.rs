//! A recursive-descent reader.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = factor { ("*" | "/") factor }
//! factor  = ("+" | "-") factor | operand [ "^" factor ]
//! operand = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! So −q^2 is −(q^2), and 2^3^2 is 2^(3^2). The result is in postfix order: long sums need no recursion to be
//! evaluated.

use crate::error::FormulaError;
use crate::functions::{Function, function, in_place_of};
use crate::names::{component, listed};
use crate::tokens::{Token, tokens};
use std::f64::consts::PI;

/// Most levels of parentheses, signs and powers within each other.
const MOST_LEVELS: usize = 100;

/// What a formula does to a stack of values.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Instruction {
    Number(f64),
    /// A component of (q, p).
    Component(usize),
    Negate,
    Operate(char),
    Call(&'static Function),
}

/// The instructions of a formula of m degrees of freedom.
pub(crate) fn read(text: &str, m: usize) -> Result<Vec<Instruction>, FormulaError> {
    let mut reader = Reader {
        tokens: tokens(text)?,
        next: 0,
        m,
        level: 0,
        instructions: Vec::new(),
    };
    reader.sum()?;
    let (token, at) = reader.peek();
    match token {
        Token::End => Ok(reader.instructions),
        Token::Sign(')') => Err(FormulaError::NotOpened { at }),
        Token::Sign(',') => Err(FormulaError::Comma { at }),
        before => Err(FormulaError::MissingOperator {
            before: before.to_string(),
            at,
        }),
    }
}

struct Reader {
    tokens: Vec<(Token, usize)>,
    next: usize,
    m: usize,
    level: usize,
    instructions: Vec<Instruction>,
}

impl Reader {
    fn peek(&self) -> (Token, usize) {
        self.tokens[self.next.min(self.tokens.len() - 1)].clone()
    }

    /// Takes the next token if it is one of these signs.
    fn take(&mut self, signs: &[char]) -> Option<char> {
        match self.peek() {
            (Token::Sign(sign), _) if signs.contains(&sign) => {
                self.next += 1;
                Some(sign)
            }
            _ => None,
        }
    }

    fn sum(&mut self) -> Result<(), FormulaError> {
        self.product()?;
        while let Some(sign) = self.take(&['+', '-']) {
            self.product()?;
            self.instructions.push(Instruction::Operate(sign));
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), FormulaError> {
        self.factor()?;
        while let Some(sign) = self.take(&['*', '/']) {
            self.factor()?;
            self.instructions.push(Instruction::Operate(sign));
        }
        Ok(())
    }

    fn factor(&mut self) -> Result<(), FormulaError> {
        let (most, (_, at)) = (MOST_LEVELS, self.peek());
        if self.level == most {
            return Err(FormulaError::TooDeep { at, most });
        }
        self.level += 1;
        if let Some(sign) = self.take(&['+', '-']) {
            self.factor()?;
            if sign == '-' {
                self.instructions.push(Instruction::Negate);
            }
        } else {
            self.operand()?;
            if let Some(sign) = self.take(&['^']) {
                self.factor()?;
                self.instructions.push(Instruction::Operate(sign));
            }
        }
        self.level -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), FormulaError> {
        let (token, at) = self.peek();
        self.next += 1;
        match token {
            Token::Number(number) => self.instructions.push(Instruction::Number(number)),
            Token::Name(name) => self.name(name, at)?,
            Token::Sign('(') => {
                self.sum()?;
                self.close(at)?;
            }
            before => {
                let before = before.to_string();
                return Err(FormulaError::MissingOperand { before, at });
            }
        }
        Ok(())
    }

    /// A variable, π or a call.
    fn name(&mut self, name: String, at: usize) -> Result<(), FormulaError> {
        let names = listed(self.m);
        let is_call = self.peek().0 == Token::Sign('(');
        let instruction = match (component(&name, self.m), function(&name)) {
            (Some(component), _) => Instruction::Component(component),
            (None, Some(function)) if is_call => return self.call(function, at),
            (None, Some(Function { name, .. })) => {
                return Err(FormulaError::NoArgument { name, at });
            }
            (None, None) if name == "pi" => Instruction::Number(PI),
            (None, None) if is_call => {
                let instead = in_place_of(&name);
                return Err(FormulaError::UnknownFunction { name, at, instead });
            }
            (None, None) => return Err(FormulaError::UnknownName { name, at, names }),
        };
        self.instructions.push(instruction);
        Ok(())
    }

    fn call(&mut self, function: &'static Function, at: usize) -> Result<(), FormulaError> {
        let (_, opened) = self.peek();
        self.next += 1;
        self.sum()?;
        let mut found = 1;
        while self.take(&[',']).is_some() {
            self.sum()?;
            found += 1;
        }
        self.close(opened)?;
        let (name, expected) = (function.name, function.arguments());
        if found != expected {
            return Err(FormulaError::Arguments {
                name,
                at,
                expected,
                found,
            });
        }
        self.instructions.push(Instruction::Call(function));
        Ok(())
    }

    /// Takes the parenthesis that closes the one at character `opened`.
    fn close(&mut self, opened: usize) -> Result<(), FormulaError> {
        if self.take(&[')']).is_some() {
            return Ok(());
        }
        match self.peek() {
            (Token::End, _) => Err(FormulaError::NotClosed { at: opened }),
            (Token::Sign(','), at) => Err(FormulaError::Comma { at }),
            (before, at) => Err(FormulaError::MissingOperator {
                before: before.to_string(),
                at,
            }),
        }
    }
}
