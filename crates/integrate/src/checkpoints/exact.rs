//! [`Exact`]: a number stored by its bits.

use crate::error::IntegrateError;
use equip_scalar::{Float, Words};

/// A number as the bits of its parts: hexadecimal, separated by colons, the largest part first.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub(crate) struct Exact(String);

impl Default for Exact {
    fn default() -> Self {
        Exact::of(0.0)
    }
}

impl Exact {
    pub(crate) fn of<T: Float>(x: T) -> Self {
        let parts = x.expansion();
        let last = parts.iter().rposition(|&part| part != 0.0).unwrap_or(0);
        let text: Vec<String> = parts[..=last]
            .iter()
            .map(|part| format!("{:016x}", part.to_bits()))
            .collect();
        Exact(text.join(":"))
    }

    /// Reads a number that must be finite.
    pub(crate) fn read_finite<T: Float>(&self, what: &'static str) -> Result<T, IntegrateError<T>> {
        let number: T = self.read()?;
        if number.is_finite() {
            Ok(number)
        } else {
            Err(IntegrateError::CheckpointDamaged { what })
        }
    }

    pub(crate) fn all<T: Float>(x: &[T]) -> Vec<Self> {
        x.iter().map(|&x| Exact::of(x)).collect()
    }

    pub(crate) fn read<T: Float>(&self) -> Result<T, IntegrateError<T>> {
        let mut parts = Words::default();
        let mut count = 0;
        for text in self.0.split(':') {
            let bits = u64::from_str_radix(text, 16);
            let (Ok(bits), Some(part)) = (bits, parts.get_mut(count)) else {
                return Err(IntegrateError::CheckpointDamaged { what: "a number" });
            };
            *part = f64::from_bits(bits);
            count += 1;
        }
        Ok(if count == 1 {
            T::exact(parts[0])
        } else {
            T::from_expansion(parts)
        })
    }

    /// Reads all numbers of `out`.
    pub(crate) fn read_all<T: Float>(
        stored: &[Self],
        out: &mut [T],
        what: &'static str,
    ) -> Result<(), IntegrateError<T>> {
        if stored.len() != out.len() {
            return Err(IntegrateError::CheckpointDamaged { what });
        }
        for (out, stored) in out.iter_mut().zip(stored) {
            *out = stored.read()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Exact;
    use equip_scalar::{DoubleDouble, Float};

    #[test]
    fn numbers_come_back_with_all_their_bits() {
        let third = DoubleDouble::ratio(1, 3);
        for x in [
            0.0,
            -0.0,
            1.0,
            -0.1,
            f64::MAX,
            5e-324,
            f64::INFINITY,
            1e-300,
        ] {
            let back: f64 = Exact::of(x).read().unwrap();
            assert_eq!(back.to_bits(), x.to_bits());
            let x = third * DoubleDouble::exact(x);
            let back: DoubleDouble = Exact::of(x).read().unwrap();
            let bits = |x: DoubleDouble| x.expansion().map(f64::to_bits);
            if x.is_finite() && x != DoubleDouble::exact(0.0) {
                assert_eq!(bits(back), bits(x), "{x}");
            }
        }
        let back: f64 = Exact::of(f64::NAN).read().unwrap();
        assert!(back.is_nan());
        assert!(Exact("no number".into()).read::<f64>().is_err());
        assert!(Exact("0:0:0:0:0:0:0".into()).read::<f64>().is_err());
    }
}
