//! [`Part`]: the data of a step, or of each part of a halved step, for dense output.

use equip_iterate::{Iterate, State};
use equip_scalar::Float;

/// The data of a step, or of a part of a halved step, for dense output.
#[derive(Debug, Clone)]
pub struct Part<T> {
    /// The state at its start, n = 2m components.
    pub start: State<T>,
    /// The time at its start.
    pub time: T,
    /// Its size.
    pub h: T,
    /// L_i, stage by stage, blocks of length n.
    pub l: Vec<T>,
    /// α_1 … α_{s−1}.
    pub alphas: Vec<T>,
}

/// The parts of the last step, in the order of time. Buffers are reused.
#[derive(Debug)]
pub(crate) struct Parts<T> {
    pub(crate) wanted: bool,
    parts: Vec<Part<T>>,
    count: usize,
}

impl<T: Float> Parts<T> {
    pub(crate) fn new() -> Self {
        Parts {
            wanted: false,
            parts: Vec::new(),
            count: 0,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the part whose stages have just been solved, if parts are requested.
    pub(crate) fn add(
        &mut self,
        (start, time, h): (&State<T>, T, T),
        iterate: &Iterate<T>,
        alphas: &[T],
    ) {
        if !self.wanted {
            return;
        }
        if self.count == self.parts.len() {
            let l = vec![T::int(0); iterate.stages() * iterate.components()];
            self.parts.push(Part {
                start: start.clone(),
                time,
                h,
                l,
                alphas: alphas.to_vec(),
            });
        }
        let part = &mut self.parts[self.count];
        part.start.copy_from(start);
        iterate.increments_by_stage(&mut part.l);
        part.alphas.copy_from_slice(alphas);
        (part.time, part.h) = (time, h);
        self.count += 1;
    }

    pub(crate) fn all(&self) -> &[Part<T>] {
        &self.parts[..self.count]
    }
}
