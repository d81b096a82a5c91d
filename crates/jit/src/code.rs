//! [`Code`]: a program as machine code, in memory that the processor may execute.

use crate::Program;
use crate::registers::allocate;
use crate::x86_64::{Vectors, encode};
use equip_scalar::{InstructionSet, Lanes};
use memmap2::{Mmap, MmapMut};

/// Rows of inputs and of results, constants, scratch, groups of lanes.
type Function =
    unsafe extern "sysv64" fn(*const f64, *mut f64, *const f64, *mut Lanes<8>, groups: usize);

/// Numbers between two rows from which on an address cannot reach the next.
const FARTHEST: usize = 1 << 28;

/// Machine code of a [`Program`] for rows of one length.
#[derive(Debug)]
pub struct Code {
    code: Mmap,
    constants: Vec<f64>,
    /// Numbers of the inputs that are read, and of the results that are written.
    inputs: usize,
    results: usize,
    stride: usize,
    lanes: usize,
    scratch: usize,
}

impl Code {
    /// Generates code for rows of `stride` doubles and this instruction set. `None` if this is impossible:
    /// without AVX2, for rows of several doubles whose number is not a multiple of 4, for rows too far apart
    /// for an address, or on a system that forbids generated code.
    ///
    /// Cost: 0.1 µs per operation, several times that if many values are live, and some 10 µs for the memory.
    pub fn new(program: &Program, set: InstructionSet, stride: usize) -> Option<Self> {
        let has_avx2 = InstructionSet::avx2().is_some_and(|avx2| avx2 <= set);
        let has_avx512 = InstructionSet::avx512() == Some(set);
        let vectors = match stride {
            0 | FARTHEST.. => return None,
            _ if has_avx512 && stride.is_multiple_of(8) => Vectors::Eight,
            _ if has_avx2 && stride.is_multiple_of(4) => Vectors::Four,
            1 if has_avx2 => Vectors::One,
            _ => return None,
        };
        let (instructions, slots) = allocate(program, vectors.registers());
        let bytes = encode(&instructions, vectors, stride)?;
        let mut memory = MmapMut::map_anon(bytes.len()).ok()?;
        memory.copy_from_slice(&bytes);
        Some(Code {
            code: memory.make_exec().ok()?,
            constants: program.constants.clone(),
            inputs: program.inputs.checked_mul(stride)?,
            results: program.results.checked_mul(stride)?,
            stride,
            lanes: vectors.lanes(),
            scratch: (slots * vectors.lanes()).div_ceil(8),
        })
    }

    /// The length of a row.
    #[inline]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The length of the scratch memory of a run.
    #[inline]
    pub fn scratch(&self) -> usize {
        self.scratch
    }

