//! [`Aligned`]: numbers that begin where a cache line does, and each of several such at a place of its own in
//! the page.
//!
//! A processor that has just written to an address takes a load from another one with the same last 12 bits
//! for a load of that, and waits. Iterations of a small system write and read a dozen short arrays in turn:
//! with their places left to the allocator an iteration was measured to take 200 cycles in one run and 300 in
//! the next.

use equip_scalar::Float;
use std::ops::{Deref, DerefMut};

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;
/// Bytes after which addresses look alike.
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

/// Hands out slices one behind the other, as far as places in a page go.
#[derive(Debug, Default)]
pub(crate) struct Places {
    next: usize,
}

impl Places {
    /// `len` zeros.
    pub(crate) fn zeros<T: Float>(&mut self, len: usize) -> Aligned<T> {
        let size = size_of::<T>();
        // Where it begins makes no difference to the numbers; long slices are next to all others anyway.
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
