"""`steps`: a run one step at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, Optional, Union

import numpy as np

from . import _native
from ._certificate import Certificate
from ._hamiltonian import Function, Hamiltonian
from ._methods import Equip, Method, Reversible
from ._numbers import Floats, Shape, state
from ._solve import interval_of, options


@dataclass(frozen=True)
class Step:
    """An accepted step, at its end, in the units of H."""

    #: Number of the step, from 1; 0 is the start.
    index: int
    t: float
    #: Its size.
    step: float
    #: Positions and momenta, each of the shape of the Hamiltonian.
    q: Floats
    p: Floats
    #: H - H(start); None if it was not measured.
    energy_defect: Optional[float]
    #: α_1 ... α_{s-1}.
    alphas: Floats
    outcome: str


class Steps:
    """An endless iterator of steps; `equip.steps` makes it.

    `next` raises `equip.IntegrationError` if the step cannot be made; the state then is that before the step.
    """

    def __init__(self, native: _native.Steps, shape: Shape) -> None:
        self._native = native
        self._shape = shape

    def __iter__(self) -> Steps:
        return self

    def __next__(self) -> Step:
        self._native.advance()
        return self.last

    @property
    def last(self) -> Step:
        """The step made last, or the start."""
        index, t, size, y, defect, alphas, outcome = self._native.made()
        q, p = y.reshape(2, *self._shape)
        return Step(index, t, size, q, p, defect, alphas, outcome)

    @property
    def certificate(self) -> Certificate:
        """What was kept so far, measured."""
        return Certificate._of(self._native.certificate())

    @property
    def deviations(self) -> Floats:
        """The deviations carried along, (k, 2m): each is (δq, δp), flat. They may be set, for instance to
        normalise."""
        return self._native.deviations().reshape(-1, 2 * int(np.prod(self._shape)))

    @deviations.setter
    def deviations(self, deviations: Any) -> None:
        given = np.asarray(deviations, dtype=float)
        if given.shape != self.deviations.shape:
            raise ValueError(f"deviations have shape {given.shape}; they must keep {self.deviations.shape}")
        self._native.set_deviations(given.ravel().tolist())

    def restart(self, q0: Any, p0: Any, t0: float = 0.0) -> None:
        """Begins a new run with what this one has made ready: all its bits are those of a new one.
        Deviations stay."""
        self._native.restart(state(q0, self._shape, "q0")[0], state(p0, self._shape, "p0")[0], float(t0))

    def set_state(self, q: Any, p: Any) -> None:
        """Puts the run at (q, p), at the time it has reached, as after a kick: H is kept at its value there
        from now on."""
        self._native.set_state(state(q, self._shape, "q")[0], state(p, self._shape, "p")[0])


def steps(
    h: Hamiltonian,
    q0: Any,
    p0: Any,
    t0: float = 0.0,
    *,
    method: Method = Equip(stages=8),
    step: Union[None, float, Reversible] = None,
    tolerance: Optional[float] = None,
    deviations: Any = None,
    invariants: Optional[Mapping[str, Function]] = None,
    keep: Optional[Mapping[str, Function]] = None,
    measure_energy: bool = True,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    atol: Any = None,
) -> Steps:
    """A run one step at a time: an endless iterator. Parameters are those of `equip.solve`.

    Parameters
    ----------
    deviations
        Small deviations (δq, δp), flat, (k, 2m) or (2m,), carried along by the tangent map of the steps;
        `Steps.deviations` has them.

    Raises
    ------
    ValueError
        For input that cannot be used.

    Examples
    --------
    >>> pendulum = Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]), shape=1)
    >>> for step in steps(pendulum, [1.0], [0.0], step=0.1):
    ...     if step.t >= 1.0:
    ...         break
    >>> step.index
    10
    """
    given = options(
        h,
        method,
        step,
        tolerance,
        first_step=first_step,
        min_step=min_step,
        max_step=max_step,
        atol=atol,
        invariants=invariants,
        keep=keep,
        measure_energy=measure_energy,
    )
    n = 2 * int(np.prod(h.shape))
    carried = np.empty((0, n)) if deviations is None else np.atleast_2d(np.asarray(deviations, dtype=float))
    if carried.ndim != 2 or carried.shape[1] != n:
        raise ValueError(
            f"deviations have shape {carried.shape}; they must have (k, {n}): δq and δp, flat, in each row"
        )
    (q, _), (p, _) = state(q0, h.shape, "q0"), state(p0, h.shape, "p0")
    return Steps(_native.Steps(h._recorded, q, p, float(t0), given, carried.ravel().tolist()), h.shape)


def suggest_step(
    h: Hamiltonian,
    q0: Any,
    p0: Any,
    span: tuple[float, float],
    target: float,
    *,
    by: Literal["trajectory", "energy", "phase"] = "trajectory",
    method: Method = Equip(stages=8),
) -> float:
    """A fixed step that reaches `target` over the span, which it divides.

    Parameters
    ----------
    target, by
        With "trajectory" the largest error of a position or momentum, in their units; with "energy" the
        largest |H - H(start)| of the Gauss method with as many stages; with "phase" the angle by which the
        fastest motion at the start turns in a step (6.3 is a whole turn).

    Raises
    ------
    equip.IntegrationError
        If rounding leaves more of an error than the target, or no trial of reasonable length reaches it.
    ValueError
        For input that cannot be used.
    """
    if by not in ("trajectory", "energy", "phase"):
        raise ValueError(f"by is {by!r}; it must be 'trajectory', 'energy' or 'phase'")
    (q, _), (p, _) = state(q0, h.shape, "q0"), state(p0, h.shape, "p0")
    start, end = interval_of(span)
    times = (start[0], end[0])
    given = options(h, method, None, None)
    return _native.suggest_step(h._recorded, (q, p), times, given, (by, float(target)))
