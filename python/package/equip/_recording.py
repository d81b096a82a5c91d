"""Calls of the functions that are recorded, and messages for their errors."""

from __future__ import annotations

import inspect
import operator
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from . import _arrays, _native

#: Python's own texts for arrays of np.array that hold numbers and variables: their type is not ours.
_MIXED = re.compile(
    r"does not support argument \d+ of type \S+ which has no callable (\w+) method"
    r"|'(?:float|int|numpy\.\w+)' object has no attribute '(arctan2|hypot)'"
)


def _in_words(error: Exception) -> str:
    """What to write instead, where the text of an error does not say so; else empty."""
    text = str(error)
    if "no supported conversion for types" in text and "dtype('O')" in text:
        return _arrays.SPARSE
    if mixed := _MIXED.search(text):
        name = mixed[1] or mixed[2]
        return f"np.{name} cannot be recorded of variables and numbers in np.array: make it with np.stack"
    return ""


def check_arguments(function: Callable[..., Any], name: str, arguments: str) -> None:
    """Refuses a function that cannot be called with these arguments, such as "t, q, p"."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return
    try:
        signature.bind(*arguments.split(", "))
    except TypeError:
        raise TypeError(f"{name} must be a function of ({arguments}); it takes {signature}") from None


def one_number(found: Any, name: str, arguments: str) -> Any:
    """What a function returned, if it is one number."""
    if isinstance(found, np.ndarray):
        if found.shape:
            raise TypeError(
                f"{name} must return one number; it returned an array of shape {found.shape}: sum over it, "
                "for instance with .sum() or @"
            )
        found = found[()]
    if isinstance(found, _native.Variable):
        return found
    try:
        _native.split(found)
    except TypeError as error:
        if "is not a number" not in str(error):
            raise
        made_of = " and ".join(arguments.rsplit(", ", 1))
        raise TypeError(
            f"{name} must return one number made of {made_of}; it returned {type(found).__name__}"
        ) from None
    except ValueError:
        pass  # A text that is no number; the recording says so.
    return found


def entries(function: Callable[..., Any], n: int, *given: Any) -> list[tuple[int, int, Any]]:
    """The entries (i, j, B_ij) that the function of a bracket makes of variables, n components in all."""
    check_arguments(function, "the bracket", "q, p")
    found = function(*given)
    if not isinstance(found, dict):
        raise TypeError(
            "the bracket must return a dict of its entries, {(i, j): B_ij}; it returned "
            f"{type(found).__name__}"
        )
    made = []
    for place, entry in found.items():
        try:
            i, j = (operator.index(k) for k in place)
        except (TypeError, ValueError):
            raise TypeError(f"{place!r} is no place (i, j) of an entry of the bracket") from None
        if not (0 <= i < n and 0 <= j < n):
            raise ValueError(f"entry {place!r} of the bracket is outside of the {n} components, from 0 on")
        made.append((i, j, one_number(entry, f"entry {place!r} of the bracket", "q, p")))
    return made


def call(function: Callable[..., Any], name: str, arguments: str, *given: Any) -> Any:
    """The one number that a function makes of variables."""
    try:
        found = function(*given)
    except (TypeError, AttributeError) as error:
        text = _in_words(error)
        if not text:
            raise
        raise TypeError(text).with_traceback(error.__traceback__) from None
    return one_number(found, name, arguments)
