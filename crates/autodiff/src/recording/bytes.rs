//! A recording as bytes, and back: every node in its place, so that H and its derivatives keep every bit.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | [`FORMAT`] |
//! | 8 | checksum of the rest: FNV-1a |
//! | | for each recording: inputs, lengths of the three lists, root; constants, functions, operations |
//!
//! The least significant byte of a number is the first. An operation is its code, its payload if it has one,
//! and its operands; components of the state stand before all others and are not written. Bytes come from
//! anywhere: the reader compares every count with the bytes that are left before it reserves memory, so that
//! it takes less than 100 times the memory of the bytes, and 10 MB for components that no operation needs.

use crate::error::{BuildError, BytesError};
use crate::recording::op::{Node, Op};
use crate::recording::recorder::{MOST, Recorder, Recording};
use equip_scalar::{Constant, Outside, Words, Written, ratio};
use std::convert::Infallible;
use std::sync::Arc;

const MAGIC: [u8; 8] = *b"equip H\n";
const FORMAT: u32 = 1;
const HEAD: usize = MAGIC.len() + 4 + 8;

/// Components of a state that need no bytes of their own. Of more, H depends on a good part: each of these is
/// an operand, which is four bytes.
const FREE_COMPONENTS: usize = 1 << 16;
const COMPONENT: usize = 4;
/// Fewest bytes of a constant, of a function and of an operation.
const SHORTEST: [usize; 3] = [9, 8, 5];
const LENGTHS: [usize; 2] = [4, 6]; // doubles of an extended constant up to 212 bits, and beyond

/// Operations without a payload; the place here is the code. Another order is another format.
const PLAIN: [Op; 37] = [
    Op::Add,
    Op::Sub,
    Op::Mul,
    Op::Square,
    Op::Div,
    Op::Neg,
    Op::Recip,
    Op::Sqrt,
    Op::Cbrt,
    Op::Abs,
    Op::Pow,
    Op::Exp,
    Op::Exp2,
    Op::Ln,
    Op::ExpM1,
    Op::Ln1p,
    Op::Sin,
    Op::Cos,
    Op::Tan,
    Op::Asin,
    Op::Acos,
    Op::Atan,
    Op::Atan2,
    Op::Sinh,
    Op::Cosh,
    Op::Tanh,
    Op::Asinh,
    Op::Acosh,
    Op::Atanh,
    Op::Erf,
    Op::Erfc,
    Op::Hypot,
    Op::Min,
    Op::Max,
    Op::Sign,
    Op::AtMost,
    Op::WhereNonzero,
];

/// Codes of operations with a payload.
const CONSTANT: u8 = 200;
const POWI: u8 = 201;
const POWF: u8 = 202;
const HALF_POWER: u8 = 203;
const OUTSIDE: u8 = 204;

/// Highest order of a derivative within H; its own derivatives are a few more.
const MOST_ORDER: u8 = 15;

/// Makes the function of which [`Outside::to_bytes`] made the bytes.
pub(crate) type Functions<'a> = &'a dyn Fn(&[u8]) -> Option<Arc<dyn Outside>>;

pub(crate) fn write(recordings: &[&Recording]) -> Result<Vec<u8>, BytesError> {
    let mut content = vec![recordings.len() as u8];
    for recording in recordings {
        let before = content.len();
        write_recording(recording, &mut content, |function| {
            let not_data = || BytesError::NotData {
                function: format!("{function:?}"),
            };
            function.to_bytes().ok_or_else(not_data)
        })?;
        let components = recording.operations.inputs;
        // Five counts stand before what the reader compares with them.
        if !is_room_for(components, content.len() - before - 5 * 4) {
            return Err(BytesError::ComponentsNotUsed { components });
        }
    }
    let mut bytes = Vec::with_capacity(HEAD + content.len());
    bytes.extend(MAGIC);
    bytes.extend(FORMAT.to_le_bytes());
    bytes.extend(checksum(&content).to_le_bytes());
    bytes.extend(content);
    Ok(bytes)
}

/// The recordings of one energy: H, and H(t, q, p) alone if it depends on time.
pub(crate) fn read(
    bytes: &[u8],
    functions: Functions<'_>,
) -> Result<(Recording, Option<Recording>), BytesError> {
    let mut head = Reader(bytes);
    if head.take() != Ok(MAGIC) {
        return Err(BytesError::NotAnEnergy);
    }
    let found = u32::from_le_bytes(head.take()?);
    if found != FORMAT {
        let known = FORMAT;
        return Err(BytesError::Format { found, known });
    }
    let sum = u64::from_le_bytes(head.take()?);
    if sum != checksum(head.0) {
        return Err(damaged("their checksum is not that of their content"));
    }
    let mut content = head;
    let count = content.byte()?;
    if !(1..=2).contains(&count) {
        return Err(damaged(NOT_ONE_ENERGY));
    }
    let energy = content.recording(functions, None)?;
    let inputs = Some(energy.operations.inputs);
    let alone = (count == 2).then(|| content.recording(functions, inputs));
    let alone = alone.transpose()?;
    if !content.0.is_empty() {
        return Err(damaged("there are too many"));
    }
    Ok((energy, alone))
}

