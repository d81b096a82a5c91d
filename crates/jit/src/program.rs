//! [`Program`]: straight-line arithmetic, each operation on the results of earlier ones.

use std::collections::{HashMap, HashSet};

/// The result of an operation of a [`Program`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Value(pub(crate) u32);

/// An operation on two values. `And` and `Xor` are those of the bits, and have a constant to the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    And,
    Xor,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operation {
    /// A row of the inputs.
    Input(u32),
    /// An entry of the table of constants.
    Constant(u32),
    Binary(Binary, u32, u32),
    Sqrt(u32),
    /// Writes a value to a row of the results; has no value itself.
    Result {
        row: u32,
        of: u32,
    },
}

/// Straight-line arithmetic from rows of inputs to rows of results, in the order of execution.
///
/// Each operation is rounded separately, as in Rust.
///
/// # Panics
/// All methods that take a [`Value`], if it does not belong to this program. `input` and `result`, if the row
/// is 2³² − 1 or more.
#[derive(Debug, Clone, Default)]
pub struct Program {
    pub(crate) operations: Vec<Operation>,
    pub(crate) constants: Vec<f64>,
    /// Values of the constants, by their bits.
    known: HashMap<u64, Value>,
    /// Rows of inputs that are read, and of results that are written.
    pub(crate) inputs: usize,
    pub(crate) results: usize,
    written: HashSet<u32>,
}

impl Program {
    /// An empty program.
    pub fn new() -> Self {
        Self::default()
    }

    /// A row of the inputs.
    pub fn input(&mut self, row: usize) -> Value {
        let row = number_of(row);
        self.inputs = self.inputs.max(row as usize + 1);
        self.push(Operation::Input(row))
    }

    /// The same number in every lane. Numbers with the same bits are one value.
    pub fn constant(&mut self, x: f64) -> Value {
        let next = Value(self.operations.len() as u32);
        let value = *self.known.entry(x.to_bits()).or_insert(next);
        if value == next {
            self.constants.push(x);
            self.push(Operation::Constant(self.constants.len() as u32 - 1));
        }
        value
    }

    /// a + b.
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Add, a, b)
    }

    /// a − b.
    pub fn sub(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Sub, a, b)
    }

    /// a·b.
    pub fn mul(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Mul, a, b)
    }

    /// a/b.
    pub fn div(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Div, a, b)
    }

    /// −a.
    pub fn neg(&mut self, a: Value) -> Value {
        let sign = self.constant(-0.0);
        self.binary(Binary::Xor, a, sign)
    }

    /// |a|.
    pub fn abs(&mut self, a: Value) -> Value {
        let all_but_sign = self.constant(f64::from_bits(u64::MAX >> 1));
        self.binary(Binary::And, a, all_but_sign)
    }

    /// √a.
    pub fn sqrt(&mut self, a: Value) -> Value {
        let a = self.own(a);
        self.push(Operation::Sqrt(a))
    }

    /// Writes a row of the results.
    ///
    /// # Panics
    /// If the row has been written already.
    pub fn result(&mut self, row: usize, of: Value) {
        let (row, of) = (number_of(row), self.own(of));
        assert!(self.written.insert(row), "row {row} is written twice");
        self.results = self.results.max(row as usize + 1);
        self.push(Operation::Result { row, of });
    }

    fn binary(&mut self, op: Binary, a: Value, b: Value) -> Value {
        let (a, b) = (self.own(a), self.own(b));
        self.push(Operation::Binary(op, a, b))
    }

    fn own(&self, Value(k): Value) -> u32 {
        let known = self.operations.get(k as usize);
        assert!(
            known.is_some_and(|operation| !matches!(operation, Operation::Result { .. })),
            "operand {k} of a program of {} operations",
            self.operations.len()
        );
        k
    }

    fn push(&mut self, operation: Operation) -> Value {
        self.operations.push(operation);
        Value(self.operations.len() as u32 - 1)
    }
}

fn number_of(row: usize) -> u32 {
    assert!(row < u32::MAX as usize, "row {row} of a program");
    row as u32
}
