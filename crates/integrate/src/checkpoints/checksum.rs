//! Checksums of the content of a checkpoint, and of a function by its values.
//!
//! FNV-1a, 64 bits. Each byte is combined by an invertible map, so two texts of equal length that differ in
//! one byte have different checksums.

use crate::checkpoints::exact::Exact;
use equip_autodiff::Evaluator;
use equip_scalar::Float;
use fnv::FnvHasher;
use std::hash::{Hash, Hasher};

/// FNV-1a with the same result for every word length and byte order.
#[derive(Default)]
struct Portable(FnvHasher);

impl Hasher for Portable {
    fn finish(&self) -> u64 {
        self.0.finish()
    }

    fn write(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }

    fn write_u32(&mut self, count: u32) {
        self.write_u64(count.into());
    }

    fn write_u64(&mut self, count: u64) {
        self.write(&count.to_le_bytes());
    }

    fn write_usize(&mut self, count: usize) {
        self.write_u64(count as u64);
    }
}

/// The checksum of `content`, in hexadecimal.
pub(crate) fn of(content: &impl Hash) -> String {
    let mut sum = Portable::default();
    content.hash(&mut sum);
    format!("{:016x}", sum.finish())
}

/// The checksum of a function: of its formula if it was traced, and of its values and of the vector w of y' =
/// Jw at `y` and at two states near `y`. The values distinguish external energies and their brackets. Costs
/// three gradients.
pub(crate) fn of_function<T: Float>(function: &mut Evaluator<T>, y: &[T]) -> String {
    let (mut point, mut w) = (y.to_vec(), vec![T::int(0); y.len()]);
    let mut values = Vec::with_capacity(3 * (y.len() + 1));
    for k in 0..3 {
        for (j, (x, &y)) in point.iter_mut().zip(y).enumerate() {
            // Differences that no symmetry of common energies cancels.
            *x = y + T::ratio(k * (2 * j as i64 + 3), 16 * (j as i64 + 4));
        }
        values.push(function.value(&point));
        function.flow_gradient(&point, &mut w);
        values.extend_from_slice(&w);
    }
    // All NaN are equal.
    let number = |x: T| if x.is_nan() { T::exact(f64::NAN) } else { x };
    let values: Vec<Exact> = values.into_iter().map(|x| Exact::of(number(x))).collect();
    of(&(function.formula_checksum(), values))
}
