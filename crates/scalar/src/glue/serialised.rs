//! [`DoubleDouble`] and [`Constant`] in serde: as the doubles of their expansion, largest first. Exact in
//! formats that write doubles exactly.

use crate::{Constant, DoubleDouble, Float};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

impl Serialize for DoubleDouble {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let [high, low, ..] = Float::expansion(*self);
        [high, low].serialize(to)
    }
}

impl<'de> Deserialize<'de> for DoubleDouble {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let [high, low] = <[f64; 2]>::deserialize(from)?;
        Ok(Float::from_expansion([high, low, 0.0, 0.0, 0.0, 0.0]))
    }
}

impl Serialize for Constant {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.to::<DoubleDouble>().serialize(to)
    }
}

impl<'de> Deserialize<'de> for Constant {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let sum = DoubleDouble::deserialize(from)?;
        Ok(Constant::from_expansion(Float::expansion(sum)))
    }
}
