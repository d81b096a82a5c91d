"""Energies and potentials that other code computes, as functions of flat arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from . import _native, _recording
from ._numbers import Floats, Shape


def external(value: Any, gradient: Any, axes: Shape, accuracy: float) -> _native.Recorded:
    """H and its gradient as functions of (q, p)."""
    _check(value, gradient, "q, p")
    number = _number(value, axes, "value(q, p)")

    def derivative(q: Floats, p: Floats) -> Floats:
        found = gradient(q.reshape(axes), p.reshape(axes))
        if not isinstance(found, (tuple, list)) or len(found) != 2:
            raise TypeError("gradient(q, p) must return two arrays, those of ∂H/∂q and of ∂H/∂p")
        return np.concatenate([_flat(part, axes, "gradient(q, p)") for part in found])

    return _native.Recorded.external(math.prod(axes), accuracy, number, derivative)


def potential(
    value: Any, gradient: Any, axes: Shape, masses: tuple[float, ...], accuracy: float
) -> _native.Recorded:
    """U and its gradient as functions of q."""
    _check(value, gradient, "q")
    number = _number(value, axes, "value(q)")

    def derivative(q: Floats) -> Floats:
        return _flat(gradient(q.reshape(axes)), axes, "gradient(q)")

    return _native.Recorded.external_potential(np.array(masses), accuracy, number, derivative)


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
