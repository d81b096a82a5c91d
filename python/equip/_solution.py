"""`Solution`: what a run leaves."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from . import _native
from ._certificate import Certificate
from ._files import Path, read, write
from ._hamiltonian import Hamiltonian
from ._numbers import Floats, Shape

#: Of files.
FORMAT = "equip solution 4"
#: What `Solution.save` writes as it is.
_ARRAYS = ("t", "y", "energy_defect", "outcome", "t_low", "y_low")


@dataclass(frozen=True, eq=False)
class Solution:
    """The states of a run, and what it kept. Times and states are in the units of H.

    Pickling takes all but the dense output; copies have it. Two solutions are equal if they are the same one.

    Attributes
    ----------
    t
        Times, (n,).
    y
        States, (n, 2m): the components of q.ravel() and then those of p.ravel().
    energy_defect
        H - H(start), (n,); empty if it was not measured.
    outcome
        How the step before each state ended, (n,); empty with `t_eval`.
    t_events, y_events
        Times (k,) and states (k, 2m) of the roots of each event, in the order of the events.
    success
        Whether the end, or a terminal event, was reached.
    message
        In words; if a step could not be made, why, and what to change.
    certificate
        What was kept, measured.
    hamiltonian
        The energy, without the function it was recorded from: a run goes on with
        `equip.solve(sol.hamiltonian, sol.q[-1], sol.p[-1], (sol.t[-1], end))`, also after `equip.load`.
    """

    shape: Shape
    t: Floats
    y: Floats
    energy_defect: Floats
    outcome: np.ndarray[Any, Any]
    t_events: tuple[Floats, ...]
    y_events: tuple[Floats, ...]
    success: bool
    message: str
    certificate: Certificate
    hamiltonian: Hamiltonian
    #: What double-double has below `t` and `y`; zero in a run in doubles.
    t_low: Floats = field(repr=False)
    y_low: Floats = field(repr=False)
    _curve: Optional[_native.Curve] = field(default=None, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_curve": None}

    def _of_fields(self, fields: dict[str, Any]) -> Solution:
        made = object.__new__(Solution)
        made.__dict__.update(fields)
        return made

    def __copy__(self) -> Solution:
        return self._of_fields(self.__dict__)

    def __deepcopy__(self, memo: dict[int, Any]) -> Solution:
        # The curve never changes.
        fields = {name: x if name == "_curve" else deepcopy(x, memo) for name, x in self.__dict__.items()}
        return self._of_fields(fields)

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
    def q_low(self) -> Floats:
        """What double-double has below `q`."""
        return self._part(self.y_low, 0)

    @property
    def p_low(self) -> Floats:
        """What double-double has below `p`."""
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
        """Positions as decimals with so many significant digits, (n, *shape)."""
        return _text(self.q, self.q_low, digits)

    def p_text(self, digits: int = 31) -> np.ndarray[Any, Any]:
        """Momenta as decimals with so many significant digits, (n, *shape)."""
        return _text(self.p, self.p_low, digits)

    def sol(self, t: Any) -> tuple[Floats, Floats]:
        """(q, p) at any time of the run, each of the shape of `t` and then `shape`. Asks for
        `dense_output=True`.

        Raises
        ------
        ValueError
            Without dense output, and for a time outside the run.
        """
        if self._curve is None:
            raise ValueError("the run has no dense output: solve with dense_output=True")
        times = np.asarray(t, dtype=float)
        states = self._curve.at(times.ravel()).reshape(*times.shape, self.y.shape[-1])
        return self._part(states, 0), self._part(states, 1)

    def plot(self, ax: Any = None) -> Any:
        """Draws the motion: p against q with one degree of freedom, paths in the plane of the first two
        coordinates where the last axis of q has two or more, else every q against time. Returns the axes of
        matplotlib."""
        ax = _axes(ax)
        q = self.q
        if self.shape == (1,):
            ax.plot(q[:, 0], self.p[:, 0])
            ax.set(xlabel="q", ylabel="p")
        elif self.shape[-1] in (2, 3):
            bodies = q.reshape(len(q), math.prod(self.shape[:-1]), self.shape[-1])
            for body in range(bodies.shape[1]):
                ax.plot(bodies[:, body, 0], bodies[:, body, 1])
            ax.set(xlabel="x", ylabel="y", aspect="equal")
        else:
            ax.plot(self.t, q.reshape(len(q), math.prod(self.shape)))
            ax.set(xlabel="t", ylabel="q")
        return ax

    def plot_energy(self, ax: Any = None) -> Any:
        """Draws |H - H(start)| against time, on a logarithmic axis. Returns the axes of matplotlib.

        Raises
        ------
        ValueError
            If it was not measured.
        """
        if len(self.energy_defect) != len(self.t):
            raise ValueError(
                "the energy was not measured at these times: solve with measure_energy=True, and with "
                "H(t, q, p) without t_eval"
            )
        ax = _axes(ax)
        defect = np.abs(self.energy_defect)
        ax.semilogy(self.t[: len(defect)], np.where(defect > 0, defect, np.nan), ".", markersize=2)
        ax.set(xlabel="t", ylabel="|H − H(0)|")
        return ax

    def section(self, x: int, y: int, *, event: int = 0, ax: Any = None) -> Any:
        """Draws a Poincaré section: component y against component x of the states at the roots of an event,
        a point each. Returns the axes of matplotlib.

        Parameters
        ----------
        x, y
            Numbers of components of (q, p), flat: 0 to m - 1 are those of q, m to 2m - 1 those of p.
        event
            Number of the event in the order in which `events` were given.
        ax
            Axes to draw into, for instance those of another solution; new ones if not given.
        """
        n = self.y.shape[1]
        if not 0 <= event < len(self.y_events):
            raise ValueError(
                f"event is {event}, but the run was asked for {len(self.y_events)} events: "
                "give `events` to solve"
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
        """A pandas DataFrame with the columns t, q[...], p[...] and energy_defect, a row for each state."""
        import pandas

        names = [",".join(map(str, index)) for index in np.ndindex(*self.shape)]
        columns = {"t": self.t}
        m = len(names)
        for part, x in enumerate("qp"):
            columns |= {f"{x}[{name}]": self.y[:, part * m + j] for j, name in enumerate(names)}
        if len(self.energy_defect):
            columns["energy_defect"] = self.energy_defect
        return pandas.DataFrame(columns)

    def to_xarray(self) -> Any:
        """An xarray Dataset with q, p and energy_defect over the coordinate t; axes of q are axis_0,
        axis_1, ..."""
        import xarray

        axes = ("t", *(f"axis_{i}" for i in range(len(self.shape))))
        variables: dict[str, Any] = {"q": (axes, self.q), "p": (axes, self.p)}
        if len(self.energy_defect):
            variables["energy_defect"] = ("t", self.energy_defect)
        attributes = {"message": self.message, "method": self.certificate.method}
        return xarray.Dataset(variables, coords={"t": self.t}, attrs=attributes)

    def save(self, path: Path) -> None:
        """Writes all but the dense output, and the recording of H, to a NumPy archive, or to HDF5 where the
        path ends in `.h5` or `.hdf5` (asks for the package h5py). `equip.load` reads it."""
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _ARRAYS}
        arrays |= {f"t_event_{i}": t for i, t in enumerate(self.t_events)}
        arrays |= {f"y_event_{i}": y for i, y in enumerate(self.y_events)}
        arrays["hamiltonian"] = np.frombuffer(self.hamiltonian.to_bytes(), dtype=np.uint8)
        words = {
            "success": self.success,
            "message": self.message,
            "shape": self.shape,
            "certificate": self.certificate.to_dict(),
            "events": len(self.t_events),
        }
        write(path, words, arrays, FORMAT)


def load(path: Path) -> Solution:
    """The solution that `Solution.save` wrote to `path`; it has no dense output.

    Raises
    ------
    ValueError
        If the file was not written by `Solution.save`, or its recording of H is damaged.
    """
    words, arrays = read(path, FORMAT)
    shape = tuple(words["shape"])
    return Solution(
        **{name: arrays[name] for name in _ARRAYS},
        shape=shape,
        t_events=tuple(arrays[f"t_event_{i}"] for i in range(words["events"])),
        y_events=tuple(arrays[f"y_event_{i}"] for i in range(words["events"])),
        success=words["success"],
        message=words["message"],
        certificate=Certificate._from_dict(words["certificate"]),
        hamiltonian=Hamiltonian.from_bytes(arrays["hamiltonian"].tobytes(), shape),
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
