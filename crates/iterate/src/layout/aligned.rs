//! [`Aligned`]: slices that begin on a cache line, each at a different offset within its memory page.
//!
//! After a write, a processor mistakes a load from an address with the same last 12 bits for a load of the
//! written data, and stalls. The iterations of a small system write and read a dozen short arrays in turn.
//! With offsets chosen by the allocator an iteration was measured to take 200 cycles in one run and 300
//! cycles in the next.

use equip_scalar::Float;
use std::ops::{Deref, DerefMut};

/// The bytes of a cache line, and of the widest vector.
const LINE: usize = 64;
/// The distance in bytes of addresses with the same last 12 bits.
const PAGE: usize = 4096;

/// A slice of fixed length at a multiple of 64 bytes.
#[derive(Debug)]
pub(crate) struct Aligned<T> {
    store: Box<[T]>,
    start: usize,
    len: usize,
}

impl<T> Deref for Aligned<T> {
    type Target = [T];
    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.store[self.start..self.start + self.len]
    }
}

impl<T> DerefMut for Aligned<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.store[self.start..self.start + self.len]
    }
}

impl<'a, T> IntoIterator for &'a Aligned<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// Allocates slices at consecutive offsets within a page.
#[derive(Debug, Default)]
pub(crate) struct Places {
    next: usize,
}

impl Places {
    /// `len` zeros.
    pub(crate) fn zeros<T: Float>(&mut self, len: usize) -> Aligned<T> {
        let size = size_of::<T>();
        // The offset does not affect the numbers. A long slice overlaps the offsets of all others anyway.
        let spare = if len * size < PAGE { PAGE } else { LINE } / size;
        let store = vec![T::int(0); len + spare].into_boxed_slice();
        let address = store.as_ptr().addr();
        let offset = (self.next.wrapping_sub(address) % (spare * size)).next_multiple_of(size);
        self.next = (self.next + len * size).next_multiple_of(LINE);
        Aligned {
            store,
            start: (offset / size).min(spare),
            len,
        }
    }
}
