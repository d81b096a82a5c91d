//! Reads a trace from bytes ([`crate::recording::bytes`]) that are not trusted.

use crate::recording::bytes::{
    ALONE, CONSTANT, Content, ENERGY, FORM, FORMAT, HALF_POWER, LENGTHS, MAGIC, ODD, OUTSIDE,
    PLAIN, POWF, POWI, checksum, is_room_for,
};
use crate::recording::op::{Node, Op};
use crate::recording::recorder::{MOST, Recorder, Recording};
use crate::{BuildError, BytesError};
use equip_scalar::{Constant, Outside, Words, ratio};
use std::sync::Arc;

/// The smallest number of bytes of a constant, of a function and of an operation.
const SHORTEST: [usize; 3] = [9, 8, 5];
/// The highest order of a derivative within H. Derivatives of H add a few orders.
const MOST_ORDER: u8 = 15;

/// Restores a function from the bytes of [`Outside::to_bytes`].
pub(crate) type Functions<'a> = &'a dyn Fn(&[u8]) -> Option<Arc<dyn Outside>>;

const NOT_ONE_ENERGY: &str = "there are not the recordings of one energy";

pub(crate) fn read(
    bytes: &[u8],
    functions: Functions<'_>,
) -> Result<Content<Recording>, BytesError> {
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
    let parts = content.byte()?;
    // If H depends on time, there is no bracket, and the components are pairs.
    let with_time = parts & ALONE != 0 && parts & (FORM | ODD) != 0;
    let is_known = parts & ENERGY != 0 && parts < 2 * ODD && !with_time;
    if !is_known {
        return Err(damaged(NOT_ONE_ENERGY));
    }
    let energy = content.recording(functions, None)?;
    let inputs = energy.operations.inputs;
    let mut further = |bit: u8, inputs: usize| {
        let recording = (parts & bit != 0).then(|| content.recording(functions, Some(inputs)));
        recording.transpose()
    };
    let alone = further(ALONE, inputs)?;
    let form = further(FORM, 3 * inputs)?;
    if !content.0.is_empty() {
        return Err(damaged("there are too many"));
    }
    Ok(Content {
        energy,
        alone,
        form,
        is_odd: parts & ODD != 0,
    })
}

/// The remaining bytes.
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

    /// A trace, with the `expected` number of components if it is given.
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

    /// An operation on the nodes of `recorder`.
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
