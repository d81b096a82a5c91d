"""Numbers from Python: doubles, and numbers with more digits as unevaluated sums of two doubles."""

from __future__ import annotations

import operator
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _native

Floats = NDArray[np.float64]
Shape = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class DoubleDouble:
    """An array of numbers with 31 digits: `high + low`, of which `high` is the nearest doubles."""

    high: Floats
    low: Floats


def shape_of(shape: Union[int, Shape]) -> Shape:
    """`shape` as a tuple of positive integers."""
    axes = tuple(_integer(n) for n in (shape if isinstance(shape, (tuple, list)) else (shape,)))
    if not axes or any(n is None or n < 1 for n in axes):
        raise ValueError(
            f"shape is {shape!r}; it must be the shape of q: a positive integer or a tuple of such"
        )
    return tuple(n for n in axes if n is not None)


def _integer(x: Any) -> Optional[int]:
    """A whole number, also one that is a float; None for all else."""
    try:
        return operator.index(x)
    except TypeError:
        is_whole = isinstance(x, (float, np.floating)) and float(x).is_integer()
        return int(x) if is_whole else None


def whole(x: Any, name: str, least: int, most: int = 2**64 - 1) -> int:
    """A whole number in a range."""
    n = _integer(x)
    if n is None or not least <= n <= most:
        upwards = "or more" if most == 2**64 - 1 and (n is None or n < least) else f"to {most}"
        raise ValueError(f"{name} is {x!r}; it must be a whole number, {least} {upwards}")
    return n


def number(x: Any, name: str) -> float:
    """A number as a float."""
    refuse_units(x, name)
    try:
        return float(x)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {x!r}; it must be a number") from None
    except OverflowError:
        raise ValueError(f"{name} is beyond the largest double, 1.8e308") from None


def truth(x: Any, name: str) -> bool:
    """True or False."""
    if not isinstance(x, (bool, np.bool_)) and x not in (0, 1):
        raise ValueError(f"{name} is {x!r}; it must be True or False")
    return bool(x)


def has_units(x: Any) -> bool:
    """Whether x is a quantity of astropy, pint or unyt, or another array with a unit, or a list of such."""
    if isinstance(x, (list, tuple)):
        return any(has_units(part) for part in x)
    if type(x) in _PLAIN:
        return False
    return any(getattr(x, name, None) is not None for name in ("unit", "units", "dimensionality"))


#: What has no unit, and is asked often.
_PLAIN = (float, int, str, np.ndarray, np.float64)


def refuse_units(x: Any, name: str) -> None:
    """Refuses quantities: their units would be lost in silence."""
    if has_units(x):
        raise ValueError(
            f"{name} has a unit; equip computes with plain numbers, in the units of H: convert it, for "
            f"instance by {name}.to_value('au') of astropy, or {name}.to('au').magnitude of pint"
        )


def refuse_masked(x: Any, name: str) -> None:
    """Refuses arrays with masked entries."""
    if isinstance(x, np.ma.MaskedArray) and np.ma.is_masked(x):
        raise ValueError(f"{name} has masked entries; give all numbers, for instance by {name}.filled(0.0)")


def pairs(x: Any, name: str) -> tuple[Floats, Floats]:
    """`x` as two arrays of doubles whose sum it is: exactly, or to 31 digits where it is a fraction or a
    decimal."""
    if isinstance(x, DoubleDouble):
        high, low = np.asarray(x.high, dtype=float), np.asarray(x.low, dtype=float)
        if high.shape != low.shape:
            raise ValueError(
                f"the parts of {name} have shapes {high.shape} and {low.shape}; they must be equal"
            )
        return high, low
    refuse_masked(x, name)
    refuse_units(x, name)
    try:
        array = np.asarray(x)
    except ValueError:
        raise ValueError(f"{name} is ragged; all of its rows must be equally long") from None
    kind = array.dtype.kind
    if kind == "c":
        raise ValueError(f"{name} is complex; it must be real")
    if kind in "biu" or array.dtype in (np.float64, np.float32, np.float16):
        high = array.astype(float)
        return high, _below(array, high) if kind in "iu" else np.zeros(array.shape)
    try:
        split = (
            [_native.split(number) for number in array.astype(object).ravel().tolist()]
            if kind in "OUS"
            else [_native.split(number) for number in array.ravel()]
        )
    except TypeError as error:
        raise ValueError(f"{name}: {error}") from error
    except OverflowError:
        raise ValueError(f"{name} is beyond the largest double, 1.8e308") from None
    both = np.array(split, dtype=float).reshape((*array.shape, 2))
    return both[..., 0].copy(), both[..., 1].copy()


def _below(integers: NDArray[Any], high: Floats) -> Floats:
    """What the doubles nearest to integers lack."""
    if not (np.abs(high) >= 2.0**53).any():
        return np.zeros(high.shape)
    # A double next to the largest integer is not one of the integers of its dtype.
    differences = [n - int(x) for n, x in zip(integers.ravel().tolist(), high.ravel().tolist())]
    return np.array(differences, dtype=float).reshape(high.shape)


def pair(x: Any, name: str) -> tuple[float, float]:
    """One number as two doubles whose sum it is."""
    high, low = pairs(x, name)
    if high.shape != ():
        raise ValueError(f"{name} has shape {high.shape}; it must be one number")
    return float(high), float(low)


def state(x: Any, shape: Shape, name: str) -> tuple[list[float], list[float]]:
    """A position or a momentum of the given shape, flat."""
    high, low = pairs(x, name)
    if high.shape != shape:
        raise ValueError(f"{name} has shape {high.shape}, but this Hamiltonian needs {shape}")
    return high.ravel().tolist(), low.ravel().tolist()
