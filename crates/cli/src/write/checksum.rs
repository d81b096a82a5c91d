//! FNV-1a with 64 bits: every step is one to one, so that a change within one byte is always seen.

/// The checksum of some bytes.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    continued(BASIS, bytes)
}

/// The checksum of what has the checksum `sum`, and then of `bytes`.
pub(crate) fn continued(sum: u64, bytes: &[u8]) -> u64 {
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    bytes.iter().fold(sum, |sum, &byte| {
        (sum ^ u64::from(byte)).wrapping_mul(PRIME)
    })
}

#[cfg(test)]
mod tests {
    use super::{checksum, continued};

    /// Values of the authors of the checksum, <http://www.isthe.com/chongo/tech/comp/fnv/>.
    #[test]
    fn checksums_are_those_of_fnv_1a() {
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
        assert_eq!(continued(checksum(b"foo"), b"bar"), checksum(b"foobar"));
    }
}
