"""Initial conditions of ensembles: drawn at random, or given as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import _native
from .._numbers import Floats, Shape, number, pairs, whole


def draw_starts(q0: Any, p0: Any, n: int, *, seed: int = 0, spread: float = 0.01) -> tuple[Floats, Floats]:
    """`n` random initial conditions near (q0, p0): positions and momenta, (n, *shape) each.

    Every component x becomes x (1 + spread u), with an independent u, uniform in [-1, 1). Zero components
    stay zero. Number i depends on `seed` and i alone; the first n of a larger set are therefore the same.
    `drawn_start` of the Rust library draws the same initial conditions.

    Parameters
    ----------
    q0, p0
        One initial condition; q0 and p0 have the shape of the Hamiltonian.
    n
        The number of initial conditions.
    seed
        A whole number from 0 to 2^64 - 1.
    spread
        The largest relative change of a component.

    Examples
    --------
    >>> q, p = draw_starts([1.0, 0.0], [0.0, 2.0], 100, seed=7)
    >>> q.shape, bool(abs(q[:, 0] - 1).max() <= 0.01), bool((q[:, 1] == 0).all())
    ((100, 2), True, True)
    """
    (q, _), (p, _) = pairs(q0, "q0"), pairs(p0, "p0")
    if q.shape != p.shape:
        raise ValueError(f"q0 has shape {q.shape}, but p0 has {p.shape}")
    n, seed, spread = whole(n, "n", 1), whole(seed, "seed", 0), number(spread, "spread")
    if not 0 <= spread < np.inf:
        raise ValueError(f"spread is {spread}; it must be finite and not negative")
    drawn = _native.draw_starts(q.ravel().tolist(), p.ravel().tolist(), n, seed, spread)
    return drawn[0].reshape(-1, *q.shape), drawn[1].reshape(-1, *q.shape)


def starts_of(x: Any, shape: Shape, name: str, precision: str) -> Floats:
    """Positions or momenta of N initial conditions, (N, *shape); in double-double (N, 2, *shape), with high
    and low words."""
    high, low = pairs(x, name)
    if high.shape[1:] != shape or high.ndim != len(shape) + 1:
        raise ValueError(f"{name} has shape {high.shape}; it must be (N, {', '.join(map(str, shape))})")
    return np.stack([high, low], axis=1) if precision == "dd" else high
