//! [`Keyed`]: a fast hash of short keys, with a random key for each process.
//!
//! Traces are read from files, and the author of a file must not know which operations collide. Each word is
//! multiplied by the key, and the two halves of the product are combined by exclusive or, as in wyhash and
//! foldhash. The standard hasher takes 1.1 to 2.5 times as long for five million operations.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::sync::LazyLock;

/// The hasher of operations, and its initial state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Keyed {
    state: u64,
    key: u64,
}

/// Builds hashers with the key of this process.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Keys(Keyed);

impl Default for Keys {
    fn default() -> Self {
        static OF_PROCESS: LazyLock<Keyed> = LazyLock::new(|| {
            let random = RandomState::new();
            Keyed {
                state: random.hash_one(0),
                key: random.hash_one(1) | 1,
            }
        });
        Keys(*OF_PROCESS)
    }
}

impl BuildHasher for Keys {
    type Hasher = Keyed;

    #[inline]
    fn build_hasher(&self) -> Keyed {
        self.0
    }
}

impl Keyed {
    #[inline]
    fn add(&mut self, word: u64) {
        let product = u128::from(self.state ^ word) * u128::from(self.key);
        self.state = product as u64 ^ (product >> 64) as u64;
    }
}

impl Hasher for Keyed {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.add(byte.into()));
    }

    #[inline]
    fn write_u32(&mut self, word: u32) {
        self.add(word.into());
    }

    #[inline]
    fn write_u64(&mut self, word: u64) {
        self.add(word);
    }

    #[inline]
    fn write_usize(&mut self, word: usize) {
        self.add(word as u64);
    }

    #[inline]
    fn finish(&self) -> u64 {
        self.state
    }
}

#[cfg(test)]
mod tests {
    use super::Keys;
    use std::collections::HashSet;
    use std::hash::BuildHasher;

    /// Words that differ in few bits have different indices in a table, by the low bits of the hash as well
    /// as by the high bits.
    #[test]
    fn words_are_spread() {
        let keys = Keys::default();
        for shift in [0, 50] {
            let words = (0..1 << 14).map(|k: u32| [k & 127, k >> 7, 3]);
            let places: HashSet<u64> = words
                .map(|words| keys.hash_one(words) >> shift & 0x3fff)
                .collect();
            // With random indices a share of 1 − 1/e would be occupied.
            assert!(places.len() > 10_000, "{}", places.len());
        }
    }
}
