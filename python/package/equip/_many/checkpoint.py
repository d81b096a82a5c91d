"""Finished rows of an ensemble in a file, written while others are made."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Optional

import numpy as np

from .. import _native
from .._events import Change
from .._files import Path
from .._hamiltonian import Hamiltonian
from .._numbers import Floats
from .chunks import Task
from .rows import Ensemble, Rows, read_rows, write_rows

#: The file is written at most for one part in so many of the time.
SHARE = 20


class Checkpoint:
    """The file of runs: all rows, with the numbers of those that are missing, and what they are runs of. No
    other process may write it until it is closed.

    Raises
    ------
    FileInUseError
        If another process writes it.
    """

    def __init__(self, path: Path, digest: str) -> None:
        self._path = os.fspath(path)
        self._claim = _native.Claim(self._path)
        self._of = digest
        self._rows: Optional[Rows] = None
        self._written = self._took = 0.0

    def close(self) -> None:
        """Lets other processes write the file."""
        self._claim.release()

    def read(self) -> Optional[Ensemble]:
        """The rows of an earlier call; None if there is no file."""
        if not os.path.exists(self._path):
            return None
        found = read_rows(self._path)
        if found.digest != self._of:
            raise ValueError(
                f"{self._path} has runs with another H, other initial conditions, another span or other "
                "options; give another checkpoint, or remove the file"
            )
        return found

    @contextmanager
    def of(self, rows: Rows) -> Iterator[None]:
        """Writes these rows at the end, also if an exception ends them early."""
        self._rows = rows
        # A path that cannot be written is known before the first run is made.
        self.write()
        try:
            yield
        finally:
            self.write()

    def write_if_due(self) -> None:
        """Writes the rows, unless writing takes too large a share of the time."""
        if time.monotonic() - self._written >= SHARE * self._took:
            self.write()

    def write(self) -> None:
        """The file has the one or the other state at any time, never a part of one."""
        if self._rows is None:
            return
        begun = time.monotonic()
        rows, lost = self._rows, self._rows.lost
        missing = set(lost.tolist())
        errors = {i: text for i, text in rows.errors.items() if i not in missing}
        write_rows(self._path, rows.arrays, lost, errors, self._of)
        self._written = time.monotonic()
        self._took = self._written - begun


def check_resume(before: Any, digest: str, shape: tuple[int, ...], end: float) -> None:
    """Refuses rows of other runs, as far as they know what they are rows of."""
    if not isinstance(before, Ensemble):
        raise TypeError(f"resume is {type(before).__name__}; it must be an Ensemble")
    if before.q.shape != shape:
        raise ValueError(
            f"resume has {len(before.q)} initial conditions, but q0 has {shape[0]}; give the same number"
        )
    made = before.t[np.isfinite(before.t)]
    if before.digest not in ("", digest) or (not before.digest and (made != end).any()):
        raise ValueError(
            "resume has runs with another H, other initial conditions, another span or other options; give "
            "those of the ensemble"
        )


def digest_of(task: Task, q: Floats, p: Floats) -> str:
    """Of all that the rows depend on; threads and chunks are not among it."""
    import hashlib

    text = repr(
        (task.times, task.precision, q.shape, sorted((name, _plain(x)) for name, x in task.given.items()))
    )
    # In double-double the starts have low words.
    high = (q[:, 0], p[:, 0]) if task.precision == "dd" else (q, p)
    parts = (_energy(task.h, *high), q.tobytes(), p.tobytes(), text.encode())
    return hashlib.sha256(b"".join(len(part).to_bytes(8, "little") + part for part in parts)).hexdigest()


def _energy(h: Hamiltonian, q: Floats, p: Floats) -> bytes:
    """The formula of H. The code of an external energy is not known: its value and gradient at the first and
    the last state."""
    if not h.is_external:
        return h.to_bytes()
    found = []
    for i in (0, -1)[: len(q)]:
        try:
            found += [np.asarray(h(q[i], p[i])).tobytes(), *(x.tobytes() for x in h.gradient(q[i], p[i]))]
        except Exception as error:  # Whatever the functions raise; the run of this row will raise it too.
            found.append(repr(error).encode())
    return b"".join(found)


def _plain(x: Any) -> Any:
    """An option as words and numbers whose text has all of their digits."""
    if isinstance(x, Hamiltonian):
        return x.to_bytes().hex()
    if isinstance(x, Change):
        return x.name
    if isinstance(x, np.ndarray):
        return x.shape, x.tobytes().hex()
    if isinstance(x, dict):
        return sorted((name, _plain(y)) for name, y in x.items())
    if isinstance(x, (list, tuple)):
        return [_plain(y) for y in x]
    return x
