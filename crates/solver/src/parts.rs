//! [`Part`]: what a step, or each part of a halved one, has passed through.

use crate::stages::Stages;
use crate::state::State;
use equip_scalar::Float;

/// What a step, or a part of a halved step, leaves for dense output.
#[derive(Debug, Clone)]
pub struct Part<T> {
    /// The state it starts from, n = 2m components.
    pub start: State<T>,
    /// Time at its start.
    pub time: T,
    /// Its size.
    pub h: T,
    /// L_i, stage by stage, blocks of length n.
    pub l: Vec<T>,
    /// α_1 … α_{s−1}.
    pub alphas: Vec<T>,
}

/// The parts of the step made last, in the order of time. Buffers are reused.
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

    pub(crate) fn add(&mut self, start: &State<T>, time: T, h: T, stages: &Stages<T>) {
        if !self.wanted {
            return;
        }
        if self.count == self.parts.len() {
            let (l, alphas) = (stages.l.clone(), stages.alphas.clone());
            let start = start.clone();
            self.parts.push(Part {
                start,
                time,
                h,
                l,
                alphas,
            });
        } else {
            let part = &mut self.parts[self.count];
            part.start.copy_from(start);
            part.l.copy_from_slice(&stages.l);
            part.alphas.copy_from_slice(&stages.alphas);
            (part.time, part.h) = (time, h);
        }
        self.count += 1;
    }

    pub(crate) fn all(&self) -> &[Part<T>] {
        &self.parts[..self.count]
    }
}
