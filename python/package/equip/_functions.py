"""Functions for use within H that NumPy lacks: erf, erfc, and splines through data."""

from __future__ import annotations

from typing import Any, Optional, Union

import numpy as np

from . import _arrays, _native
from ._numbers import pair, pairs

Ends = Union[str, tuple[tuple[int, Any], tuple[int, Any]]]


def erf(x: Any) -> Any:
    """The error function, 2/√π ∫ exp(-t²) dt from 0 to x, of numbers and of q and p within H."""
    return _each(_arrays.ERF, x)


def erfc(x: Any) -> Any:
    """1 - erf(x), without cancellation, of numbers and of q and p within H."""
    return _each(_arrays.ERFC, x)


def _each(function: np.ufunc, x: Any) -> Any:
    if _has_variables(x):
        return _arrays._dressed(function(_arrays._plain(x)))
    found = np.asarray(function(np.asarray(x, dtype=float)), dtype=float)
    return found if found.shape else float(found)


class Table:
    """A cubic spline through data, in one or two variables, built by `equip.table` or `equip.table2`.

    Within H, a table called with variables is recorded as one operation, for any number of points. Called
    with numbers, it returns values. If the motion leaves the range of the knots, the run ends with an error,
    unless the table was built with `extrapolate=True`.
    """

    def __init__(self, native: _native.Table, made_of: tuple[Any, ...]) -> None:
        self._native = native
        self._made_of = made_of

    @property
    def range(self) -> list[tuple[float, float]]:
        """The first and the last knot of each variable."""
        return self._native.range()

    def __call__(self, x: Any, y: Any = None) -> Any:
        given = [x] if y is None else [x, y]
        if len(given) != len(self.range):
            raise TypeError(f"this table has {len(self.range)} variables; it was called with {len(given)}")
        if any(_has_variables(part) for part in given):
            at = np.frompyfunc(self._at, len(given), 1)
            return _arrays._dressed(at(*(_arrays._plain(part) for part in given)))
        points = np.broadcast_arrays(*(np.asarray(part, dtype=float) for part in given))
        values = self._native.values(np.ravel(points[0]), np.ravel(points[-1])).reshape(points[0].shape)
        return values if values.shape else float(values)

    def _at(self, x: Any, y: Any = None) -> Any:
        if isinstance(x, _native.Variable) or isinstance(y, _native.Variable):
            return self._native.at(x, y)
        return self(x, y)

    def __repr__(self) -> str:
        return "<table from " + ", ".join(f"{low:g} to {high:g}" for low, high in self.range) + ">"

    def __reduce__(self) -> tuple[Any, ...]:
        return self._made_of[0], self._made_of[1:]


def _has_variables(x: Any) -> bool:
    if isinstance(x, _native.Variable):
        return True
    return (
        isinstance(x, np.ndarray)
        and x.dtype == object
        and any(isinstance(part, _native.Variable) for part in x.flat)
    )


def _flat(x: Any, name: str, axes: int) -> tuple[list[float], list[float]]:
    high, low = pairs(x, name)
    if high.ndim != axes:
        raise ValueError(f"{name} has shape {high.shape}; it must have {axes} axes")
    return high.ravel().tolist(), low.ravel().tolist()


def _orders(ends: Any) -> set[Any]:
    """Orders of the derivatives at both ends; empty for what is no ((order, a), (order, b))."""
    pairs_of = isinstance(ends, (tuple, list)) and len(ends) == 2
    if not pairs_of or not all(isinstance(end, (tuple, list)) and len(end) == 2 for end in ends):
        return set()
    return {end[0] for end in ends}


def table(x: Any, y: Any, bc_type: Ends = "not-a-knot", extrapolate: bool = False) -> Table:
    """The cubic spline through the points (x_i, y_i), for use within H: `v = equip.table(x, y)`, `v(q[0])`.

    It is the spline of `scipy.interpolate.CubicSpline`, computed with 31 digits.

    Parameters
    ----------
    x
        Knots, (n,), ascending.
    y
        Values, (n,).
    bc_type
        End conditions: "not-a-knot" (4 points or more), "natural" (second derivatives are 0), "clamped"
        (first derivatives are 0), ((1, a), (1, b)) or ((2, a), (2, b)) (given first or second derivatives).
    extrapolate
        Whether the polynomials of the end intervals continue beyond the first and the last knot. Otherwise a
        run ends with an error if the motion leaves the table, and calls with numbers outside the range raise.

    Raises
    ------
    ValueError
        For too few points, knots that do not ascend, and numbers that are not finite.

    Examples
    --------
    >>> from equip import Hamiltonian
    >>> x = np.linspace(-2, 2, 9)
    >>> well = table(x, x**3)
    >>> well(0.5)
    0.125
    >>> Hamiltonian(lambda q, p: p @ p / 2 + well(q[0]) ** 2, shape=1)([0.5], [0.0])
    0.015625
    """
    named = {"natural": ((2, 0.0), (2, 0.0)), "clamped": ((1, 0.0), (1, 0.0))}
    kinds = {1: "slopes", 2: "curvatures"}
    kind, numbers = "not-a-knot", (0.0, 0.0)
    if bc_type != "not-a-knot":
        ends = named.get(bc_type) if isinstance(bc_type, str) else bc_type
        orders = _orders(ends)
        if ends is None or len(orders) != 1 or not orders <= {1, 2}:
            raise ValueError(
                f"bc_type is {bc_type!r}; it must be 'not-a-knot', 'natural', 'clamped', ((1, a), (1, b)) or "
                "((2, a), (2, b))"
            )
        kind, numbers = kinds[orders.pop()], (ends[0][1], ends[1][1])
    both = (pair(numbers[0], "bc_type"), pair(numbers[1], "bc_type"))
    native = _native.Table.one(_flat(x, "x", 1), _flat(y, "y", 1), kind, both, bool(extrapolate))
    return Table(native, (table, x, y, bc_type, extrapolate))


def table2(x: Any, y: Any, z: Any, bc_type: str = "not-a-knot", extrapolate: bool = False) -> Table:
    """The bicubic spline through values on a grid, for use within H: `v(q[0], q[1])`.

    Parameters
    ----------
    x, y
        Knots, (n,) and (k,), ascending.
    z
        Values, (n, k).
    bc_type
        Conditions at the edges: "not-a-knot" (4 knots or more in each variable), or "natural".
    extrapolate
        As of `table`.

    Raises
    ------
    ValueError
        For too few points, knots that do not ascend, and numbers that are not finite.
    """
    if bc_type not in ("natural", "not-a-knot"):
        raise ValueError(f"bc_type is {bc_type!r}; it must be 'not-a-knot' or 'natural'")
    expected: Optional[tuple[int, int]] = (len(x), len(y))
    if np.shape(z) != expected:
        raise ValueError(f"z has shape {np.shape(z)}; for these x and y it must have {expected}")
    numbers = (_flat(x, "x", 1), _flat(y, "y", 1), _flat(z, "z", 2))
    native = _native.Table.two(*numbers, bc_type, bool(extrapolate))
    return Table(native, (table2, x, y, z, bc_type, extrapolate))
