//! [`Number`]: what a run computes in, from and to pairs of doubles.

use equip::prelude::DoubleDouble;
use equip::scalar::Float;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

/// A number as Python hands it over: an unevaluated sum of two doubles.
pub(crate) type Pair = (f64, f64);

/// Upper and lower words of numbers; without lower ones they are doubles.
pub(crate) type Pairs = (Vec<f64>, Vec<f64>);

/// An array of doubles.
pub(crate) type Doubles<'py> = Bound<'py, PyArray1<f64>>;

/// A number type that runs from Python can have.
pub(crate) trait Number: Float<Pack<4>: Send, Pack<8>: Send> {
    fn read(pair: Pair) -> Self;
    fn low(self) -> f64;

    fn high(self) -> f64 {
        self.to_f64()
    }

    fn read_all((high, low): &Pairs) -> Vec<Self> {
        let rest = low.iter().copied().chain(std::iter::repeat(0.0));
        high.iter().copied().zip(rest).map(Self::read).collect()
    }
}

impl Number for f64 {
    fn read((high, low): Pair) -> f64 {
        high + low
    }

    fn low(self) -> f64 {
        0.0
    }
}

impl Number for DoubleDouble {
    fn read((high, low): Pair) -> DoubleDouble {
        DoubleDouble::new(high, low)
    }

    fn low(self) -> f64 {
        self.lo()
    }
}

/// Upper and lower words of numbers, as arrays.
pub(crate) fn arrays<'py, T: Number>(
    py: Python<'py>,
    numbers: impl Iterator<Item = T>,
) -> (Doubles<'py>, Doubles<'py>) {
    let (high, low): (Vec<f64>, Vec<f64>) = numbers.map(|x| (x.high(), x.low())).unzip();
    (high.into_pyarray(py), low.into_pyarray(py))
}
