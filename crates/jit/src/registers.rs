//! Register allocation, for instructions of two operands, the second of which may be in memory.
//!
//! If no register is free, the value with the farthest next use is evicted [Belady 1966]. It is spilled to
//! memory unless it is there already, as inputs, constants and results are.

use crate::program::{Binary, Operation, Program};

impl Binary {
    /// Whether the operands may be exchanged, which leaves every bit of the result, but for which NaN it is.
    /// Not of `And` and `Xor`: of single doubles they read 16 bytes to the right, so that has to be a
    /// constant, which is read from a register.
    fn may_exchange(self) -> bool {
        matches!(self, Binary::Add | Binary::Mul)
    }
}

/// Where a number stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Memory {
    Input(u32),
    Constant(u32),
    Result(u32),
    Scratch(u32),
}

/// The second operand of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    Register(u8),
    Memory(Memory),
}

/// An instruction on registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Instruction {
    Load(u8, Memory),
    Store(Memory, u8),
    Binary(Binary, u8, u8, Source),
    Sqrt(u8, Source),
}

/// What the registers of a processor are like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Registers {
    pub(crate) count: usize,
    /// Constants, of which one number stands in memory, may be second operands from there.
    pub(crate) spreads_constants: bool,
}

impl Registers {
    /// Whether this can be a second operand from where it is.
    fn reads(self, memory: Memory) -> bool {
        self.spreads_constants || !matches!(memory, Memory::Constant(_))
    }
}

/// The instructions of a program, and how many numbers of scratch they need.
pub(crate) fn allocate(program: &Program, registers: Registers) -> (Vec<Instruction>, usize) {
    let mut allocation = Allocation::new(program, registers);
    for (i, &operation) in program.operations.iter().enumerate() {
        allocation.place(i, operation);
    }
    (allocation.instructions, allocation.slots)
}

/// After the last use.
const NEVER: u32 = u32::MAX;

struct Allocation {
    registers: Registers,
    /// For each operand of each operation the next operation that uses it; what is never used again is free.
    next_uses: Vec<[u32; 2]>,
    /// The next use of each value as things stand.
    next_use: Vec<u32>,
    register: Vec<Option<u8>>,
    memory: Vec<Option<Memory>>,
    /// Values in the registers.
    holders: Vec<Option<u32>>,
    free_slots: Vec<u32>,
    slots: usize,
    instructions: Vec<Instruction>,
}

impl Allocation {
    fn new(program: &Program, registers: Registers) -> Self {
        let count = program.operations.len();
        let mut next_use = vec![NEVER; count];
        let mut next_uses = vec![[NEVER; 2]; count];
        for (i, &operation) in program.operations.iter().enumerate().rev() {
            let is_done = matches!(operation, Operation::Result { .. }) || next_use[i] != NEVER;
            let operands = if is_done {
                operands(operation)
            } else {
                [None; 2]
            };
            for (k, x) in operands.into_iter().enumerate() {
                if let Some(x) = x {
                    next_uses[i][k] = next_use[x as usize];
                }
            }
            for x in operands.into_iter().flatten() {
                next_use[x as usize] = i as u32;
            }
        }
        Allocation {
            registers,
            next_uses,
            next_use,
            register: vec![None; count],
            memory: vec![None; count],
            holders: vec![None; registers.count],
            free_slots: Vec::new(),
            slots: 0,
            instructions: Vec::new(),
        }
    }

    fn place(&mut self, i: usize, operation: Operation) {
        match operation {
            Operation::Input(row) => self.memory[i] = Some(Memory::Input(row)),
            Operation::Constant(k) => self.memory[i] = Some(Memory::Constant(k)),
            // What nothing needs.
            Operation::Binary(..) | Operation::Sqrt(_) if self.next_use[i] == NEVER => {}
            Operation::Result { row, of } => {
                let from = self.loaded(of, &[]);
                self.instructions
                    .push(Instruction::Store(Memory::Result(row), from));
                self.memory[of as usize].get_or_insert(Memory::Result(row));
                self.free_registers(i, operation);
                self.free_slots(operation);
            }
            Operation::Sqrt(a) => {
                let source = self.source(a, self.next_uses[i][0], &[]);
                self.free_registers(i, operation);
                let result = self.give(i);
                self.instructions.push(Instruction::Sqrt(result, source));
                self.free_slots(operation);
            }
            Operation::Binary(op, a, b) => {
                let in_register = |x: u32| self.register[x as usize].is_some();
                let exchange = op.may_exchange() && !in_register(a) && in_register(b);
                let (x, y, next) = match exchange {
                    true => (b, a, self.next_uses[i][0]),
                    false => (a, b, self.next_uses[i][1]),
                };
                let left = self.loaded(x, &[y]);
                let right = self.source(y, next, &[x]);
                self.free_registers(i, operation);
                let result = self.give(i);
                let instruction = Instruction::Binary(op, result, left, right);
                self.instructions.push(instruction);
                self.free_slots(operation);
            }
        }
    }

