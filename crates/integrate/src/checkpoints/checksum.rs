//! Checksums: of what a checkpoint holds, and of a function by its values.
//!
//! FNV-1a, 64 bits: each byte is mixed in by a map that can be undone, so that two texts of one length which
//! differ in one byte never have the same sum.

use crate::checkpoints::exact::Exact;
use equip_autodiff::Evaluator;
use equip_scalar::Float;

/// A sum over bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Checksum(u64);

impl Checksum {
    pub(crate) fn new() -> Self {
        Checksum(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    pub(crate) fn count(&mut self, count: u64) {
        self.bytes(&count.to_le_bytes());
    }

    /// A text with its length, so that texts one after the other are told apart.
    pub(crate) fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.bytes(text.as_bytes());
    }

    pub(crate) fn numbers<'a>(&mut self, numbers: impl IntoIterator<Item = &'a Exact>) {
        let mut count = 0;
        for number in numbers {
            self.text(number.text());
            count += 1;
        }
        self.count(count);
    }

    fn value<T: Float>(&mut self, x: T) {
        // Four words at least: as many as have always been counted.
        let parts = x.expansion();
        let last = parts.iter().rposition(|&part| part != 0.0).unwrap_or(0);
        for &part in &parts[..=last.max(3)] {
            // All NaN are one.
            let part = if part.is_nan() { f64::NAN } else { part };
            self.count(part.to_bits());
        }
    }

    pub(crate) fn hexadecimal(self) -> String {
        format!("{:016x}", self.0)
    }
}

/// The checksum of a function: of its formula, if that is recorded, and of its values and of w of
/// y' = Jw at `y` and at two states near it, which tell apart external energies and their brackets.
/// Three gradients.
pub(crate) fn of_function<T: Float>(function: &mut Evaluator<T>, y: &[T]) -> String {
    let mut sum = Checksum::new();
    if let Some(formula) = function.formula_checksum() {
        sum.count(formula);
    }
    let (mut point, mut gradient) = (y.to_vec(), vec![T::int(0); y.len()]);
    for k in 0..3 {
        for (j, (x, &y)) in point.iter_mut().zip(y).enumerate() {
            // Differences that no symmetry of the usual energies undoes.
            *x = y + T::ratio(k * (2 * j as i64 + 3), 16 * (j as i64 + 4));
        }
        sum.value(function.value(&point));
        function.flow_gradient(&point, &mut gradient);
        gradient.iter().for_each(|&x| sum.value(x));
    }
    sum.hexadecimal()
}
