//! [`Expression`]: a formula, evaluated on the library's recording variables.

use crate::error::{FormulaError, SimulationError};
use crate::names::listed;
use crate::reader::{Instruction, read};
use crate::value::Value;
use equip::prelude::{Hamiltonian, Var};

/// A formula in the components of (q, p).
///
/// Names are q1 to qm and p1 to pm; with one degree of freedom also q and p, with two x, y, px, py, with
/// three x, y, z, px, py, pz. Functions are those of [`Var`].
///
/// ```
/// use equip_web::Expression;
/// let pendulum = Expression::read("p^2/2 - cos(q)", 1)?.hamiltonian()?;
/// assert_eq!(pendulum.evaluator().value(&[0.0, 2.0]), 1.0);
/// # Ok::<(), equip_web::SimulationError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Expression {
    m: usize,
    instructions: Vec<Instruction>,
}

impl Expression {
    /// The formula of a system with m degrees of freedom that a text has.
    ///
    /// # Errors
    /// [`FormulaError`], which names the character.
    pub fn read(text: &str, m: usize) -> Result<Self, FormulaError> {
        let instructions = read(text, m)?;
        Ok(Expression { m, instructions })
    }

    /// The value of a formula without variables, such as `2*pi/100`.
    ///
    /// # Errors
    /// [`FormulaError`], also if there is a variable.
    pub fn constant(text: &str) -> Result<f64, FormulaError> {
        match Self::read(text, 0)?.evaluate(&[], &[]) {
            Some(Value::Number(number)) if number.is_finite() => Ok(number),
            _ => Err(FormulaError::Number {
                text: text.to_owned(),
                at: 1,
            }),
        }
    }

    /// The formula as an energy.
    ///
    /// # Errors
    /// [`FormulaError::NoVariable`] if nothing in it varies; what the library does not accept.
    pub fn hamiltonian(&self) -> Result<Hamiltonian, SimulationError> {
        let varies = |instruction: &Instruction| matches!(instruction, Instruction::Component(_));
        if !self.instructions.iter().any(varies) {
            let names = listed(self.m);
            return Err(FormulaError::NoVariable { names }.into());
        }
        let energy = |q: &[Var], p: &[Var]| {
            let value = self.evaluate(q, p).unwrap_or(Value::Number(f64::NAN));
            value.recorded()
        };
        Ok(Hamiltonian::new(self.m, energy)?)
    }

    /// None of instructions that leave no value, which the reader does not make.
    fn evaluate(&self, q: &[Var], p: &[Var]) -> Option<Value> {
        let mut stack = Vec::new();
        for instruction in &self.instructions {
            let value = match *instruction {
                Instruction::Number(number) => Value::Number(number),
                Instruction::Component(i) => Value::Recorded(*q.iter().chain(p).nth(i)?),
                Instruction::Negate => stack.pop().map(Value::negated)?,
                Instruction::Operate(sign) => {
                    let second = stack.pop()?;
                    stack.pop()?.operate(sign, second)
                }
                Instruction::Call(function) => {
                    let second = match function.arguments() {
                        2 => Some(stack.pop()?),
                        _ => None,
                    };
                    Value::call(function, stack.pop()?, second)
                }
            };
            stack.push(value);
        }
        stack.pop()
    }
}
