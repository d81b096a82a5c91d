//! A trace as bytes, with every node at its index, so that H and its derivatives agree bit for bit. `read.rs`
//! reads them.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | [`FORMAT`] |
//! | 8 | checksum of the rest: FNV-1a |
//! | 1 | bits: H (1), H(t, q, p) alone (2), the form of a bracket (4), an unused last component (8) |
//! | | for each trace: inputs, lengths of the three lists, root; constants, functions, operations |
//!
//! The least significant byte of a number comes first. An operation is its code, its payload if it has one,
//! and its operands. Components of the state precede all other nodes and are not written. The bytes are not
//! trusted: before the reader reserves memory, it compares every count with the number of remaining bytes. It
//! uses less than 100 times the memory of the bytes, and 10 MB for components that no operation uses.

use crate::BytesError;
use crate::recording::op::{Node, Op};
use crate::recording::recorder::Recording;
use equip_scalar::{Outside, Written};
use fnv::FnvHasher;
use std::convert::Infallible;
use std::hash::Hasher;

pub(super) const MAGIC: [u8; 8] = *b"equip H\n";
pub(super) const FORMAT: u32 = 2;
const HEAD: usize = MAGIC.len() + 4 + 8;

/// The number of components that need no bytes of their own. With more components, H must depend on a good
/// part of them: each such component is an operand, which takes four bytes.
const FREE_COMPONENTS: usize = 1 << 16;
const COMPONENT: usize = 4;
pub(super) const LENGTHS: [usize; 2] = [4, 6]; // doubles of an extended constant up to 212 bits, and beyond

/// The operations without a payload. The index is the code, so another order is another format.
#[rustfmt::skip]
pub(super) const PLAIN: [Op; 37] = {
    use Op::*;
    [
        Add, Sub, Mul, Square, Div, Neg, Recip, Sqrt, Cbrt, Abs, Pow, Exp, Exp2, Ln, ExpM1, Ln1p, Sin,
        Cos, Tan, Asin, Acos, Atan, Atan2, Sinh, Cosh, Tanh, Asinh, Acosh, Atanh, Erf, Erfc, Hypot, Min,
        Max, Sign, AtMost, WhereNonzero,
    ]
};

/// The codes of operations with a payload.
pub(super) const CONSTANT: u8 = 200;
pub(super) const POWI: u8 = 201;
pub(super) const POWF: u8 = 202;
pub(super) const HALF_POWER: u8 = 203;
pub(super) const OUTSIDE: u8 = 204;

/// The traces of one energy.
pub(crate) struct Content<R> {
    /// H.
    pub(crate) energy: R,
    /// H(t, q, p) alone, if H depends on time.
    pub(crate) alone: Option<R>,
    /// The bilinear form of y, g and λ of a bracket that is not canonical.
    pub(crate) form: Option<R>,
    /// Whether the last component is unused.
    pub(crate) is_odd: bool,
}

/// The bits of the first byte.
pub(super) const ENERGY: u8 = 1;
pub(super) const ALONE: u8 = 2;
pub(super) const FORM: u8 = 4;
pub(super) const ODD: u8 = 8;

pub(crate) fn write(of: &Content<&Recording>) -> Result<Vec<u8>, BytesError> {
    let bit = |is_there: bool, bit: u8| if is_there { bit } else { 0 };
    let parts = bit(of.alone.is_some(), ALONE) | bit(of.form.is_some(), FORM) | bit(of.is_odd, ODD);
    let mut content = vec![ENERGY | parts];
    for recording in [Some(of.energy), of.alone, of.form].into_iter().flatten() {
        let before = content.len();
        write_recording(recording, &mut content, |function| {
            let not_data = || BytesError::NotData {
                function: format!("{function:?}"),
            };
            function.to_bytes().ok_or_else(not_data)
        })?;
        let components = recording.operations.inputs;
        // The five counts precede the bytes with which the reader compares them.
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

/// Whether a trace of `bytes` bytes may have this number of components.
pub(super) fn is_room_for(components: usize, bytes: usize) -> bool {
    components <= FREE_COMPONENTS.max(bytes / COMPONENT)
}

/// The checksum of the formula: operations, constants and tables. All external closures have the same
/// checksum.
pub(crate) fn formula_checksum(recording: &Recording) -> u64 {
    let mut content = Vec::new();
    let data =
        |function: &dyn Outside| Ok::<_, Infallible>(function.to_bytes().unwrap_or_default());
    let Ok(()) = write_recording(recording, &mut content, data);
    checksum(&content)
}

/// Writes a trace. `data` writes its external functions.
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
        // The indices of a trace have 32 bits.
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
        // The trace of an energy contains no other operations.
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

/// FNV-1a, 64 bits. Each byte is combined by an invertible map, so contents of equal length that differ in
/// one byte have different checksums.
pub(super) fn checksum(bytes: &[u8]) -> u64 {
    let mut sum = FnvHasher::default();
    sum.write(bytes);
    sum.finish()
}
