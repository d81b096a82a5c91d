"""Energies and potentials that other code computes, as functions of flat arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from . import _native, _recording
from ._numbers import Floats, Shape

SINGLE = 2.0**-23
"""The rounding unit of single precision."""


def external(value: Any, gradient: Any, axes: Shape, accuracy: float) -> _native.Recorded:
    """H and its gradient as functions of (q, p)."""
    _check(value, gradient, "q, p")
    number = _number(value, axes, "value(q, p)")
    digits = _Digits(accuracy)

    def derivative(q: Floats, p: Floats) -> Floats:
        found = gradient(q.reshape(axes), p.reshape(axes))
        if not isinstance(found, (tuple, list)) or len(found) != 2:
            raise TypeError("gradient(q, p) must return two arrays, those of ∂H/∂q and of ∂H/∂p")
        parts = [_flat(part, axes, "gradient(q, p)") for part in found]
        digits.check([q, p], parts)
        return np.concatenate(parts)

    return _native.Recorded.external(math.prod(axes), accuracy, number, derivative)


def potential(
    value: Any, gradient: Any, axes: Shape, masses: tuple[float, ...], accuracy: float
) -> _native.Recorded:
    """U and its gradient as functions of q."""
    _check(value, gradient, "q")
    number = _number(value, axes, "value(q)")
    digits = _Digits(accuracy)

    def derivative(q: Floats) -> Floats:
        found = _flat(gradient(q.reshape(axes)), axes, "gradient(q)")
        digits.check([q], [found])
        return found

    return _native.Recorded.external_potential(np.array(masses), accuracy, number, derivative)


class _Digits:
    """Refuses gradients in single precision that are declared to be more accurate.

    A double with more than 12 bits behind the point is in single precision by chance once in 2**29 times.
    """

    def __init__(self, accuracy: float) -> None:
        self._left = 8 if accuracy < SINGLE else 0
        self._found = 0

    def check(self, state: list[Floats], gradient: list[Floats]) -> None:
        """Looks at the first calls for states that are not in single precision themselves."""
        if self._left and all((_rounded(part) != part).any() for part in state):
            self._left -= 1
            self._found += any(map(_is_single, gradient))
        if self._found >= 4:
            raise ValueError(
                "the gradient is in single precision: declare accuracy=2**-23, or compute it in doubles"
            )


def _is_single(part: Floats) -> bool:
    """Whether all numbers but those of a few bits are in single precision."""
    long = part[(part * 4096) % 1 != 0]
    return bool(long.size and (_rounded(long) == long).all())


def _rounded(part: Floats) -> Any:
    with np.errstate(over="ignore"):
        return part.astype(np.float32)


def masses_of(masses: Any, axes: Shape) -> Floats:
    """One mass for each component of q, from an array that broadcasts to its shape, or has all of them."""
    given = np.asarray(masses, dtype=float)
    if given.shape == (math.prod(axes),):
        return given
    try:
        return np.broadcast_to(given, axes).ravel()
    except ValueError:
        raise ValueError(
            f"masses has shape {given.shape}; it must be one number or an array that broadcasts to {axes}: "
            "for particles in space (n, 1)"
        ) from None


def _check(value: Any, gradient: Any, arguments: str) -> None:
    for name, function in (("value", value), ("gradient", gradient)):
        if not callable(function):
            of = arguments.replace(", ", " and ")
            raise TypeError(f"{name} is {function!r}; it must be a function of {of}")
        _recording.check_arguments(function, name, arguments)


def _number(value: Any, axes: Shape, name: str) -> Callable[..., float]:
    def number(*state: Floats) -> float:
        found = np.asarray(value(*(part.reshape(axes) for part in state)), dtype=float)
        if found.size != 1:
            raise TypeError(f"{name} must return one number; it returned shape {found.shape}")
        return float(found.item())

    return number


def _flat(found: Any, axes: Shape, name: str) -> Floats:
    array: Floats = np.asarray(found, dtype=float)
    if array.shape != axes:
        raise TypeError(f"{name} returned an array of shape {array.shape}; it must be {axes}")
    return array.ravel()
