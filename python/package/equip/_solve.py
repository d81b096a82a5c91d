"""`solve`: a run over an interval of time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from os import PathLike, fspath
from typing import Any, Literal, Optional, Union

import numpy as np

from . import _native
from ._certificate import Certificate
from ._events import Event, changes_of, events_of, raise_of
from ._hamiltonian import Function, Hamiltonian, of_recording, recorded_quantity
from ._methods import Equip, Method, method_options
from ._numbers import Floats, Shape, number, pair, pairs, refuse_units, state, truth, whole
from ._solution import Solution
from ._terminate import terminating

#: Tolerances taken when neither a step nor a tolerance is given.
_TOLERANCE = {"f64": 1e-12, "dd": 1e-24}

#: Relative error of a conserved quantity from which the message of the run names it: 42 runs that
#: conserve L, L^3 or the Laplace-Runge-Lenz vector of three systems (s = 4, 6, 8) have errors below 1e-11;
#: 16 runs with quantities that no motion conserves have errors above 1e-2.
_NOT_CONSERVED = 1e-9


def _errors(of: Any, shape: Shape, name: str) -> Optional[tuple[list[float], list[float]]]:
    """`rtol` or `atol`: a number or an array shaped like q for positions and momenta, or a pair of such."""
    if of is None:
        return None
    refuse_units(of, name)
    parts = tuple(of) if isinstance(of, (tuple, list)) else (of, of)
    if len(parts) != 2:
        raise ValueError(
            f"{name} has {len(parts)} parts; it must be a number, or a pair for positions and momenta"
        )
    try:
        q, p = (np.broadcast_to(np.asarray(part, dtype=float), shape).ravel().tolist() for part in parts)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(
            f"{name} must be numbers, or arrays of the shape {shape} of q and p: {error}"
        ) from None
    return q, p


def options(
    h: Hamiltonian,
    method: Method,
    step: Any,
    tolerance: Optional[float],
    precision: str = "f64",
    *,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    max_steps: Optional[int] = None,
    rtol: Any = None,
    atol: Any = None,
    invariants: Optional[Mapping[str, Function]] = None,
    preserve: Optional[Mapping[str, Function]] = None,
    measure_energy: bool = True,
    chaos: bool = False,
) -> dict[str, Any]:
    """Options as the native part reads them."""
    if not isinstance(h, Hamiltonian):
        raise TypeError("the first argument is an equip.Hamiltonian: equip.Hamiltonian(function, shape)")
    if not isinstance(precision, str) or precision not in _TOLERANCE:
        raise ValueError(f"precision is {precision!r}; it must be 'f64' or 'dd' (double-double, 31 digits)")
    if step is not None and tolerance is not None:
        raise ValueError("give a step or a tolerance, not both")
    adaptive = {
        "first_step": first_step,
        "rtol": rtol,
        "atol": atol,
        "max_steps": max_steps,
        "min_step": min_step or None,
        "max_step": None if max_step == np.inf else max_step,
    }
    given = [name for name, value in adaptive.items() if value is not None]
    by_tolerance = step is None
    if step is not None and given:
        belong = "belongs" if len(given) == 1 else "belong"
        raise ValueError(f"{' and '.join(given)} {belong} to variable steps: leave out step, or them")

    return {
        **method_options(method, by_tolerance),
        "step": None if step is None else pair(step, "step"),
        "tolerance": _TOLERANCE[precision] if tolerance is None else number(tolerance, "tolerance"),
        "first_step": None if first_step is None else number(first_step, "first_step"),
        "min_step": number(min_step, "min_step"),
        "max_step": np.inf if max_step is None else number(max_step, "max_step"),
        "max_steps": 2**64 - 1 if max_steps is None else whole(max_steps, "max_steps", 1),
        "rtol": _errors(rtol, h.shape, "rtol"),
        "atol": _errors(atol, h.shape, "atol"),
        "invariants": _quantities(invariants, h, "invariants"),
        "preserve": _quantities(preserve, h, "preserve"),
        "measure_energy": truth(measure_energy, "measure_energy"),
        "chaos": truth(chaos, "chaos"),
        "t_eval": ([], []),
        "dense": False,
        "record": 1,
        "events": [],
    }


def _quantities(
    functions: Optional[Mapping[str, Function]], h: Hamiltonian, argument: str
) -> list[tuple[str, _native.Recorded]]:
    """Recordings by name, of `invariants` or `preserve`."""
    if functions is None:
        return []
    if not isinstance(functions, Mapping) or not all(isinstance(name, str) for name in functions):
        raise TypeError(f"{argument} must be a dict of functions by their names: {{'name': function}}")
    return [(name, recorded_quantity(f, h, f"{argument}[{name!r}]")) for name, f in functions.items()]


def interval_of(span: Any) -> tuple[tuple[float, float], tuple[float, float]]:
    """Start and end."""
    refuse_units(span, "span")
    if isinstance(span, str) or not hasattr(span, "__len__") or np.shape(span) == ():
        raise ValueError(f"span is {span!r}; it must be two numbers: (start, end)")
    if len(span) != 2:
        raise ValueError(f"span has two numbers, start and end; this one has {len(span)}")
    start, end = pair(span[0], "span"), pair(span[1], "span")
    if not np.isfinite([start[0], end[0]]).all():
        raise ValueError(
            f"the interval {start[0]:g} to {end[0]:g} must be finite; give two finite times, in either order"
        )
    return start, end


def _record(record: Any) -> int:
    """Every how many steps; 0 for "ends"."""
    if isinstance(record, str) and record == "ends":
        return 0
    try:
        return whole(record, "record", 1)
    except ValueError:
        raise ValueError(f"record is {record!r}; it must be a positive integer or 'ends'") from None


def solve(
    h: Hamiltonian,
    q0: Any,
    p0: Any,
    span: tuple[Any, Any],
    *,
    method: Method = Equip(stages=8),
    step: Any = None,
    tolerance: Optional[float] = None,
    t_eval: Any = None,
    dense_output: bool = False,
    events: Union[None, Event, Sequence[Event]] = None,
    invariants: Optional[Mapping[str, Function]] = None,
    preserve: Optional[Mapping[str, Function]] = None,
    record: Union[int, Literal["ends"]] = 1,
    measure_energy: bool = True,
    chaos: bool = False,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    max_steps: Optional[int] = None,
    rtol: Any = None,
    atol: Any = None,
    precision: Literal["f64", "dd"] = "f64",
    checkpoint: Union[None, str, PathLike[str]] = None,
    checkpoint_every: float = 60.0,
    progress: bool = False,
) -> Solution:
    """Integrates q' = ∂H/∂p, p' = -∂H/∂q over an interval of time. Times, positions and momenta are in
    the units in which H is written.

    Other Python threads continue to run. Ctrl-C ends the run within a tenth of a second or one step.

    Parameters
    ----------
    h
        The energy: H(q, p), or H(t, q, p) by `Hamiltonian.with_time`.
    q0, p0
        Positions and momenta at the start, each of the shape `h.shape`. In double-double also text,
        `Decimal`, `Fraction`, `np.longdouble` or `equip.DoubleDouble`.
    span
        Start and end of the interval; the run goes backward in time if the end lies before the start.
    method
        Any of the six methods; `equip.AveragedVectorField`, `equip.Trapezoidal` and `equip.Hbvm` of degree 1
        need `step`.
    step, tolerance
        Either a fixed step size, or a tolerance: the error of a step relative to the change of the state over
        the step. The default is the tolerance 1e-12, in double-double 1e-24.
    t_eval
        Times within the span, (k,), sorted in the direction of the run, at which states are stored; `t` then
        has these times. The steps do not change.
    dense_output
        Whether `Solution.sol` gives the state at any time.
    events
        Smooth functions g(t, q, p) whose roots are located. Each is recorded like H, by the same rules.
        Attributes as in `scipy.integrate.solve_ivp`: `terminal = True` ends the run at the first root (a
        number of roots is not accepted); `direction` 1 or -1 selects rising or falling roots. An attribute
        `then`, a function of (t, q, p) that returns (q, p), changes the state at every root, as in a bounce
        or a kick. The run then continues and conserves the value of H after the change. `then` is called with
        numbers, in another thread. It cannot be combined with `precision="dd"`, `chaos=True` or `checkpoint`.
        `Solution.y_events` has the states before the changes. Simultaneous events
        all change the state, in the order of this list. A root at the start is not reported.
    invariants
        Quantities f(q, p) to monitor, by name; f(t, q, p) if H depends on time. The certificate has their
        errors.
    preserve
        Further quantities f(q, p) by name, conserved like the energy. Quadratic ones are conserved anyway and
        only measured. The others must be independent of each other, of H and of the quadratic ones.
        `Solution.message` names those that were not conserved.
    record
        k: the solution has every k-th step; "ends": only the first and the last state.
    measure_energy
        Whether methods without free α evaluate the energy.
    chaos
        Whether the certificate has the largest Lyapunov exponent and MEGNO.
    first_step, min_step, max_step, max_steps
        Of variable steps: step sizes, and the largest number of steps.
    rtol, atol
        Of variable steps: `rtol` replaces `tolerance`, component by component; `atol` is an absolute error
        that is always allowed. A number or an array of the shape of q for positions and momenta alike, or a
        tuple of two such, for positions and for momenta.
    precision
        "f64", or "dd" for double-double, 31 digits.
    checkpoint
        A file with the state of the run, written from time to time, at the end of the interval, and when
        Ctrl-C or SIGTERM ends the run, after the current step (a second Ctrl-C does not wait). If the file
        exists, the run resumes from it, with the same initial state and options, to the end of this interval,
        and has the same bits as an uninterrupted run. The solution begins at the checkpoint; the certificate
        covers the entire run. Only one process at a time may use the file.
    checkpoint_every
        Seconds between checkpoints.
    progress
        Whether to show a progress bar; needs the package tqdm.

    Returns
    -------
    Solution
        If a step fails, `success` is False, `message` says what to change, and the solution has the states
        before that step.

    Raises
    ------
    ValueError
        For invalid input.
    FileFormatError
        A ValueError: for a damaged checkpoint, or another file.
    FileInUseError
        For a checkpoint that another process is writing.
    TypeError
        For events and quantities that cannot be recorded.

    Examples
    --------
    >>> import numpy as np
    >>> kepler = Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), shape=2)
    >>> sol = solve(kepler, [0.4, 0.0], [0.0, 2.0], (0, 100))
    >>> sol.success, bool(abs(sol.energy_error).max() < 1e-14)
    (True, True)
    """
    given = options(
        h,
        method,
        step,
        tolerance,
        precision,
        first_step=first_step,
        min_step=min_step,
        max_step=max_step,
        max_steps=max_steps,
        rtol=rtol,
        atol=atol,
        invariants=invariants,
        preserve=preserve,
        measure_energy=measure_energy,
        chaos=chaos,
    )
    every = _record(record)
    at_times = outputs(h, given, t_eval, dense_output, events, precision)
    given["record"] = 0 if at_times else every
    changes = changes_of(given["events"])
    if changes and checkpoint is not None:
        raise ValueError(
            "events that change the state are not available with checkpoint: omit it, or end the run by "
            "a terminal event and start again"
        )
    start, end = interval_of(span)
    interval = (state(q0, h.shape, "q0"), state(p0, h.shape, "p0"), start, end)
    path = None if checkpoint is None else fspath(checkpoint)
    seconds = number(checkpoint_every, "checkpoint_every")
    if not seconds > 0:
        raise ValueError(
            f"checkpoint_every is {seconds}; it must be positive: seconds between two checkpoints"
        )
    kept = None if path is None else (path, seconds)
    with nullcontext() if kept is None else terminating(), _bar(start[0], end[0], progress) as show:
        found = _native.solve(h._recorded, interval, given, precision, show, kept)
        if show is not None:
            show(found["certificate"]["end"])
    raise_of(changes)
    _check_end(found, path, start[0], end[0])
    return solution(h, found, given, at_times)


def outputs(
    h: Hamiltonian, given: dict[str, Any], t_eval: Any, dense_output: bool, events: Any, precision: str
) -> bool:
    """Adds the outputs of a run to its options; whether there are times for its states."""
    if t_eval is not None:
        high, low = pairs(t_eval, "t_eval")
        if high.ndim > 1:
            raise ValueError(f"t_eval has shape {high.shape}; it must have one axis: ascending times")
        given["t_eval"] = (high.ravel().tolist(), low.ravel().tolist())
    given["dense"] = truth(dense_output, "dense_output")
    given["events"] = events_of(events, h.shape)
    if changes_of(given["events"]) and (precision == "dd" or given["chaos"]):
        raise ValueError(
            "events that change the state are not available with precision='dd' or chaos=True: leave these "
            "out, or end the run by a terminal event and start again"
        )
    return t_eval is not None


@contextmanager
def _bar(start: float, end: float, progress: bool) -> Iterator[Optional[Callable[[float], None]]]:
    """Shows the time reached, if that is wanted."""
    if not progress:
        yield None
        return
    from tqdm.auto import tqdm

    form = "{l_bar}{bar}| t = {n:.6g} [{elapsed}<{remaining}]"
    with tqdm(total=end - start, unit="time", bar_format=form) as bar:
        yield lambda time: bar.update(time - start - bar.n)


def _check_end(found: dict[str, Any], path: Optional[str], start: float, end: float) -> None:
    """Refuses a checkpoint beyond the end of the interval; a last step may end a rounding beyond it."""
    reached = found["certificate"]["end"]
    beyond = (reached - end) * (1 if end >= start else -1)
    if path is not None and beyond > 1e-9 * abs(end - start):
        raise ValueError(
            f"the checkpoint {path} is at t = {reached:g}, beyond the end {end:g} of span: give a later end, "
            "or another checkpoint"
        )


def _not_kept(h: Hamiltonian, found: dict[str, Any], given: dict[str, Any]) -> str:
    """Which quantities of `preserve` were not conserved, in words; empty if all were."""
    y = found["y"][0].reshape(-1, 2, h.degrees_of_freedom)
    t = found["t"][0]
    texts = []
    for (name, recorded), defect in zip(given["preserve"], found["certificate"]["invariants"]):
        off = defect[2]
        quantity = of_recording(recorded, h.shape)
        q, p = (y[:, part].reshape(-1, *h.shape) for part in (0, 1))
        slopes = quantity.gradient(q[[0, -1]], p[[0, -1]], t[[0, -1]] if quantity.has_time else None)
        terms = np.abs(np.stack(slopes, axis=1).reshape(2, -1) * y[[0, -1]].reshape(2, -1))
        size = max(abs(defect[1]), float(terms.sum(axis=1).max()))
        if not off <= _NOT_CONSERVED * size:
            texts.append(f"{name} was not conserved: its error is up to {off:.2g}")
    return "; ".join(texts)


def solution(h: Hamiltonian, found: dict[str, Any], given: dict[str, Any], at_times: bool) -> Solution:
    """What the native part found, as a solution."""
    n = 2 * h.degrees_of_freedom
    prefix = "output_" if at_times else ""
    (t, t_low), (y, y_low) = found[prefix + "t"], found[prefix + "y"]
    which: Floats = found["event"]
    labels, codes = found["outcome"]
    roots = found["event_y"].reshape(-1, n)
    events = range(len(given["events"]))
    fault = found["fault"]
    message = fault or (
        "a terminal event ended the run" if found["stopped"] else "the end of the interval was reached"
    )
    if not fault and (not_kept := _not_kept(h, found, given)):
        message = f"{message}, but {not_kept}"
    return Solution(
        shape=h.shape,
        hamiltonian=h,
        t=t,
        y=y.reshape(-1, n),
        energy_error=found.get(prefix + "energy_error", np.empty(0)),
        outcome=np.array(labels)[codes[:0] if at_times else codes],
        t_events=tuple(found["event_t"][which == event] for event in events),
        y_events=tuple(roots[which == event] for event in events),
        success=fault is None,
        status=-1 if fault else int(found["stopped"]),
        message=message,
        certificate=Certificate._of(found["certificate"]),
        t_low=t_low,
        y_low=y_low.reshape(-1, n),
        _curve=found["curve"],
    )
