"""`Solution`: the result of a run."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from . import _native
from ._certificate import Certificate
from ._files import Path, read, write
from ._hamiltonian import Hamiltonian
from ._numbers import Floats, Shape
from ._show import table_of, text_of

#: Of files.
FORMAT = "equip solution 4"
#: Times of dense output that are computed between two looks at signals.
_TIMES = 4096
#: Points of a picture, in all and between two states.
_POINTS, _MOST_POINTS = 8192, 32
#: What `Solution.save` writes as it is.
_STATES = ("t", "y", "t_low", "y_low")
_ARRAYS = (*_STATES, "energy_error", "outcome")


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """The states of a run and its certificate.

    Times, positions and momenta are in the units in which H is written. Pickles and files contain everything,
    including the dense output. A solution is equal only to itself.

    Attributes
    ----------
    t
        Times, (n,).
    y
        States, (n, 2m): the components of q.ravel() and then those of p.ravel().
    energy_error
        H - H_ref, H_ref being H at the start or after the last change of the state, (n,); empty if not
        measured.
    outcome
        Outcome of the step that ends at each state, (n,); empty with `t_eval`.
    t_events, y_events
        Times (k,) and states (k, 2m) of the roots of each event, in the order of the events.
    success
        Whether the end, or a terminal event, was reached.
    status
        0 if the end was reached, 1 if a terminal event ended the run, -1 if a step failed.
    message
        The status as text; if a step failed, the reason and what to change.
    certificate
        What was conserved, measured.
    hamiltonian
        The energy, without its Python function. To continue a run, call
        `equip.solve(sol.hamiltonian, sol.q[-1], sol.p[-1], (sol.t[-1], end))`, also after `equip.load`.
    """

    shape: Shape
    t: Floats
    y: Floats
    energy_error: Floats
    outcome: np.ndarray[Any, Any]
    t_events: tuple[Floats, ...]
    y_events: tuple[Floats, ...]
    success: bool
    status: int
    message: str
    certificate: Certificate
    hamiltonian: Hamiltonian
    #: The low words of `t` and `y` in double-double; zero in doubles.
    t_low: Floats = field(repr=False)
    y_low: Floats = field(repr=False)
    _curve: Optional[_native.Curve] = field(default=None, repr=False)

    def _part(self, y: Floats, part: int) -> Floats:
        """Positions (0) or momenta (1) of states."""
        m = self.y.shape[-1] // 2
        return y[..., part * m : (part + 1) * m].reshape(*y.shape[:-1], *self.shape)

    @property
    def q(self) -> Floats:
        """Positions, (n, *shape)."""
        return self._part(self.y, 0)

    @property
    def p(self) -> Floats:
        """Momenta, (n, *shape)."""
        return self._part(self.y, 1)

    @property
    def nfev(self) -> int:
        """Evaluations of the gradient of H; all counts are in `certificate.counts`."""
        return self.certificate.counts.gradients

    @property
    def njev(self) -> int:
        """Evaluations of ∇²H."""
        return self.certificate.counts.hessians

    def _lines(self) -> list[tuple[str, str]]:
        """What printing shows."""
        certificate = self.certificate
        counts, energy = certificate.counts, certificate.energy
        kept = "not measured" if energy is None else f"H = {energy.start:.6g}, largest error {energy.max:.2g}"
        roots = ", ".join(str(len(t)) for t in self.t_events)
        return [
            ("run", f"t = {certificate.start:.6g} to {certificate.end:.6g}, q of shape {self.shape}"),
            ("method", f"{certificate.method}, {counts.steps} steps, {counts.gradients} gradients"),
            ("energy", kept),
            ("states", f"{len(self.t)}" + (f"; roots of events: {roots}" if roots else "")),
            ("message", self.message),
        ]

    def __repr__(self) -> str:
        return text_of("Solution", self._lines())

    def _repr_html_(self) -> str:
        return table_of(self._lines())

    @property
    def q_low(self) -> Floats:
        """The low words of `q` in double-double; zero in doubles."""
        return self._part(self.y_low, 0)

    @property
    def p_low(self) -> Floats:
        """The low words of `p` in double-double; zero in doubles."""
        return self._part(self.y_low, 1)

    @property
    def q_events(self) -> tuple[Floats, ...]:
        """Positions at the roots of each event, (k, *shape)."""
        return tuple(self._part(y, 0) for y in self.y_events)

    @property
    def p_events(self) -> tuple[Floats, ...]:
        """Momenta at the roots of each event, (k, *shape)."""
        return tuple(self._part(y, 1) for y in self.y_events)

    def q_text(self, digits: int = 31) -> np.ndarray[Any, Any]:
        """Positions as decimals with the given number of significant digits, (n, *shape)."""
        return _text(self.q, self.q_low, digits)

    def p_text(self, digits: int = 31) -> np.ndarray[Any, Any]:
        """Momenta as decimals with the given number of significant digits, (n, *shape)."""
        return _text(self.p, self.p_low, digits)

    def sol(self, t: Any) -> tuple[Floats, Floats]:
        """(q, p) at any times t of the run, each with the axes of `t` followed by those of `shape`. Needs
        `dense_output=True`.

        Raises
        ------
        ValueError
            Without dense output, and for a time outside the run.
        """
        if self._curve is None:
            raise ValueError("the run has no dense output: solve with dense_output=True")
        times = np.asarray(t, dtype=float)
        states = self._at(times.ravel()).reshape(*times.shape, self.y.shape[-1])
        return self._part(states, 0), self._part(states, 1)

    def _at(self, times: Floats) -> Floats:
        """States of the dense output at these times, (k,)."""
        assert self._curve is not None
        parts = [self._curve.at(times[i : i + _TIMES]) for i in range(0, max(len(times), 1), _TIMES)]
        return np.concatenate(parts).reshape(len(times), self.y.shape[-1])

    def _path(self) -> tuple[Floats, Floats]:
        """Times and states from which a curve is drawn: those of the run, and others between them. These are
        of the dense output, or computed again from the state before."""
        n = len(self.t)
        points = _POINTS // max(n, 1)
        if n < 2 or points < 2:
            return self.t, self.y
        points = min(points, _MOST_POINTS)
        t = self.t[:-1, None] + np.diff(self.t)[:, None] * (np.arange(points) / points)
        times = np.append(t.ravel(), self.t[-1])
        if self._curve is not None:
            first, last = sorted(self._curve.interval())
            return times, self._at(np.clip(times, first, last))
        recorded, y = self.hamiltonian._recorded, self.y.ravel().tolist()
        found = _native.between(recorded, self.t.tolist(), y, points)
        return times, np.concatenate([found, self.y[-1]]).reshape(len(times), -1)

    def plot(self, ax: Any = None) -> Any:
        """Draws the motion and returns the axes of matplotlib: p against q with one degree of freedom;
        paths in the plane of the first two coordinates if the last axis of q has two or more; otherwise
        every component of q against time.

        Between the states of the run, the curves are those of the dense output, or of steps repeated from
        each state. With more than some thousand states, the curves are straight lines."""
        ax = _axes(ax)
        t, y = self._path()
        q, p = self._part(y, 0), self._part(y, 1)
        if self.shape == (1,):
            ax.plot(q[:, 0], p[:, 0])
            ax.set(xlabel="q", ylabel="p")
        elif self.shape[-1] in (2, 3):
            bodies = q.reshape(len(q), math.prod(self.shape[:-1]), self.shape[-1])
            for body in range(bodies.shape[1]):
                ax.plot(bodies[:, body, 0], bodies[:, body, 1])
            ax.set(xlabel="x", ylabel="y", aspect="equal")
        else:
            ax.plot(t, q.reshape(len(q), math.prod(self.shape)))
            ax.set(xlabel="t", ylabel="q")
        return ax

    def plot_energy(self, ax: Any = None) -> Any:
        """Draws |H - H_ref| against time, on a logarithmic axis. Returns the axes of matplotlib.

        Raises
        ------
        ValueError
            If the energy was not measured.
        """
        if len(self.energy_error) != len(self.t):
            raise ValueError(
                "the energy was not measured at these times: solve with measure_energy=True, and with "
                "H(t, q, p) without t_eval"
            )
        ax = _axes(ax)
        defect = np.abs(self.energy_error)
        ax.semilogy(self.t[: len(defect)], np.where(defect > 0, defect, np.nan), ".", markersize=2)
        ax.set(xlabel="t", ylabel="|H − H_ref|")
        return ax

    def section(self, x: int, y: int, *, event: int = 0, ax: Any = None) -> Any:
        """Draws a Poincaré section: component y against component x at the roots of an event, one point for
        each root. Returns the axes of matplotlib.

        Parameters
        ----------
        x, y
            Components of (q, p), flat: 0 to m - 1 belong to q, m to 2m - 1 to p.
        event
            Number of the event in the order in which `events` were given.
        ax
            Axes to draw into, for instance those of another solution; the default is new axes.

        Raises
        ------
        TypeError
            If x, y or event is not an integer.
        ValueError
            If there is no such component or event.
        """
        n = self.y.shape[1]
        for name, number in (("x", x), ("y", y), ("event", event)):
            if not hasattr(number, "__index__"):
                raise TypeError(
                    f"{name} is {number!r}; give a number: components of (q, p) are 0 to {n // 2 - 1} for q "
                    f"and {n // 2} to {n - 1} for p, and the run has {len(self.y_events)} events"
                )
        if not 0 <= event < len(self.y_events):
            raise ValueError(
                f"event is {event}, but the run has {len(self.y_events)} events: give `events` to solve"
            )
        if not (0 <= x < n and 0 <= y < n):
            raise ValueError(f"x is {x} and y is {y}; components of (q, p) are 0 to {n - 1}")
        ax = _axes(ax)
        states = self.y_events[event]
        ax.plot(states[:, x], states[:, y], ".", markersize=2)
        half = n // 2
        names = [f"{'q' if i < half else 'p'}[{i % half}]" for i in (x, y)]
        ax.set(xlabel=names[0], ylabel=names[1])
        return ax

    def to_dataframe(self) -> Any:
        """A pandas DataFrame with the columns t, q[...], p[...] and energy_error; a row for each state."""
        import pandas

        names = [",".join(map(str, index)) for index in np.ndindex(*self.shape)]
        columns = {"t": self.t}
        m = len(names)
        for part, x in enumerate("qp"):
            columns |= {f"{x}[{name}]": self.y[:, part * m + j] for j, name in enumerate(names)}
        if len(self.energy_error):
            columns["energy_error"] = self.energy_error
        return pandas.DataFrame(columns)

    def to_xarray(self) -> Any:
        """An xarray Dataset with q, p and energy_error over the coordinate t; axes of q are axis_0,
        axis_1, ..."""
        import xarray

        axes = ("t", *(f"axis_{i}" for i in range(len(self.shape))))
        variables: dict[str, Any] = {"q": (axes, self.q), "p": (axes, self.p)}
        if len(self.energy_error):
            variables["energy_error"] = ("t", self.energy_error)
        attributes = {"message": self.message, "method": self.certificate.method}
        return xarray.Dataset(variables, coords={"t": self.t}, attrs=attributes)

    def save(self, path: Path) -> None:
        """Writes the solution, with the recorded formula of H, to a NumPy archive, or to HDF5 if the path
        ends in `.h5` or `.hdf5` (needs the package h5py). `equip.load` reads the file. An earlier file stays
        until the new one is complete."""
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _ARRAYS}
        arrays |= {f"t_event_{i}": t for i, t in enumerate(self.t_events)}
        arrays |= {f"y_event_{i}": y for i, y in enumerate(self.y_events)}
        arrays["hamiltonian"] = np.frombuffer(self.hamiltonian.to_bytes(), dtype=np.uint8)
        if self._curve is not None:
            arrays["curve"], arrays["curve_low"] = self._curve.numbers()
        words = {
            "success": self.success,
            "status": self.status,
            "message": self.message,
            "shape": self.shape,
            "certificate": self.certificate.to_dict(),
            "events": len(self.t_events),
        }
        axes: dict[str, tuple[str, ...]] = {name: ("t", "component") for name in _ARRAYS}
        axes |= {f"{x}_event_{i}": ("root", "component") for x in "ty" for i in range(len(self.t_events))}
        write(path, words, arrays, FORMAT, axes)


def load(path: Path) -> Solution:
    """The solution that `Solution.save` wrote to `path`.

    Raises
    ------
    FileFormatError
        A ValueError: if the file was not written by `Solution.save`, or is damaged.
    """
    stored = read(path, FORMAT)
    shape = tuple(stored.word("shape", list))
    if not shape or not all(type(n) is int and n > 0 for n in shape):
        raise stored.damaged(f"the shape is {shape}")
    m = math.prod(shape)
    n = len(stored.array("t", (None,)))
    events = max(stored.word("events", int), 0)
    arrays = {name: stored.array(name, (n,) if name[0] == "t" else (n, 2 * m)) for name in _STATES}
    # None of both with `t_eval`, and no energies if they were not measured.
    for name, kind in (("energy_error", "f"), ("outcome", "U")):
        found: Any = stored.arrays.get(name)
        length = 0 if np.shape(found) == (0,) else n
        arrays[name] = stored.array(name, (length,), kind)
    times = [stored.array(f"t_event_{i}", (None,)) for i in range(events)]
    roots = [stored.array(f"y_event_{i}", (len(t), 2 * m)) for i, t in enumerate(times)]
    recording = stored.array("hamiltonian", (None,), "u")
    try:
        hamiltonian = Hamiltonian.from_bytes(recording.tobytes(), shape)
        certificate = Certificate._from_dict(stored.word("certificate", dict))
        curve = None
        if "curve" in stored.arrays:
            numbers = (stored.array(name, (None,)) for name in ("curve", "curve_low"))
            curve = _native.Curve(2 * m, *map(np.ascontiguousarray, numbers))
    except ValueError as error:
        raise stored.damaged(str(error)) from error
    return Solution(
        **arrays,
        shape=shape,
        t_events=tuple(times),
        y_events=tuple(roots),
        success=stored.word("success", bool),
        status=stored.word("status", int),
        message=stored.word("message", str),
        certificate=certificate,
        hamiltonian=hamiltonian,
        _curve=curve,
    )


def _text(high: Floats, low: Floats, digits: int) -> np.ndarray[Any, Any]:
    pairs = zip(high.ravel().tolist(), low.ravel().tolist())
    texts = [_native.decimal_text(hi, lo, digits) for hi, lo in pairs]
    return np.array(texts, dtype=str).reshape(high.shape)


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.subplots()[1]
