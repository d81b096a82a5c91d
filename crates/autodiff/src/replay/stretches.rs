//! Stretches of operands that lie side by side: how a group of equal operations is parted into runs.

use std::ops::Range;

/// Shortest run over slices that is worth leaving a run over listed operands: to begin a run takes as long as
/// some ten operations.
pub(crate) const SHORTEST_SLICE: usize = 16;

/// How the operands of a run lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Access {
    /// Anywhere.
    Listed,
    /// Side by side, both.
    Slices,
    /// The left one is the same throughout, the right ones lie side by side.
    FixedLeft,
    /// The right one is the same throughout, the left ones lie side by side.
    FixedRight,
}

/// Number of leading elements each of which stands in the given relation to the one before.
pub(crate) fn stretch<E>(elements: &[E], follows: impl Fn(&E, &E) -> bool) -> usize {
    elements
        .windows(2)
        .take_while(|w| follows(&w[0], &w[1]))
        .count()
        + 1
}

/// Where the next stretch of slots side by side begins that is long enough, or the end.
pub(crate) fn next_slice(slots: &[u32], start: usize) -> usize {
    let mut at = start;
    while at < slots.len() {
        let length = stretch(&slots[at..], |x, y| *y == x + 1);
        if length >= SHORTEST_SLICE {
            break;
        }
        at += length;
    }
    at
}

/// Parts of a group of equal operations, by how their operands lie.
pub(crate) fn split<P>(
    group: &[P],
    operands: impl Fn(&P) -> [u32; 2],
) -> Vec<(Range<usize>, Access)> {
    let apart = |x: &P, y: &P, by: [u32; 2]| {
        let ([left, right], [next_left, next_right]) = (operands(x), operands(y));
        [next_left, next_right] == [left + by[0], right + by[1]]
    };
    let mut parts: Vec<(Range<usize>, Access)> = Vec::new();
    let mut start = 0;
    while start < group.len() {
        let rest = &group[start..];
        let both = stretch(rest, |x, y| apart(x, y, [1, 1]));
        let fixed_left = stretch(rest, |x, y| apart(x, y, [0, 1]));
        let fixed_right = stretch(rest, |x, y| apart(x, y, [1, 0]));
        let longest = both.max(fixed_left).max(fixed_right);
        let access = match longest {
            l if l < SHORTEST_SLICE.min(group.len()) => Access::Listed,
            l if l == both => Access::Slices,
            l if l == fixed_left => Access::FixedLeft,
            _ => Access::FixedRight,
        };
        let end = start + longest;
        match parts.last_mut() {
            Some((range, Access::Listed)) if access == Access::Listed => range.end = end,
            _ => parts.push((start..end, access)),
        }
        start = end;
    }
    parts
}
