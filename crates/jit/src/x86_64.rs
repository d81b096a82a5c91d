//! Instructions as bytes, for x86-64 with AVX2 or AVX-512, on one, four or eight doubles at once. iced-x86
//! encodes them.
//!
//! Arguments of the code [System V ABI]: rows of inputs in rdi, rows of results in rsi, constants in rdx,
//! scratch memory in rcx, number of groups in r8; r9 is the loop counter. All vector registers are available.

use crate::program::Binary;
use crate::registers::{self, Memory, Registers, Source};
use iced_x86::{Code, Encoder, IcedError, Instruction, MemoryOperand, Register};

/// Vectors of one width.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Vectors {
    /// One double.
    One,
    /// Four doubles, AVX2.
    Four,
    /// Eight doubles, AVX-512.
    Eight,
}

impl Vectors {
    pub(crate) fn lanes(self) -> usize {
        match self {
            Vectors::One => 1,
            Vectors::Four => 4,
            Vectors::Eight => 8,
        }
    }

    pub(crate) fn registers(self) -> Registers {
        match self {
            Vectors::One | Vectors::Four => Registers {
                count: 16,
                spreads_constants: false,
            },
            Vectors::Eight => Registers {
                count: 32,
                spreads_constants: true,
            },
        }
    }

    fn register(self, k: u8) -> Register {
        let first = match self {
            Vectors::One => Register::XMM0,
            Vectors::Four => Register::YMM0,
            Vectors::Eight => Register::ZMM0,
        };
        first + u32::from(k)
    }

    fn binary(self, op: Binary) -> Code {
        match (self, op) {
            (Vectors::One, Binary::Add) => Code::VEX_Vaddsd_xmm_xmm_xmmm64,
            (Vectors::One, Binary::Sub) => Code::VEX_Vsubsd_xmm_xmm_xmmm64,
            (Vectors::One, Binary::Mul) => Code::VEX_Vmulsd_xmm_xmm_xmmm64,
            (Vectors::One, Binary::Div) => Code::VEX_Vdivsd_xmm_xmm_xmmm64,
            (Vectors::One, Binary::And) => Code::VEX_Vandpd_xmm_xmm_xmmm128,
            (Vectors::One, Binary::Xor) => Code::VEX_Vxorpd_xmm_xmm_xmmm128,
            (Vectors::Four, Binary::Add) => Code::VEX_Vaddpd_ymm_ymm_ymmm256,
            (Vectors::Four, Binary::Sub) => Code::VEX_Vsubpd_ymm_ymm_ymmm256,
            (Vectors::Four, Binary::Mul) => Code::VEX_Vmulpd_ymm_ymm_ymmm256,
            (Vectors::Four, Binary::Div) => Code::VEX_Vdivpd_ymm_ymm_ymmm256,
            (Vectors::Four, Binary::And) => Code::VEX_Vandpd_ymm_ymm_ymmm256,
            (Vectors::Four, Binary::Xor) => Code::VEX_Vxorpd_ymm_ymm_ymmm256,
            (Vectors::Eight, Binary::Add) => Code::EVEX_Vaddpd_zmm_k1z_zmm_zmmm512b64_er,
            (Vectors::Eight, Binary::Sub) => Code::EVEX_Vsubpd_zmm_k1z_zmm_zmmm512b64_er,
            (Vectors::Eight, Binary::Mul) => Code::EVEX_Vmulpd_zmm_k1z_zmm_zmmm512b64_er,
            (Vectors::Eight, Binary::Div) => Code::EVEX_Vdivpd_zmm_k1z_zmm_zmmm512b64_er,
            (Vectors::Eight, Binary::And) => Code::EVEX_Vandpd_zmm_k1z_zmm_zmmm512b64,
            (Vectors::Eight, Binary::Xor) => Code::EVEX_Vxorpd_zmm_k1z_zmm_zmmm512b64,
        }
    }

    fn sqrt(self) -> Code {
        match self {
            Vectors::One => Code::VEX_Vsqrtsd_xmm_xmm_xmmm64,
            Vectors::Four => Code::VEX_Vsqrtpd_ymm_ymmm256,
            Vectors::Eight => Code::EVEX_Vsqrtpd_zmm_k1z_zmmm512b64_er,
        }
    }

    fn load(self) -> Code {
        match self {
            Vectors::One => Code::VEX_Vmovsd_xmm_m64,
            Vectors::Four => Code::VEX_Vmovupd_ymm_ymmm256,
            Vectors::Eight => Code::EVEX_Vmovupd_zmm_k1z_zmmm512,
        }
    }

    /// The same number in every lane.
    fn spread(self) -> Code {
        match self {
            Vectors::One => self.load(),
            Vectors::Four => Code::VEX_Vbroadcastsd_ymm_m64,
            Vectors::Eight => Code::EVEX_Vbroadcastsd_zmm_k1z_xmmm64,
        }
    }