    /// Runs the program on the first `count` lanes of the rows, which are stored one after the other. Further
    /// lanes of the last vector are computed as well. All other lanes of the results are unchanged.
    ///
    /// # Panics
    /// If there are fewer rows than the program reads or writes, if `count` exceeds the length of a row, or
    /// if the scratch memory is too short.
    #[inline]
    pub fn run(&self, inputs: &[f64], results: &mut [f64], scratch: &mut [Lanes<8>], count: usize) {
        assert!(
            inputs.len() >= self.inputs
                && results.len() >= self.results
                && scratch.len() >= self.scratch
                && count <= self.stride,
            "{} inputs and {} results, in rows of {}, and {} vectors of scratch",
            self.inputs,
            self.results,
            self.stride,
            self.scratch
        );
        if count == 0 {
            return;
        }
        let groups = count.div_ceil(self.lanes);
        let (inputs, results) = (inputs.as_ptr(), results.as_mut_ptr());
        let (constants, scratch) = (self.constants.as_ptr(), scratch.as_mut_ptr());
        // SAFETY: the mapping is executable and as long as `self`, and holds a function of this type. It uses
        // instructions that the processor has (an `InstructionSet` is proof), reads the first `self.inputs`
        // numbers of inputs and all constants, and writes the first `self.results` numbers of results and
        // `self.scratch` vectors of scratch: in groups of lanes, which fill the rows, so that `count` ≤
        // stride keeps them inside. All this was just checked.
        #[allow(unsafe_code)]
        unsafe {
            let function: Function = std::mem::transmute(self.code.as_ptr());
            function(inputs, results, constants, scratch, groups);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Code;
    use crate::program::{Operation, Program, Value};
    use equip_scalar::{InstructionSet, Lanes};

    /// xorshift64*, seeded.
    struct Random(u64);

    impl Random {
        fn below(&mut self, n: usize) -> usize {
            self.0 ^= self.0 >> 12;
            self.0 ^= self.0 << 25;
            self.0 ^= self.0 >> 27;
            (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n
        }

        fn number(&mut self) -> f64 {
            (self.below(2001) as f64 - 1000.0) / 256.0
        }
    }

    /// Operands as far back as `reach`: the farther, the more values are alive at a time.
    fn random_program(random: &mut Random, rows: usize, length: usize, reach: usize) -> Program {
        let mut program = Program::new();
        let mut known: Vec<Value> = (0..rows).map(|row| program.input(row)).collect();
        known.extend((0..rows).map(|_| program.constant(random.number())));
        for _ in 0..length {
            let [a, b] = [(); 2].map(|()| {
                let back = random.below(reach.min(known.len()));
                known[known.len() - 1 - back]
            });
            known.push(match random.below(8) {
                0 | 1 => program.add(a, b),
                2 => program.sub(a, b),
                3 | 4 => program.mul(a, b),
                5 => program.div(a, b),
                6 => program.sqrt(a),
                _ if random.below(2) == 0 => program.neg(a),
                _ => program.abs(a),
            });
        }
        let mut rows: Vec<usize> = (0..length / 2).collect();
        while !rows.is_empty() {
            let row = rows.swap_remove(random.below(rows.len()));
            let value = known[random.below(known.len())];
            program.result(row, value);
        }
        program
    }

    /// The program in `f64`, operation by operation.
    fn evaluate(program: &Program, inputs: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut results = vec![0.0; program.results];
        let mut values: Vec<f64> = Vec::new();
        for &operation in &program.operations {
            use crate::program::Binary;
            let value = |k: u32| values[k as usize];
            let next = match operation {
                Operation::Input(row) => inputs(row as usize),
                Operation::Constant(k) => program.constants[k as usize],
                Operation::Sqrt(a) => value(a).sqrt(),
                Operation::Binary(op, a, b) => {
                    let (a, b) = (value(a), value(b));
                    match op {
                        Binary::Add => a + b,
                        Binary::Sub => a - b,
                        Binary::Mul => a * b,
                        Binary::Div => a / b,
                        Binary::And => f64::from_bits(a.to_bits() & b.to_bits()),
                        Binary::Xor => f64::from_bits(a.to_bits() ^ b.to_bits()),
                    }
                }
                Operation::Result { row, of } => {
                    results[row as usize] = value(of);
                    0.0
                }
            };
            values.push(next);
        }
        results
    }

    /// Compares lane by lane. Gives 1 if there is scratch.
    fn check(
        program: &Program,
        set: InstructionSet,
        stride: usize,
        count: usize,
        random: &mut Random,
    ) -> usize {
        let Some(code) = Code::new(program, set, stride) else {
            assert_eq!(set, InstructionSet::PORTABLE);
            return 0;
        };
        let numbers = (0..program.inputs * stride).map(|_| random.number());
        let inputs: Vec<f64> = numbers.collect();
        let mut scratch = vec![Lanes::splat(0.0); code.scratch()];
        let mut results = vec![f64::MAX; program.results * stride];
        code.run(&inputs, &mut results, &mut scratch, count);
        for lane in 0..count {
            let expected = evaluate(program, |row| inputs[row * stride + lane]);
            for (row, expected) in expected.into_iter().enumerate() {
                let found = results[row * stride + lane];
                let same =
                    found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
                assert!(same, "{set:?}, {stride}: row {row}, lane {lane}");
            }
        }
        usize::from(code.scratch() > 0)
    }

    /// With few and with many values alive, so that registers suffice or do not, on every instruction set.
    #[test]
    fn random_programs_have_the_bits_of_single_operations() {
        let mut random = Random(7);
        let mut with_scratch = 0;
        for (round, reach) in [3, 12, 40, 200].into_iter().cycle().take(200).enumerate() {
            let (rows, length) = (1 + random.below(30), 2 + random.below(400));
            let program = random_program(&mut random, rows, length, reach);
            for stride in [1, 4, 8, 16, 24] {
                let count = stride - round % 4.min(stride);
                for set in InstructionSet::available() {
                    with_scratch += check(&program, set, stride, count, &mut random);
                }
            }
        }
        assert!(with_scratch > 100 || InstructionSet::avx2().is_none());
    }

    /// A chain with constants that are the same, or not, with ends, and a flaw in the midst.
    fn chain(length: usize, own_constants: bool, flaw: usize) -> Program {
        let mut program = Program::new();
        let mut before = None;
        for row in 0..length {
            let (q, next) = (program.input(row), program.input(row + 1));
            let d = program.sub(next, q);
            let kappa = if own_constants {
                1.0 + row as f64
            } else {
                1.25
            };
            let kappa = program.constant(kappa);
            let linear = program.mul(kappa, d);
            let square = program.mul(d, d);
            let cubic = program.mul(square, d);
            let mut force = program.add(linear, cubic);
            if row == flaw {
                force = program.sqrt(force);
            }
            let other = before.replace(force);
            let total = other.map_or(force, |other| program.sub(other, force));
            program.result(row, total);
        }
        program
    }

    #[test]
    fn chains_have_the_bits_of_single_operations() {
        let mut random = Random(11);
        for (length, own_constants, flaw) in [
            (3, false, 9),
            (20, false, 30),
            (200, false, 400),
            (200, true, 400),
            (300, false, 140),
            (300, true, 295),
        ] {
            let program = chain(length, own_constants, flaw);
            for set in InstructionSet::available() {
                for stride in [1, 4, 8, 16] {
                    check(&program, set, stride, stride, &mut random);
                }
            }
        }
    }

    #[test]
    fn what_no_code_is_made_for() {
        let mut program = Program::new();
        let x = program.input(3);
        program.result(0, x);
        for set in InstructionSet::available() {
            assert!(Code::new(&program, set, 0).is_none());
            assert!(Code::new(&program, set, 6).is_none());
            assert!(Code::new(&program, InstructionSet::PORTABLE, 8).is_none());
            // Row 3 is 3 · 2^30 bytes away.
            assert!(Code::new(&program, set, 1 << 27).is_none());
            // 8 · 2^61 bytes are none.
            assert!(Code::new(&program, set, 1 << 61).is_none());
        }
    }

    #[test]
    #[should_panic(expected = "32 inputs")]
    fn rows_that_are_not_there() {
        let mut program = Program::new();
        let x = program.input(3);
        program.result(0, x);
        match Code::new(&program, InstructionSet::best(), 8) {
            Some(code) => code.run(&[0.0; 31], &mut [0.0; 8], &mut [], 8),
            None => panic!("no code to test 32 inputs with"),
        }
    }

    #[test]
    #[should_panic(expected = "row 1 is written twice")]
    fn a_row_that_is_written_already() {
        let mut program = Program::new();
        let (x, y) = (program.input(0), program.input(1));
        program.result(1, x);
        program.result(1, y);
    }

    #[test]
    #[should_panic(expected = "operand 5")]
    fn a_value_of_another_program() {
        Program::new().sqrt(Value(5));
    }
}
