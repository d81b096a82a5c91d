"""`steps`: a run one step at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Optional, Union

import numpy as np

from . import _native
from ._certificate import Certificate
from ._events import Change, Event, changes_of, events_of, raise_of
from ._hamiltonian import Function, Hamiltonian
from ._methods import Equip, Method
from ._numbers import Floats, Shape, number, state
from ._solve import interval_of, options


@dataclass(frozen=True, eq=False)
class Occurrence:
    """A root of an event function."""

    #: Index of the function in the list of events.
    event: int
    t: float
    #: Positions and momenta there, each of the shape of the Hamiltonian; before `event.then` changes them.
    q: Floats
    p: Floats


@dataclass(frozen=True, eq=False)
class Step:
    """An accepted step, at its end, in the units of H."""

    #: Number of the step, from 1; 0 is the initial state.
    index: int
    t: float
    #: Step size.
    step: float
    #: Positions and momenta, each of the shape of the Hamiltonian.
    q: Floats
    p: Floats
    #: H - H_ref, H_ref being H at the start or after the last change; None if not measured.
    energy_error: Optional[float]
    #: α_1 ... α_{s-1}.
    alphas: Floats
    outcome: str
    #: The events of the step, or of all steps of `Steps.advance_to`, in the order of the run.
    events: tuple[Occurrence, ...] = ()


class Steps:
    """An endless iterator of steps, built by `equip.steps`.

    `next` raises `equip.IntegrationError` if the step fails; the state is then the state before the step.
    """

    def __init__(self, native: _native.Steps, shape: Shape, changes: Sequence[Change] = ()) -> None:
        self._native = native
        self._shape = shape
        self._changes = changes

    def __iter__(self) -> Steps:
        return self

    def __next__(self) -> Step:
        self._native.advance()
        return self._made()

    def advance_to(self, t: float) -> Step:
        """Makes the steps to exactly the time t, forward or backward, and returns the last step. The tangent
        vectors are propagated over all steps. Ctrl-C ends the call after the current step; the run can
        continue from there.

        Raises
        ------
        ValueError
            If t is not finite.
        equip.IntegrationError
            If a step fails; the state is then the state before the step.
        """
        self._native.advance_to(number(t, "t"))
        return self._made()

    def _made(self) -> Step:
        """The last step, unless a function of the user has raised an exception."""
        raise_of(self._changes)
        return self.last

    @property
    def t(self) -> float:
        """The time reached."""
        return self.last.t

    @property
    def q(self) -> Floats:
        """Positions now."""
        return self.last.q

    @property
    def p(self) -> Floats:
        """Momenta now."""
        return self.last.p

    def turn_back(self) -> None:
        """Reverses the direction of time of all further steps."""
        self._native.turn_back()

    @property
    def last(self) -> Step:
        """The last step, or the initial state."""
        index, t, size, y, defect, alphas, outcome, found = self._native.made()
        q, p = y.reshape(2, *self._shape)
        events = tuple(Occurrence(event, at, *state.reshape(2, *self._shape)) for event, at, state in found)
        return Step(index, t, size, q, p, defect, alphas, outcome, events)

    @property
    def certificate(self) -> Certificate:
        """The certificate of the run so far."""
        return Certificate._of(self._native.certificate())

    @property
    def tangent_vectors(self) -> Floats:
        """The propagated tangent vectors (δq, δp), flat, (k, 2m). You may set them, for instance to normalise
        them."""
        return self._native.tangent_vectors().reshape(-1, 2 * int(np.prod(self._shape)))

    @tangent_vectors.setter
    def tangent_vectors(self, tangent_vectors: Any) -> None:
        given = _tangent_vectors(tangent_vectors)
        if given.shape != self.tangent_vectors.shape:
            raise ValueError(
                f"tangent_vectors have shape {given.shape}; they must keep {self.tangent_vectors.shape}"
            )
        self._native.set_tangent_vectors(given.ravel().tolist())

    def restart(self, q0: Any, p0: Any, t0: float = 0.0) -> None:
        """Begins a new run and reuses the preparations of this one. The new run has the same bits as a run
        from `equip.steps`. Tangent vectors stay.

        Parameters
        ----------
        q0, p0
            Positions and momenta at the start, each of the shape of the Hamiltonian.
        t0
            Initial time.
        """
        q, p = state(q0, self._shape, "q0")[0], state(p0, self._shape, "p0")[0]
        self._native.restart(q, p, number(t0, "t0"))

    def set_state(self, q: Any, p: Any) -> None:
        """Changes the state to (q, p) at the time reached, as in a kick. From then on the run conserves the
        value of H at this state.

        Parameters
        ----------
        q, p
            Positions and momenta, each of the shape of the Hamiltonian.
        """
        self._native.set_state(state(q, self._shape, "q")[0], state(p, self._shape, "p")[0])


def _tangent_vectors(tangent_vectors: Any) -> Floats:
    """Tangent vectors as finite numbers."""
    try:
        given = np.asarray(tangent_vectors, dtype=float)
    except (TypeError, ValueError):
        raise ValueError("tangent_vectors must be an array of numbers, (k, 2m) or (2m,)") from None
    if not np.isfinite(given).all():
        raise ValueError("tangent_vectors have entries that are not finite; give finite numbers")
    return given


def steps(
    h: Hamiltonian,
    q0: Any,
    p0: Any,
    t0: float = 0.0,
    *,
    method: Method = Equip(stages=8),
    step: Optional[float] = None,
    tolerance: Optional[float] = None,
    tangent_vectors: Any = None,
    events: Union[None, Event, Sequence[Event]] = None,
    invariants: Optional[Mapping[str, Function]] = None,
    preserve: Optional[Mapping[str, Function]] = None,
    measure_energy: bool = True,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    rtol: Any = None,
    atol: Any = None,
) -> Steps:
    """A run one step at a time: an endless iterator. Times, positions and momenta are in the units in
    which H is written.

    Parameters
    ----------
    h
        The energy: H(q, p), or H(t, q, p) by `Hamiltonian.with_time`.
    q0, p0
        Positions and momenta at the start, each of the shape `h.shape`.
    t0
        Initial time.
    method
        Any of the six methods; `equip.AveragedVectorField`, `equip.Trapezoidal` and `equip.Hbvm` of degree 1
        need `step`.
    step, tolerance
        Either a fixed step size (negative for a run backward in time), or a tolerance: the error of a step
        relative to the change of the state over the step. The default is the tolerance 1e-12.
    invariants, preserve
        Quantities f(q, p) by name, to monitor in the certificate, and to conserve like the energy;
        f(t, q, p) if H depends on time.
    measure_energy
        Whether methods without free α evaluate the energy.
    first_step, min_step, max_step
        Of variable steps: step sizes, in the unit of time.
    rtol, atol
        Of variable steps: `rtol` replaces `tolerance`, component by component; `atol` is an absolute error
        that is always allowed. A number or an array of the shape of q for positions and momenta alike, or a
        tuple of two such, for positions and for momenta.
    tangent_vectors
        Tangent vectors (δq, δp), flat, (k, 2m) or (2m,), also if H depends on time, propagated by the tangent
        map of the steps;
        `Steps.tangent_vectors` has them.
    events
        Functions g(t, q, p) whose roots are located, as in `equip.solve`, also between the ends of steps;
        `Step.events` has the roots. An attribute `then`, a function of (t, q, p) that returns (q, p), changes
        the state: the step ends at the event, and the run continues from the changed state.

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
        rtol=rtol,
        atol=atol,
        invariants=invariants,
        preserve=preserve,
        measure_energy=measure_energy,
    )
    n = 2 * int(np.prod(h.shape))
    propagated = (
        np.empty((0, n)) if tangent_vectors is None else np.atleast_2d(_tangent_vectors(tangent_vectors))
    )
    if propagated.ndim != 2 or propagated.shape[1] != n:
        raise ValueError(
            f"tangent_vectors have shape {propagated.shape}; they must have (k, {n}): δq and δp, flat, in "
            "each row"
        )
    given["events"] = events_of(events, h.shape)
    changes = changes_of(given["events"])
    if any(terminal for _, _, _, terminal, _ in given["events"]):
        raise ValueError("events of equip.steps do not end a run: omit terminal, and break out of the loop")
    if changes and propagated.size:
        raise ValueError(
            "events that change the state are not available with tangent vectors: omit one of them"
        )
    (q, _), (p, _) = state(q0, h.shape, "q0"), state(p0, h.shape, "p0")
    native = _native.Steps(h._recorded, q, p, number(t0, "t0"), given, propagated.ravel().tolist())
    return Steps(native, h.shape, changes)


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
    """A fixed step size that reaches `target` over the span; the span is a multiple of it.

    Parameters
    ----------
    h
        The energy: H(q, p), or H(t, q, p) by `Hamiltonian.with_time`.
    q0, p0
        Positions and momenta at the start, each of the shape `h.shape`.
    span
        Start and end of the interval, in the unit of time; they differ.
    method
        The method, with the number of stages.
    target, by
        "trajectory": the largest error of a component of q and p, in their units. "energy": the largest
        |H - H_ref| of the Gauss method with the same number of stages. "phase": the phase hω of the
        fastest motion at the initial state, in radians.

    Returns
    -------
    float
        The step size, in the unit of time; positive also if the span goes backward.

    Raises
    ------
    equip.IntegrationError
        If rounding limits the error to more than the target, or if no trial of reasonable length reaches
        the target.
    ValueError
        For input that cannot be used.
    """
    if by not in ("trajectory", "energy", "phase"):
        raise ValueError(f"by is {by!r}; it must be 'trajectory', 'energy' or 'phase'")
    (q, _), (p, _) = state(q0, h.shape, "q0"), state(p0, h.shape, "p0")
    start, end = interval_of(span)
    times = (start[0], end[0])
    if times[0] == times[1]:
        raise ValueError(f"span has no length, {times[0]:g} to {times[1]:g}; give two different times")
    # The step is a fixed one: one stage has such steps as well.
    given = options(h, method, 1.0, None)
    return _native.suggest_step(h._recorded, (q, p), times, given, (by, number(target, "target")))