    fn store(self) -> Code {
        match self {
            Vectors::One => Code::VEX_Vmovsd_m64_xmm,
            Vectors::Four => Code::VEX_Vmovupd_ymmm256_ymm,
            Vectors::Eight => Code::EVEX_Vmovupd_zmmm512_k1z_zmm,
        }
    }
}

/// The code for rows of `stride` doubles: group after group of lanes. `None` if rows are too far from each
/// other for an address.
pub(crate) fn encode(
    instructions: &[registers::Instruction],
    vectors: Vectors,
    stride: usize,
) -> Option<Vec<u8>> {
    Assembler::new(vectors, stride).function(instructions).ok()
}

struct Assembler {
    encoder: Encoder,
    vectors: Vectors,
    stride: usize,
    length: u64,
}

impl Assembler {
    fn new(vectors: Vectors, stride: usize) -> Self {
        Assembler {
            encoder: Encoder::new(64),
            vectors,
            stride,
            length: 0,
        }
    }

    fn function(mut self, instructions: &[registers::Instruction]) -> Result<Vec<u8>, IcedError> {
        let start = self.length;
        for &instruction in instructions {
            let instruction = self.instruction(instruction)?;
            self.put(instruction)?;
        }
        let lanes = self.vectors.lanes();
        if self.stride > lanes {
            let bytes = 8 * lanes as i32;
            for row in [Register::RDI, Register::RSI] {
                self.put(Instruction::with2(Code::Add_rm64_imm8, row, bytes)?)?;
            }
            self.put(Instruction::with2(Code::Sub_rm64_imm8, Register::R8, 1)?)?;
            self.put(Instruction::with_branch(Code::Jne_rel32_64, start)?)?;
        }
        if lanes > 1 {
            self.put(Instruction::with(Code::VEX_Vzeroupper))?;
        }
        self.put(Instruction::with(Code::Retnq))?;
        Ok(self.encoder.take_buffer())
    }

    fn put(&mut self, instruction: Instruction) -> Result<(), IcedError> {
        self.length += self.encoder.encode(&instruction, self.length)? as u64;
        Ok(())
    }

    fn instruction(&self, instruction: registers::Instruction) -> Result<Instruction, IcedError> {
        let v = self.vectors;
        match instruction {
            registers::Instruction::Load(to, from @ Memory::Constant(_)) => {
                Instruction::with2(v.spread(), v.register(to), self.address(from))
            }
            registers::Instruction::Load(to, from) => {
                Instruction::with2(v.load(), v.register(to), self.address(from))
            }
            registers::Instruction::Store(to, from) => {
                Instruction::with2(v.store(), self.address(to), v.register(from))
            }
            registers::Instruction::Sqrt(to, from) => {
                let (code, to) = (v.sqrt(), v.register(to));
                match (v, from) {
                    // The second operand is where what stands beside the number comes from.
                    (Vectors::One, Source::Register(from)) => {
                        Instruction::with3(code, to, v.register(from), v.register(from))
                    }
                    (Vectors::One, Source::Memory(from)) => {
                        Instruction::with3(code, to, to, self.operand(from))
                    }
                    (_, Source::Register(from)) => Instruction::with2(code, to, v.register(from)),
                    (_, Source::Memory(from)) => Instruction::with2(code, to, self.operand(from)),
                }
            }
            registers::Instruction::Binary(op, to, left, right) => {
                let (code, to, left) = (v.binary(op), v.register(to), v.register(left));
                let reads_more = matches!((v, op), (Vectors::One, Binary::And | Binary::Xor));
                assert!(
                    !reads_more || matches!(right, Source::Register(_)),
                    "no more is read than there is"
                );
                match right {
                    Source::Register(right) => {
                        Instruction::with3(code, to, left, v.register(right))
                    }
                    Source::Memory(right) => {
                        Instruction::with3(code, to, left, self.operand(right))
                    }
                }
            }
        }
    }

    /// As second operand of arithmetic: a constant is spread over the lanes.
    fn operand(&self, memory: Memory) -> MemoryOperand {
        MemoryOperand {
            is_broadcast: matches!(memory, Memory::Constant(_)),
            ..self.address(memory)
        }
    }

    fn address(&self, memory: Memory) -> MemoryOperand {
        let (base, index, stride) = match memory {
            Memory::Input(row) => (Register::RDI, row, self.stride),
            Memory::Result(row) => (Register::RSI, row, self.stride),
            Memory::Constant(k) => (Register::RDX, k, 1),
            Memory::Scratch(slot) => (Register::RCX, slot, self.vectors.lanes()),
        };
        let bytes = i64::from(index) * (size_of::<f64>() * stride) as i64;
        MemoryOperand::with_base_displ(base, bytes)
    }
}
