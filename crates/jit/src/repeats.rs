//! Instructions that repeat, with other rows each time: those of a chain are a few dozen, however long it is,
//! and need not be read from memory as often as there are masses.
//!
//! Found in the instructions as they are, so that nothing has to be known of the program: what is done in a
//! loop is what would be done without.

use crate::registers::{Instruction, Memory, Source};
use std::ops::Range;

/// Instructions that are done `count` times, inputs, results and constants being so many further each time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stretch {
    pub(crate) instructions: Range<usize>,
    pub(crate) count: usize,
    pub(crate) steps: Steps,
}

/// How far what is read and written moves from one time to the next; of what does not occur it is not known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Steps {
    pub(crate) inputs: Option<u32>,
    pub(crate) results: Option<u32>,
    pub(crate) constants: Option<u32>,
}

/// Longest period that is looked for.
const LONGEST: usize = 96;
/// Fewest instructions in a loop, so that those of the loop itself do not count, and fewest times that it is
/// worth it.
const FEWEST: usize = 32;
const TIMES: usize = 4;

/// All instructions as stretches. Repetitions are looked for behind results: only what gives some repeats.
pub(crate) fn stretches(instructions: &[Instruction]) -> Vec<Stretch> {
    let mut found = Vec::new();
    let (mut at, mut from) = (0, 0);
    let once = |instructions| Stretch {
        instructions,
        count: 1,
        steps: Steps::default(),
    };
    while at < instructions.len() {
        let gives = matches!(instructions[at], Instruction::Store(Memory::Result(_), _));
        at += 1;
        if gives && let Some((length, count, steps)) = repetition(&instructions[at..]) {
            found.push(once(from..at));
            found.push(Stretch {
                instructions: at..at + length,
                count,
                steps,
            });
            at += length * count;
            from = at;
        }
    }
    found.push(once(from..at));
    found
}

/// Length, number and steps of a repetition that begins here.
fn repetition(instructions: &[Instruction]) -> Option<(usize, usize, Steps)> {
    (1..=LONGEST.min(instructions.len() / 2)).find_map(|period| {
        let mut steps = Steps::default();
        let pairs = instructions.iter().zip(&instructions[period..]);
        let same = pairs.take_while(|(x, y)| steps.lead(x, y)).count();
        let times = same / period + 1;
        let together = FEWEST.div_ceil(period);
        let (length, count) = (period * together, times / together);
        let steps = steps.times(together as u32)?;
        (count >= TIMES).then_some((length, count, steps))
    })
}

impl Steps {
    /// Whether the second instruction is the first, so many further; learns how many.
    fn lead(&mut self, x: &Instruction, y: &Instruction) -> bool {
        use Instruction::{Binary, Load, Sqrt, Store};
        match (*x, *y) {
            (Load(a, from), Load(b, to)) | (Store(from, a), Store(to, b)) => {
                a == b && self.lead_memory(from, to)
            }
            (Sqrt(a, from), Sqrt(b, to)) => a == b && self.lead_source(from, to),
            (Binary(f, a, c, from), Binary(g, b, d, to)) => {
                (f, a, c) == (g, b, d) && self.lead_source(from, to)
            }
            _ => false,
        }
    }

    fn lead_source(&mut self, from: Source, to: Source) -> bool {
        match (from, to) {
            (Source::Memory(from), Source::Memory(to)) => self.lead_memory(from, to),
            _ => from == to,
        }
    }

    fn lead_memory(&mut self, from: Memory, to: Memory) -> bool {
        let (step, from, to) = match (from, to) {
            (Memory::Input(from), Memory::Input(to)) => (&mut self.inputs, from, to),
            (Memory::Result(from), Memory::Result(to)) => (&mut self.results, from, to),
            (Memory::Constant(from), Memory::Constant(to)) => (&mut self.constants, from, to),
            _ => return from == to,
        };
        let Some(further) = to.checked_sub(from) else {
            return false;
        };
        *step.get_or_insert(further) == further
    }

    fn times(self, count: u32) -> Option<Steps> {
        let times = |step: Option<u32>| match step {
            Some(step) => step.checked_mul(count).map(Some),
            None => Some(None),
        };
        Some(Steps {
            inputs: times(self.inputs)?,
            results: times(self.results)?,
            constants: times(self.constants)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Steps, Stretch, stretches};
    use crate::registers::{Instruction, Memory, Source};

    /// The root of constant k into row 2k, for k from 0 on; input k is read in vain.
    fn roots(count: u32) -> Vec<Instruction> {
        let root = |k: u32| {
            [
                Instruction::Load(0, Memory::Input(k)),
                Instruction::Sqrt(0, Source::Memory(Memory::Constant(k))),
                Instruction::Store(Memory::Result(2 * k), 0),
            ]
        };
        (0..count).flat_map(root).collect()
    }

    #[test]
    fn a_repetition_is_found_behind_its_first_result() {
        let found = stretches(&roots(100));
        let counts: Vec<usize> = found.iter().map(|stretch| stretch.count).collect();
        assert_eq!(counts, [1, 9, 1]);
        let expected = Stretch {
            instructions: 3..36,
            count: 9,
            steps: Steps {
                inputs: Some(11),
                results: Some(22),
                constants: Some(11),
            },
        };
        assert_eq!(found[1], expected);
        assert_eq!(found[2].instructions, 300..300);
    }

    #[test]
    fn what_does_not_repeat_or_not_often_is_done_once() {
        let mut others = roots(100);
        for (k, instruction) in others.iter_mut().enumerate() {
            if let Instruction::Load(register, _) = instruction {
                *register = k.count_ones() as u8;
            }
        }
        for instructions in [roots(20), others, Vec::new()] {
            let found = stretches(&instructions);
            assert!(found.iter().all(|stretch| stretch.count == 1));
            let all: usize = found.iter().map(|stretch| stretch.instructions.len()).sum();
            assert_eq!(all, instructions.len());
        }
    }
}