    /// The register of a value that is needed in one; those of the values in `keep` stay.
    fn loaded(&mut self, x: u32, keep: &[u32]) -> u8 {
        if let Some(register) = self.register[x as usize] {
            return register;
        }
        let register = self.free_register(keep);
        self.hold(register, x);
        let memory = self.memory[x as usize];
        assert!(memory.is_some(), "a value is in a register or in memory");
        let load = memory.map(|memory| Instruction::Load(register, memory));
        self.instructions.extend(load);
        register
    }

    /// A second operand: from where it is, if it is not needed again while there is room.
    fn source(&mut self, x: u32, next_use: u32, keep: &[u32]) -> Source {
        if let Some(register) = self.register[x as usize] {
            return Source::Register(register);
        }
        let has_room = next_use != NEVER && self.holders.contains(&None);
        match self.memory[x as usize] {
            Some(memory) if !has_room && self.registers.reads(memory) => Source::Memory(memory),
            _ => Source::Register(self.loaded(x, keep)),
        }
    }

    /// A register for the result of operation i.
    fn give(&mut self, i: usize) -> u8 {
        let register = self.free_register(&[]);
        self.hold(register, i as u32);
        register
    }

    fn hold(&mut self, register: u8, x: u32) {
        self.holders[register as usize] = Some(x);
        self.register[x as usize] = Some(register);
    }

    fn free_register(&mut self, keep: &[u32]) -> u8 {
        if let Some(free) = self.holders.iter().position(Option::is_none) {
            return free as u8;
        }
        let held = self.holders.iter().enumerate();
        let candidates = held.filter_map(|(register, &x)| Some((register, x?)));
        let candidates = candidates.filter(|(_, x)| !keep.contains(x));
        let farthest = candidates.max_by_key(|&(_, x)| self.next_use[x as usize]);
        assert!(farthest.is_some(), "there are more registers than operands");
        let (register, x) = farthest.unwrap_or_default();
        if self.memory[x as usize].is_none() {
            let slot = self.free_slots.pop().unwrap_or_else(|| {
                self.slots += 1;
                self.slots as u32 - 1
            });
            let memory = Memory::Scratch(slot);
            self.memory[x as usize] = Some(memory);
            let store = Instruction::Store(memory, register as u8);
            self.instructions.push(store);
        }
        self.register[x as usize] = None;
        self.holders[register] = None;
        register as u8
    }

    /// The operands of operation i have been read: registers of those that are not needed again are free,
    /// also for its result.
    fn free_registers(&mut self, i: usize, operation: Operation) {
        for (k, x) in operands(operation).into_iter().enumerate() {
            let Some(x) = x.map(|x| x as usize) else {
                continue;
            };
            self.next_use[x] = self.next_uses[i][k];
            if self.next_use[x] == NEVER
                && let Some(register) = self.register[x].take()
            {
                self.holders[register as usize] = None;
            }
        }
    }

    /// So is their scratch, but only after the instruction: to make room for its result others are written
    /// before it.
    fn free_slots(&mut self, operation: Operation) {
        for x in operands(operation).into_iter().flatten() {
            if self.next_use[x as usize] == NEVER
                && let Some(Memory::Scratch(slot)) = self.memory[x as usize].take()
            {
                self.free_slots.push(slot);
            }
        }
    }
}

fn operands(operation: Operation) -> [Option<u32>; 2] {
    match operation {
        Operation::Input(_) | Operation::Constant(_) => [None, None],
        Operation::Sqrt(a) | Operation::Result { of: a, .. } => [Some(a), None],
        Operation::Binary(_, a, b) => [Some(a), Some(b)],
    }
}