const NOT_ONE_ENERGY: &str = "there are not the recordings of one energy";

/// Whether a recording of so many bytes may have so many components.
fn is_room_for(components: usize, bytes: usize) -> bool {
    components <= FREE_COMPONENTS.max(bytes / COMPONENT)
}

/// The checksum of the formula: operations, constants and tables. Closures from outside count as one.
pub(crate) fn formula_checksum(recording: &Recording) -> u64 {
    let mut content = Vec::new();
    let data =
        |function: &dyn Outside| Ok::<_, Infallible>(function.to_bytes().unwrap_or_default());
    let Ok(()) = write_recording(recording, &mut content, data);
    checksum(&content)
}

/// A recording, with what is `data` of its functions from outside.
fn write_recording<E>(
    recording: &Recording,
    bytes: &mut Vec<u8>,
    data: impl Fn(&dyn Outside) -> Result<Vec<u8>, E>,
) -> Result<(), E> {
    let operations = &recording.operations;
    let nodes = &operations.nodes[operations.inputs..];
    for n in [
        operations.inputs,
        operations.constants.len(),
        operations.functions.len(),
        nodes.len(),
        recording.root as usize,
    ] {
        // Places of a recording are 32 bits.
        bytes.extend((n as u32).to_le_bytes());
    }
    for constant in &operations.constants {
        write_constant(constant.written(), bytes);
    }
    for function in &operations.functions {
        write_all(&data(function.as_ref())?, bytes);
    }
    for node in nodes {
        write_node(node, bytes);
    }
    Ok(())
}

fn write_constant(constant: Written, bytes: &mut Vec<u8>) {
    match constant {
        Written::Double(x) => {
            bytes.push(0);
            bytes.extend(x.to_le_bytes());
        }
        Written::Ratio(n, d) => {
            bytes.push(1);
            bytes.extend([n, d].map(i64::to_le_bytes).concat());
        }
        Written::Decimal(text) => {
            bytes.push(2);
            write_all(text.as_bytes(), bytes);
        }
        Written::Extended(parts) => {
            let kind = usize::from(parts[LENGTHS[0]..] != [0.0; 2]);
            bytes.push(3 + kind as u8);
            bytes.extend(parts[..LENGTHS[kind]].iter().flat_map(|x| x.to_le_bytes()));
        }
    }
}

fn write_node(node: &Node, bytes: &mut Vec<u8>) {
    let payload = match node.op {
        Op::Constant(k) => Some((CONSTANT, k)),
        Op::Powi(n) => Some((POWI, n.cast_unsigned())),
        Op::Powf(k) => Some((POWF, k)),
        Op::HalfPower(n) => Some((HALF_POWER, n.cast_unsigned())),
        Op::Outside { function, .. } => Some((OUTSIDE, function)),
        _ => None,
    };
    match payload {
        Some((code, word)) => {
            bytes.push(code);
            bytes.extend(word.to_le_bytes());
        }
        // Of other operations no recording of an energy consists.
        None => bytes.push(PLAIN.iter().position(|&op| op == node.op).unwrap_or(255) as u8),
    }
    if let Op::Outside { orders, .. } = node.op {
        bytes.extend(orders);
    }
    for operand in [node.a, node.b].into_iter().take(node.op.arity()) {
        bytes.extend(operand.to_le_bytes());
    }
}

fn write_all(data: &[u8], bytes: &mut Vec<u8>) {
    bytes.extend((data.len() as u64).to_le_bytes());
    bytes.extend(data);
}

