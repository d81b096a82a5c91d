//! [`Table`]: splines through data, for use within H.

use crate::faults::value_error;
use crate::number::{Doubles, Number, Pair, Pairs};
use crate::recording::variable::{Variable, number};
use equip::prelude::{DoubleDouble, Table as Spline, Table2 as Surface, Var};
use equip::scalar::Num;
use equip::tables::TableError;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

enum Kind {
    One(Spline),
    Two(Surface),
}

/// A spline of one or two variables.
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Table {
    kind: Kind,
    /// Whether it has values beyond its ends.
    extrapolate: bool,
}

#[pymethods]
impl Table {
    /// Through the points (x, y); `ends` is "natural", "not-a-knot", or "slopes" or "curvatures" with two
    /// numbers.
    #[staticmethod]
    fn one(
        x: Pairs,
        y: Pairs,
        ends: &str,
        numbers: [Pair; 2],
        extrapolate: bool,
    ) -> PyResult<Self> {
        let (x, y) = (DoubleDouble::read_all(&x), DoubleDouble::read_all(&y));
        let numbers = numbers.map(DoubleDouble::read);
        let spline = match ends {
            "natural" => Spline::natural(&x, &y),
            "not-a-knot" => Spline::not_a_knot(&x, &y),
            "slopes" => Spline::clamped(&x, &y, numbers),
            _ => Spline::with_curvatures(&x, &y, numbers),
        };
        let spline = spline.map_err(value_error)?;
        let kind = Kind::One(if extrapolate {
            spline.extrapolated()
        } else {
            spline
        });
        Ok(Table { kind, extrapolate })
    }

    /// Through the values z, row by row, on the grid (x, y).
    #[staticmethod]
    fn two(x: Pairs, y: Pairs, z: Pairs, ends: &str, extrapolate: bool) -> PyResult<Self> {
        let (x, y, z) = (
            DoubleDouble::read_all(&x),
            DoubleDouble::read_all(&y),
            DoubleDouble::read_all(&z),
        );
        let surface = match ends {
            "natural" => Surface::natural(&x, &y, &z),
            _ => Surface::not_a_knot(&x, &y, &z),
        };
        let surface = surface.map_err(value_error)?;
        let kind = Kind::Two(if extrapolate {
            surface.extrapolated()
        } else {
            surface
        });
        Ok(Table { kind, extrapolate })
    }

    /// The value at variables, within H.
    #[pyo3(signature = (x, y=None))]
    fn at(&self, x: &Bound<'_, PyAny>, y: Option<&Bound<'_, PyAny>>) -> PyResult<Variable> {
        let mut arguments = [Some(x), y].into_iter().flatten();
        let variable = arguments.find_map(|x| x.cast::<Variable>().ok());
        let variable = variable.ok_or_else(|| PyTypeError::new_err("no variable of H"))?;
        let read = |x: &Bound<'_, PyAny>| -> PyResult<Var> {
            number(x)?.ok_or_else(|| PyTypeError::new_err("a table is a function of numbers"))
        };
        let value = match (&self.kind, y) {
            (Kind::Two(surface), Some(y)) => surface.at(read(x)?, read(y)?),
            (Kind::One(spline), _) => spline.at(read(x)?),
            (Kind::Two(_), None) => return Err(PyTypeError::new_err("a value of y is missing")),
        };
        Ok(variable.get().of(value))
    }

    /// Values at numbers; beyond a table that does not extrapolate an error.
    fn values<'py>(
        &self,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Doubles<'py>> {
        let axes = [x.as_slice()?, y.as_slice()?];
        let ranges = self.range();
        for (values, &(first, last)) in axes.into_iter().zip(&ranges) {
            let is_outside = |x: &&f64| **x < first || **x > last;
            if let Some(&x) = values.iter().find(is_outside).filter(|_| !self.extrapolate) {
                return Err(value_error(TableError::OutsideOfTable { x, first, last }));
            }
        }
        let points = axes[0].iter().zip(axes[1]);
        let values: Vec<f64> = match &self.kind {
            Kind::One(spline) => points.map(|(&x, _)| spline.at(Num(x)).0).collect(),
            Kind::Two(surface) => points
                .map(|(&x, &y)| surface.at(Num(x), Num(y)).0)
                .collect(),
        };
        Ok(values.into_pyarray(x.py()))
    }

    /// First and last knot of each variable.
    fn range(&self) -> Vec<(f64, f64)> {
        let ranges = match &self.kind {
            Kind::One(spline) => vec![spline.range()],
            Kind::Two(surface) => surface.range().to_vec(),
        };
        ranges.iter().map(|r| (*r.start(), *r.end())).collect()
    }
}
