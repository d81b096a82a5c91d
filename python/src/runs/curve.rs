//! [`Curve`]: a run at any time, which files and pickles keep as numbers.

use crate::faults::value_error;
use crate::number::{Doubles, Number, arrays};
use equip::integrate::Trajectory;
use equip::prelude::DoubleDouble;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;

/// Trajectories of either number type.
pub(crate) enum Dense {
    Double(Trajectory<f64>),
    DoubleDouble(Trajectory<DoubleDouble>),
}

/// Number types whose trajectories can be kept.
pub(crate) trait Kept: Sized {
    fn keep(trajectory: Trajectory<Self>) -> Dense;
}

impl Kept for f64 {
    fn keep(trajectory: Trajectory<f64>) -> Dense {
        Dense::Double(trajectory)
    }
}

impl Kept for DoubleDouble {
    fn keep(trajectory: Trajectory<DoubleDouble>) -> Dense {
        Dense::DoubleDouble(trajectory)
    }
}

macro_rules! each {
    ($dense:expr, $trajectory:ident => $body:expr) => {
        match $dense {
            Dense::Double($trajectory) => $body,
            Dense::DoubleDouble($trajectory) => $body,
        }
    };
}

/// A run at any time.
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Curve {
    pub(crate) dense: Dense,
    /// Numbers of a state.
    pub(crate) n: usize,
}

/// Numbers of a curve: upper words, and lower ones, none of a run in doubles.
type Numbers<'py> = (Doubles<'py>, Doubles<'py>);
/// What pickles call, and with which arguments.
type Reduced<'py> = (Bound<'py, PyAny>, (usize, Doubles<'py>, Doubles<'py>));
type Given<'py> = PyReadonlyArray1<'py, f64>;

#[pymethods]
impl Curve {
    /// The curve of states with `n` numbers each of which `numbers` made these.
    #[new]
    fn new(n: usize, high: Given<'_>, low: Given<'_>) -> PyResult<Self> {
        let (high, low) = (high.as_slice()?, low.as_slice()?);
        let dense = if low.is_empty() {
            Trajectory::from_numbers(high).map(Dense::Double)
        } else {
            let pairs = high.iter().zip(low);
            let numbers: Vec<_> = pairs.map(|(&hi, &lo)| DoubleDouble::new(hi, lo)).collect();
            let fits = high.len() == low.len();
            let trajectory = fits.then(|| Trajectory::from_numbers(&numbers)).flatten();
            trajectory.map(Dense::DoubleDouble)
        };
        let dense = dense.ok_or_else(|| value_error("these are not the numbers of a curve"))?;
        if 2 * each!(&dense, t => t.degrees_of_freedom()) != n {
            return Err(value_error("the curve is one of states of another length"));
        }
        Ok(Curve { dense, n })
    }

    /// All that the curve consists of.
    fn numbers<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        match &self.dense {
            Dense::Double(trajectory) => {
                let numbers = trajectory.to_numbers().into_pyarray(py);
                (numbers, Vec::new().into_pyarray(py))
            }
            Dense::DoubleDouble(trajectory) => arrays(py, trajectory.to_numbers().into_iter()),
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Reduced<'py> {
        let (high, low) = slf.get().numbers(slf.py());
        (slf.get_type().into_any(), (slf.get().n, high, low))
    }

    /// First and last time.
    fn interval(&self) -> (f64, f64) {
        each!(&self.dense, trajectory => {
            let (start, end) = trajectory.interval();
            (Number::high(start), Number::high(end))
        })
    }

    /// The state (q, p), 2m numbers, at each of the times, one after the other.
    fn at<'py>(&self, times: PyReadonlyArray1<'py, f64>) -> PyResult<Doubles<'py>> {
        let states = each!(&self.dense, t => states(t, times.as_slice()?, self.n));
        Ok(states?.into_pyarray(times.py()))
    }
}

fn states<T: Number>(trajectory: &Trajectory<T>, times: &[f64], n: usize) -> PyResult<Vec<f64>> {
    let mut y = vec![T::int(0); n];
    let mut states = Vec::with_capacity(times.len() * n);
    for &t in times {
        if !trajectory.at_into(T::exact(t), &mut y) {
            let (start, end) = trajectory.interval();
            return Err(value_error(format!(
                "t = {t} is outside the run, {start} to {end}"
            )));
        }
        states.extend(y.iter().map(|x| x.to_f64()));
    }
    Ok(states)
}
