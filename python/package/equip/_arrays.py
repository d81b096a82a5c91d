"""Arrays of variables, as H(q, p) receives them: what NumPy does to them is recorded, or refused in words."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from fractions import Fraction
from typing import Any, Optional

import numpy as np

from ._native import Condition, Variable
from ._numbers import has_units

COMPARED = (
    "variables of H cannot be compared: H(q, p) is called once, before any state is known, to record its "
    "formula. Use np.where on a condition with <, <=, > or >=, np.minimum, np.maximum, np.clip or abs() on q "
    "and p, or choose between two Hamiltonians outside H"
)
STORED = (
    "variables of H cannot be stored in an array of numbers: collect them with np.stack or in a list, or "
    "make the array with dtype=object"
)

COMPLEX = "H is real: use no complex numbers in it"
SELECTED = (
    "q and p cannot be selected by a comparison of variables of H: write np.where(condition, q, 0), or "
    "select by an array of booleans"
)
SPARSE = "a sparse matrix cannot be multiplied with variables of H: write A.toarray() @ q"
MASKED = "a masked array cannot be used in H: write array.filled(value)"
CONDITION = "a comparison of variables of H is not a number: choose by np.where(condition, a, b)"
UNDEFINED = (
    "np.select has no value where none of its conditions holds: give a default, or a last condition that is "
    "True (in sympy.Piecewise too)"
)
UNITS = (
    "H computes with plain numbers: use no quantities with units in it, but their values in one system of "
    "units"
)
WHERE = "where= cannot be a comparison of variables of H: write np.where(condition, q, 0).sum()"

#: What to write instead of functions of NumPy, by their names.
_ADVICE = {
    "interp": "make a spline of the data by equip.table",
    "sinc": "write np.sin(np.pi * x) / (np.pi * x)",
    "copysign": "write abs(x) * np.sign(y)",
    "inv": "write the inverse out, or invert a matrix of numbers outside H",
    "solve": "write the solution out, or np.linalg.inv(A) @ q with a matrix A of numbers",
    "det": "write the determinant out",
}


def unavailable(name: str) -> TypeError:
    if name in _ADVICE:
        return TypeError(f"the function {name} of variables of H cannot be recorded: {_ADVICE[name]}")
    return TypeError(
        f"the function {name} cannot be recorded: H may use + - * / ** @, sums, products, einsum, norms, "
        "exponentials, logarithms, trigonometric and hyperbolic functions, np.arctan2, np.hypot, np.minimum, "
        "np.maximum, np.clip, np.where, np.select, np.floor, np.round, % and abs(), equip.erf and equip."
        "table of q and p, and any function of numbers alone"
    )


class Variables(np.ndarray):
    """An array of variables of H, and of numbers."""

    #: Above those of sparse and masked arrays: operators of q with them come here.
    __array_priority__ = 100.0

    def __getitem__(self, index: Any) -> Any:
        _check_index(index)
        return super().__getitem__(index)

    def __setitem__(self, index: Any, value: Any) -> None:
        _check_index(index)
        super().__setitem__(index, value)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        return apply(ufunc, method, inputs, keywords)

    def __array_function__(self, function: Any, types: Any, arguments: Any, keywords: Any) -> Any:
        return call(function, arguments, keywords)


def variables(flat: list[Variable], shape: tuple[int, ...]) -> Variables:
    """`flat` in the given shape."""
    array = np.empty(len(flat), dtype=object)
    array[:] = flat
    return array.reshape(shape).view(Variables)


def _check_index(index: Any) -> None:
    """Refuses a comparison as an index."""
    for part in index if isinstance(index, tuple) else (index,):
        if isinstance(part, (Condition, Variables)) and has_recorded(part):
            raise TypeError(SELECTED)


def has_recorded(x: Any) -> bool:
    """Whether x is a variable or a condition, or an array or list with one in it."""
    if isinstance(x, (list, tuple)):
        return any(has_recorded(part) for part in x)
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(_is_recorded(part) for part in x.flat)
    return _is_recorded(x)


def _is_variable(x: Any) -> bool:
    return isinstance(x, Variable)


def _is_recorded(x: Any) -> bool:
    return isinstance(x, (Variable, Condition))


def _minimum(x: Any, y: Any) -> Any:
    if _is_variable(x):
        return x.minimum(y)
    return y.minimum(x) if _is_variable(y) else min(x, y)


def _maximum(x: Any, y: Any) -> Any:
    if _is_variable(x):
        return x.maximum(y)
    return y.maximum(x) if _is_variable(y) else max(x, y)


def _clip(x: Any, low: Any, high: Any) -> Any:
    return _minimum(_maximum(x, low), high)


def _arctan2(y: Any, x: Any) -> Any:
    if _is_variable(y):
        return y.arctan2(x)
    return x.arctan2_of(y) if _is_variable(x) else math.atan2(y, x)


def _hypot(x: Any, y: Any) -> Any:
    if _is_variable(x):
        return x.hypot(y)
    return y.hypot(x) if _is_variable(y) else math.hypot(x, y)


def _sign(x: Any) -> Any:
    return x.sign() if _is_variable(x) else np.sign(x)


def _fmod(x: Any, y: Any) -> Any:
    if _is_variable(x):
        return x.fmod(y)
    return y.fmod_of(x) if _is_variable(y) else math.fmod(x, y)


def _modf(x: Any) -> Any:
    whole = _trunc(x)
    return x - whole, whole


def _trunc(x: Any) -> Any:
    return x.trunc() if _is_variable(x) else math.trunc(x)


def _erf(x: Any) -> Any:
    return x.erf() if _is_variable(x) else math.erf(x)


def _erfc(x: Any) -> Any:
    return x.erfc() if _is_variable(x) else math.erfc(x)


def _logaddexp(x: Any, y: Any) -> Any:
    """log(exp(x) + exp(y)), smooth: finite where x and y are less than 1400 apart."""
    if not (_is_variable(x) or _is_variable(y)):
        return float(np.logaddexp(float(x), float(y)))
    return (x + y) / 2 + (2 * ((x - y) / 2).cosh()).log()


def _where(condition: Any, a: Any, b: Any) -> Any:
    return condition.choose(a, b) if isinstance(condition, Condition) else a if condition else b


def _function(python: Callable[..., Any], arguments: int, results: int = 1) -> np.ufunc:
    function: np.ufunc = np.frompyfunc(python, arguments, results, identity=None)
    return function


_MINIMUM, _MAXIMUM, _CLIP = _function(_minimum, 2), _function(_maximum, 2), _function(_clip, 3)

_WHERE = _function(_where, 3)


def _unary(ufunc: np.ufunc) -> np.ufunc:
    """A function that variables have as a method, of variables and of numbers."""
    name = ufunc.__name__

    def each(x: Any) -> Any:
        if isinstance(x, Condition):
            raise TypeError(CONDITION)
        return getattr(x, name)() if _is_variable(x) else float(ufunc(float(x)))

    return _function(each, 1)


#: Of numbers, variables and arrays of either.
ERF, ERFC = _function(_erf, 1), _function(_erfc, 1)

#: Functions of other packages, by name.
_NAMED = {"erf": ERF, "erfc": ERFC}

#: What NumPy does by comparing, or by a method of the first argument only, and what is done instead.
_INSTEAD: dict[Any, np.ufunc] = {
    np.minimum: _MINIMUM,
    np.fmin: _MINIMUM,
    np.maximum: _MAXIMUM,
    np.fmax: _MAXIMUM,
    np.arctan2: _function(_arctan2, 2),
    np.hypot: _function(_hypot, 2),
    np.float_power: np.power,
    np.sign: _function(_sign, 1),
    np.logaddexp: _function(_logaddexp, 2),
    np.remainder: _function(operator.mod, 2),
    np.floor_divide: _function(operator.floordiv, 2),
    np.divmod: _function(divmod, 2, 2),
    np.fmod: _function(_fmod, 2),
    np.modf: _function(_modf, 1, 2),
    np.greater: _function(operator.gt, 2),
    np.greater_equal: _function(operator.ge, 2),
    np.less: _function(operator.lt, 2),
    np.less_equal: _function(operator.le, 2),
    np.logical_and: np.bitwise_and,
    np.logical_or: np.bitwise_or,
    np.logical_not: np.invert,
}

_METHODS = (
    np.sqrt, np.exp, np.exp2, np.expm1, np.log, np.log2, np.log10, np.log1p, np.sin, np.cos, np.tan,
    np.arcsin, np.arccos, np.arctan, np.sinh, np.cosh, np.tanh, np.arcsinh, np.arccosh, np.arctanh, np.cbrt,
    np.fabs, np.deg2rad, np.rad2deg, np.floor, np.ceil, np.trunc, np.rint,
)  # fmt: skip
_INSTEAD |= {ufunc: _unary(ufunc) for ufunc in _METHODS}
_INSTEAD |= {np.radians: _INSTEAD[np.deg2rad], np.degrees: _INSTEAD[np.rad2deg]}

_COMPARISONS = {
    np.equal, np.not_equal, np.heaviside, np.logical_xor, np.isnan, np.isfinite, np.isinf, np.signbit,
}  # fmt: skip

_RECORDED = {
    "add", "subtract", "multiply", "divide", "negative", "positive", "absolute", "square", "reciprocal",
    "power", "conjugate", "matmul", "vecdot", "matvec", "vecmat", "bitwise_and", "bitwise_or", "invert",
}  # fmt: skip


def _exact(x: Any) -> Any:
    """A long double as a fraction: NumPy would ask it for the product with a variable, and it NumPy."""
    return Fraction(*x.as_integer_ratio()) if np.isfinite(x) else float(x)


def _plain(x: Any) -> Any:
    """An array that NumPy works on element by element."""
    if hasattr(x, "toarray") and hasattr(x, "nnz"):
        raise TypeError(SPARSE)
    if has_units(x):
        raise TypeError(UNITS)
    if isinstance(x, np.ma.MaskedArray):
        if np.ma.is_masked(x):
            raise TypeError(MASKED)
        x = x.data
    kind = getattr(x, "dtype", None)
    if kind == np.longdouble and kind != np.float64:
        numbers = np.array([_exact(number) for number in np.ravel(x)], dtype=object)
        return numbers.reshape(np.shape(x))
    if kind is not None and kind.kind == "c":
        raise TypeError(COMPLEX)
    if isinstance(x, Variables):
        return x.view(np.ndarray)
    if _is_recorded(x):
        array = np.empty((), dtype=object)
        array[()] = x
        return array
    return x


def _dressed(x: Any) -> Any:
    if isinstance(x, tuple):
        return tuple(_dressed(part) for part in x)
    if isinstance(x, list):
        return [_dressed(part) for part in x]
    if isinstance(x, np.ndarray) and x.dtype == object:
        return x[()] if x.ndim == 0 else x.view(Variables)
    return x


def apply(ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], keywords: Optional[dict[str, Any]]) -> Any:
    """A ufunc on operands of which at least one is a variable or an array of them."""
    if ufunc in _COMPARISONS:
        raise TypeError(COMPARED)
    used = _INSTEAD.get(ufunc) or _NAMED.get(ufunc.__name__, ufunc)
    if ufunc.__name__ == "clip":
        used = _CLIP
    elif used is ufunc and ufunc.__name__ not in _RECORDED:
        raise unavailable(ufunc.__name__)
    options = dict(keywords or {})
    targets = options.pop("out", None)
    if targets is not None:
        for target in targets:
            if isinstance(target, np.ndarray) and target.dtype != object:
                raise TypeError(STORED)
        options["out"] = tuple(_plain(target) for target in targets)
    if method == "reduce" and options.get("where", True) is not True:
        if has_recorded(options["where"]):
            raise TypeError(WHERE)
        _begin_reduction(ufunc, options)
    result = getattr(used, method)(*(_plain(x) for x in inputs), **options)
    if targets is not None and len(targets) == 1:
        return targets[0]
    return _dressed(result)


def _begin_reduction(ufunc: np.ufunc, options: dict[str, Any]) -> None:
    """Gives sums and products of chosen elements their first value, which NumPy has for numbers alone."""
    values: dict[Any, int] = {np.add: 0, np.multiply: 1}
    first = values.get(ufunc)
    if first is not None and options.get("initial", None) in (None, np._NoValue):
        options["initial"] = first


def _arrays(x: Any) -> Any:
    """Variables as arrays without an axis, wherever they stand in the arguments of a function."""
    if _is_recorded(x):
        return _plain(x).view(Variables)
    if isinstance(x, (tuple, list)):
        return type(x)(_arrays(part) for part in x) if type(x) in (tuple, list) else x
    return x


_EMPTY = np.empty(0, dtype=object).view(Variables)


def call(function: Any, arguments: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
    """A function of NumPy with variables among its arguments."""
    if function is np.where:
        if len(arguments) != 3:
            raise TypeError(COMPARED)
        return _dressed(_WHERE(*(_plain(x) for x in arguments)))
    if function is np.select:
        return _select(*arguments, **keywords)
    if function is np.fix:
        return np.trunc(*arguments, **keywords)
    if function is np.sinc:
        raise unavailable("sinc")
    if function is np.polyval:
        return _polyval(*arguments, **keywords)
    if function is np.linalg.norm:
        found = _norm(*arguments, **keywords)
        if found is not NotImplemented:
            return found
    given = {name: _arrays(x) for name, x in keywords.items()}
    try:
        result = np.ndarray.__array_function__(
            _EMPTY, function, (Variables,), _arrays(tuple(arguments)), given
        )
    except TypeError as error:
        text = str(error)
        if "of H" in text or "recorded" in text:
            raise
        raise unavailable(function.__name__) from error
    return _dressed(result)


def _select(condlist: Any, choicelist: Any, default: Any = 0) -> Any:
    """The choice of the first condition that holds, as `np.select`."""
    if len(condlist) != len(choicelist):
        raise ValueError(f"np.select has {len(condlist)} conditions and {len(choicelist)} choices")
    chosen = default
    for condition, choice in reversed(list(zip(condlist, choicelist))):
        if has_recorded(condition) and not has_recorded(chosen) and np.isnan(chosen).any():
            raise TypeError(UNDEFINED)
        chosen = _dressed(_WHERE(*(_plain(x) for x in (condition, choice, chosen))))
    return chosen


def _polyval(p: Any, x: Any) -> Any:
    """p[0] x^(n-1) + ... + p[n-1], as `np.polyval`."""
    value: Any = 0
    for coefficient in p:
        value = value * x + coefficient
    return value


_REAL = (int, float, np.integer, np.floating)


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    """A norm of vectors that NumPy takes by other means; `NotImplemented` for all others."""
    if not isinstance(x, (np.ndarray, list, tuple)):
        return NotImplemented
    x = _dressed(_plain(x)) if isinstance(x, np.ndarray) else np.stack(x)
    is_vector = x.ndim == 1 if axis is None else isinstance(axis, (int, np.integer))
    if not is_vector or ord in (None, 1, 2, "fro"):
        return NotImplemented
    if isinstance(ord, _REAL) and abs(ord) == np.inf:
        size = np.max if ord > 0 else np.min
        return size(np.abs(x), axis=axis, keepdims=keepdims)
    if not isinstance(ord, _REAL) or ord == 0:
        raise TypeError(
            f"the norm of order {ord!r} cannot be recorded: it jumps. Use orders from 1 to np.inf"
        )
    return np.sum(np.abs(x) ** ord, axis=axis, keepdims=keepdims) ** (1 / ord)
