"""`Ensemble`: the end states of many runs, as rows of arrays, and their files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from .._files import Path, read, write
from .._numbers import Floats, Shape
from .._show import table_of, text_of
from .._solution import Solution

#: Of files.
FORMAT = "equip ensemble 1"
#: Names of arrays with a row for each run.
ARRAYS = ("t", "q", "p", "energy_error", "energy_conserved", "steps", "lyapunov", "megno")
#: Of a run that a file has not.
NOT_FINISHED = "this run is not finished; call ensemble again with the same checkpoint, or with resume="


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble:
    """The end states of many runs: a row for each initial condition, in order; NaN for failed runs."""

    #: Times reached, (N,).
    t: Floats
    #: Positions and momenta at the end, (N, *shape).
    q: Floats
    p: Floats
    #: Largest |H - H_ref|, H_ref being H at the start or after the last change, of each run, (N,).
    energy_error: Floats
    #: Whether every step of the run conserved the energy to round-off, (N,).
    energy_conserved: NDArray[np.bool_]
    #: Number of steps of each run, (N,).
    steps: NDArray[np.int64]
    #: Largest Lyapunov exponent, per unit of time, and MEGNO, (N,) each; NaN without `chaos=True`.
    lyapunov: Floats
    megno: Floats
    #: Error messages, by the number of the run.
    errors: dict[int, str]
    #: Numbers of the runs whose workers died, (k,): `ensemble(..., resume=this)` repeats them.
    lost: NDArray[np.int64]
    #: The value of `output` for each run; None for failed runs. Empty without `output`.
    outputs: tuple[Any, ...] = ()
    #: Digest of H, initial conditions, span and options, compared by `resume`; empty if not known.
    digest: str = ""

    @property
    def outcome(self) -> NDArray[np.str_]:
        """The outcome of each run, (N,): "conserved" if the energy was conserved on every step, else
        "finished"; "failed"; or "lost" if its worker died."""
        ends = np.where(self.energy_conserved, "conserved", np.where(np.isnan(self.t), "failed", "finished"))
        ends[self.lost] = "lost"
        return ends

    @property
    def success(self) -> bool:
        """Whether no run failed."""
        return not self.errors

    def _lines(self) -> list[tuple[str, str]]:
        """What printing shows."""
        names, counts = np.unique(self.outcome, return_counts=True)
        ends = ", ".join(f"{count} {name}" for name, count in zip(names, counts))
        made = self.energy_error[np.isfinite(self.energy_error)]
        first = next(iter(self.errors.items()), None)
        return [
            ("runs", f"{len(self.t)}: {ends or 'none'}"),
            ("state", f"q of shape {self.q.shape[1:]}"),
            ("steps", f"{self.steps.sum()}"),
            ("energy", f"largest error {made.max():.2g}" if made.size else "not measured"),
            ("errors", "none" if first is None else f"{len(self.errors)}; run {first[0]}: {first[1]:.80}"),
        ]

    def __repr__(self) -> str:
        return text_of("Ensemble", self._lines())

    def _repr_html_(self) -> str:
        return table_of(self._lines())

    def save(self, path: Path) -> None:
        """Writes all rows and error messages to a NumPy archive, or to HDF5 if the path ends in `.h5` or
        `.hdf5` (needs the package h5py). `Ensemble.load` reads the file. An earlier file stays until the new
        one is complete.

        Raises
        ------
        ValueError
            If it has `outputs`, which may have any type.
        """
        if self.outputs:
            raise ValueError(
                "outputs cannot be saved: write them yourself, and save the rest by "
                "dataclasses.replace(ends, outputs=()).save(path)"
            )
        arrays = {name: getattr(self, name) for name in ARRAYS}
        lost = set(self.lost.tolist())
        errors = {i: text for i, text in self.errors.items() if i not in lost}
        write_rows(path, arrays, self.lost, errors, self.digest)

    @staticmethod
    def load(path: Path) -> Ensemble:
        """The ensemble that `save` or `equip.ensemble(..., checkpoint=path)` wrote to `path`. Unfinished runs
        are `lost`; `equip.ensemble(..., resume=this)` repeats them.

        Raises
        ------
        ValueError
            If neither of these wrote the file.
        """
        return read_rows(path)


def write_rows(
    path: Path, arrays: dict[str, Any], lost: NDArray[np.int64], errors: dict[int, str], of: str
) -> None:
    """Writes rows, what went wrong with those that are not lost, and the digest of what they are rows of."""
    words = {"errors": {str(i): text for i, text in errors.items()}, "of": of}
    axes = {name: ("run", *(f"axis_{i}" for i in range(arrays["q"].ndim - 1))) for name in ARRAYS}
    write(path, words, {**arrays, "lost": lost}, FORMAT, axes)


def read_rows(path: Path) -> Ensemble:
    """An ensemble in a file."""
    stored = read(path, FORMAT)
    q = stored.arrays.get("q")
    shape = q.shape if isinstance(q, np.ndarray) and q.ndim > 1 else (None, None)
    kinds = {"energy_conserved": "b", "steps": "iu"}
    arrays = {
        name: stored.array(name, shape if name in "qp" else shape[:1], kinds.get(name, "f"))
        for name in ARRAYS
    }
    lost = stored.array("lost", (None,), "iu")
    numbers: dict[str, Any] = stored.word("errors", dict)
    n = len(arrays["q"])
    if not all(i.isdecimal() and int(i) < n and isinstance(text, str) for i, text in numbers.items()):
        raise stored.damaged("errors are not texts by the numbers of runs")
    if lost.size and not (0 <= lost.min() and lost.max() < n):
        raise stored.damaged("lost runs have other numbers than the rows")
    errors = {int(i): text for i, text in numbers.items()}
    errors |= {i: NOT_FINISHED for i in lost.tolist()}
    return Ensemble(**arrays, lost=lost.astype(np.int64), errors=errors, digest=stored.word("of", str))


def row_of(sol: Solution) -> Ensemble:
    """The end of a run as the row of an ensemble."""
    certificate = sol.certificate
    energy, chaos = certificate.energy, (certificate.lyapunov, certificate.megno)
    lyapunov, megno = (np.array([np.nan if x is None else x]) for x in chaos)
    return Ensemble(
        t=sol.t[-1:],
        q=sol.q[-1:],
        p=sol.p[-1:],
        energy_error=np.array([np.nan if energy is None else energy.max]),
        energy_conserved=np.array([certificate.energy_conserved_on_every_step]),
        steps=np.array([certificate.counts.steps]),
        lyapunov=lyapunov,
        megno=megno,
        errors={},
        lost=np.empty(0, dtype=np.int64),
    )


def rows_of(found: dict[str, Any], shape: Shape) -> Ensemble:
    """Rows from the arrays of the native part."""
    ends = found["y"].reshape(-1, 2, *shape)
    return Ensemble(
        t=found["t"],
        q=ends[:, 0],
        p=ends[:, 1],
        energy_error=found["energy_error"],
        energy_conserved=found["energy_conserved"],
        steps=found["steps"],
        lyapunov=found["lyapunov"],
        megno=found["megno"],
        errors=found["errors"],
        lost=np.empty(0, dtype=np.int64),
    )


def missing(n: int, shape: Shape, message: str) -> Ensemble:
    """Rows that were not made."""
    states = np.full((2, n, *shape), np.nan)
    none = np.full(n, np.nan)
    return Ensemble(
        t=none,
        q=states[0],
        p=states[1],
        energy_error=none,
        energy_conserved=np.zeros(n, dtype=bool),
        steps=np.zeros(n, dtype=np.int64),
        lyapunov=none,
        megno=none,
        errors={i: message for i in range(n)},
        lost=np.empty(0, dtype=np.int64),
    )


def joined(parts: Sequence[Ensemble], shape: Shape) -> Ensemble:
    """Rows of runs that follow each other."""
    parts = parts or [missing(0, shape, "")]
    starts = np.cumsum([0] + [len(part.t) for part in parts])
    errors = {int(at) + i: text for at, part in zip(starts, parts) for i, text in part.errors.items()}
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts]) for name in ARRAYS
    }
    outputs = tuple(output for part in parts for output in part.outputs)
    return Ensemble(**arrays, errors=errors, lost=np.empty(0, dtype=np.int64), outputs=outputs)


class Rows:
    """The rows of N runs while they are made; those of `before` that are not lost are there."""

    def __init__(self, n: int, shape: Shape, before: Optional[Ensemble], with_outputs: bool) -> None:
        found = missing(n, shape, "") if before is None else before
        self.arrays: dict[str, Any] = {name: getattr(found, name).copy() for name in ARRAYS}
        self.errors = {} if before is None else dict(before.errors)
        self._is_lost = np.full(n, before is None)
        if before is not None:
            self._is_lost[before.lost] = True
        self._outputs = list(found.outputs) or [None] * (n if with_outputs else 0)

    @property
    def lost(self) -> NDArray[np.int64]:
        """Numbers of the runs that are not made."""
        return np.flatnonzero(self._is_lost)

    def take(self, numbers: NDArray[np.int64], made: Ensemble, is_lost: bool) -> None:
        """The rows `made` of the runs with these numbers, or of a worker that died."""
        for name, array in self.arrays.items():
            array[numbers] = getattr(made, name)
        self._is_lost[numbers] = is_lost
        for i in self.errors.keys() & set(numbers.tolist()):
            del self.errors[i]
        self.errors |= {int(numbers[place]): text for place, text in made.errors.items()}
        for i, output in zip(numbers.tolist(), made.outputs):
            self._outputs[i] = output

    def ensemble(self, digest: str) -> Ensemble:
        """All of them."""
        errors = dict(sorted(self.errors.items()))
        outputs = tuple(self._outputs)
        return Ensemble(**self.arrays, errors=errors, lost=self.lost, outputs=outputs, digest=digest)