/// What is left to read.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], BytesError> {
        let split = self.0.split_first_chunk();
        let (head, tail) = split.ok_or(damaged("there are too few"))?;
        self.0 = tail;
        Ok(*head)
    }

    fn byte(&mut self) -> Result<u8, BytesError> {
        Ok(self.take::<1>()?[0])
    }

    fn word(&mut self) -> Result<u32, BytesError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn all(&mut self) -> Result<&'a [u8], BytesError> {
        let length = usize::try_from(u64::from_le_bytes(self.take()?));
        let split = length.ok().and_then(|n| self.0.split_at_checked(n));
        let (head, tail) = split.ok_or(damaged("there are too few"))?;
        self.0 = tail;
        Ok(head)
    }

    /// A recording, with as many components as `expected`.
    fn recording(
        &mut self,
        functions: Functions<'_>,
        expected: Option<usize>,
    ) -> Result<Recording, BytesError> {
        let [inputs, constants, outside, nodes, root] = [(); 5].map(|()| self.word());
        let (inputs, constants, nodes, root) = (inputs? as usize, constants?, nodes?, root?);
        let outside = outside?;
        if inputs == 0 || inputs % 2 != 0 {
            return Err(damaged("positions and momenta are not equal in number"));
        }
        if inputs / 2 > MOST {
            return Err(BuildError::TooManyDegreesOfFreedom { m: inputs / 2 }.into());
        }
        if expected.is_some_and(|expected| inputs != expected) {
            return Err(damaged(NOT_ONE_ENERGY));
        }
        let counts = [constants, outside, nodes].map(|count| count as usize);
        let bytes = counts
            .iter()
            .zip(SHORTEST)
            .map(|(&n, size)| n.saturating_mul(size));
        if bytes.fold(0, usize::saturating_add) > self.0.len() {
            return Err(damaged("there are too few"));
        }
        if !is_room_for(inputs, self.0.len()) {
            return Err(damaged("there are too few for their components"));
        }
        let recorder = Recorder::with_room(inputs, counts);
        let mut recorder = recorder.map_err(|_| BytesError::OutOfMemory { components: inputs })?;
        for k in 0..constants {
            let constant = self.constant()?;
            if recorder.constant_entry(constant) != k {
                return Err(damaged("a constant stands there twice"));
            }
        }
        for _ in 0..outside {
            let function = functions(self.all()?).ok_or(BytesError::UnknownFunction)?;
            recorder.operations.functions.push(function);
        }
        for _ in 0..nodes {
            let place = recorder.nodes.len() as u32;
            let node = self.node(&recorder)?;
            if recorder.node(node) != place {
                return Err(damaged("an operation stands there twice"));
            }
        }
        if root as usize >= recorder.nodes.len() {
            return Err(damaged("the result is none of the operations"));
        }
        Ok(recorder.finish(root))
    }

    fn constant(&mut self) -> Result<Constant, BytesError> {
        Ok(match self.byte()? {
            0 => Constant::double(f64::from_le_bytes(self.take()?)),
            1 => ratio(
                i64::from_le_bytes(self.take()?),
                i64::from_le_bytes(self.take()?),
            ),
            2 => {
                let text = std::str::from_utf8(self.all()?).ok();
                let constant = text.and_then(|text| Constant::from_text(text).ok());
                constant.ok_or(damaged("a constant is no decimal"))?
            }
            kind @ (3 | 4) => {
                let mut parts = Words::default();
                for part in &mut parts[..LENGTHS[usize::from(kind) - 3]] {
                    *part = f64::from_le_bytes(self.take()?);
                }
                Constant::from_expansion(parts)
            }
            _ => return Err(damaged("a constant is of an unknown kind")),
        })
    }

    /// An operation on what `recorder` has so far.
    fn node(&mut self, recorder: &Recorder) -> Result<Node, BytesError> {
        let op = self.op()?;
        let is_within = |k: u32, length: usize| (k as usize) < length;
        let has_its_entry = match op {
            Op::Constant(k) | Op::Powf(k) => is_within(k, recorder.constants.len()),
            Op::Outside { function, orders } => {
                is_within(function, recorder.functions.len())
                    && orders.iter().all(|&k| k <= MOST_ORDER)
            }
            Op::HalfPower(n) => n % 2 != 0 && (3..=15).contains(&n.unsigned_abs()),
            _ => true,
        };
        if !has_its_entry {
            return Err(damaged("an operation has no entry in its list"));
        }
        let mut operands = [0; 2];
        for operand in operands.iter_mut().take(op.arity()) {
            *operand = self.word()?;
            if !is_within(*operand, recorder.nodes.len()) {
                return Err(damaged("an operation stands before its operand"));
            }
        }
        let [a, b] = operands;
        let b = if op.arity() == 1 { a } else { b };
        Ok(Node { op, a, b })
    }

    fn op(&mut self) -> Result<Op, BytesError> {
        Ok(match self.byte()? {
            CONSTANT => Op::Constant(self.word()?),
            POWI => Op::Powi(self.word()?.cast_signed()),
            POWF => Op::Powf(self.word()?),
            HALF_POWER => Op::HalfPower(self.word()?.cast_signed()),
            OUTSIDE => Op::Outside {
                function: self.word()?,
                orders: self.take()?,
            },
            code => *(PLAIN.get(usize::from(code))).ok_or(damaged("an operation is unknown"))?,
        })
    }
}

fn damaged(what: &'static str) -> BytesError {
    BytesError::Damaged { what }
}

/// FNV-1a, 64 bits: each byte is mixed in by a map that can be undone, so that contents of one length that
/// differ in one byte never have the same sum.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
