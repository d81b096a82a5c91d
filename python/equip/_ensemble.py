"""`ensemble`: many runs of one system over threads."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._hamiltonian import Function, Hamiltonian
from ._methods import Equip, Method
from ._numbers import Floats, Shape, pairs
from ._solve import interval_of, options


@dataclass(frozen=True)
class Ensemble:
    """The ends of many runs, a row for each start, in their order. Rows of runs that failed are NaN."""

    #: Times reached, (N,).
    t: Floats
    #: Positions and momenta at the ends, (N, *shape).
    q: Floats
    p: Floats
    #: Largest |H - H(start)| of each run, (N,).
    energy_defect: Floats
    #: Whether every step of the run kept the energy to round-off, (N,).
    energy_kept: NDArray[np.bool_]
    #: Steps of each run, (N,).
    steps: NDArray[np.int64]
    #: What went wrong, and what to change, by the number of the run.
    errors: dict[int, str]

    @property
    def success(self) -> bool:
        """Whether no run failed."""
        return not self.errors


def _starts(x: Any, shape: Shape, name: str) -> Floats:
    high, _ = pairs(x, name)
    if high.shape[1:] != shape or high.ndim != len(shape) + 1:
        raise ValueError(f"{name} has shape {high.shape}; it must be (N, {', '.join(map(str, shape))})")
    return high


def ensemble(
    h: Hamiltonian,
    q0: Any,
    p0: Any,
    span: tuple[float, float],
    *,
    method: Method = Equip(stages=8),
    step: Optional[float] = None,
    tolerance: Optional[float] = None,
    keep: Optional[Mapping[str, Function]] = None,
    measure_energy: bool = True,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    max_steps: Optional[int] = None,
    atol: Any = None,
    threads: Optional[int] = None,
    progress: bool = False,
) -> Ensemble:
    """Integrates from N starts over the same span. Parameters are those of `equip.solve`.

    Every bit is that of a run of its own, whatever the number of threads. Python runs meanwhile, and Ctrl-C
    ends all runs within a tenth of a second or a step.

    Parameters
    ----------
    q0, p0
        Positions and momenta at the starts, (N, *h.shape).
    threads
        Threads of the machine; all by default.

    Raises
    ------
    ValueError
        For options that cannot be used. A start that cannot be used is in `Ensemble.errors`, as is a run
        that failed.

    Examples
    --------
    >>> pendulum = Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]), shape=1)
    >>> ends = ensemble(pendulum, np.linspace(0, 3, 100)[:, None], np.zeros((100, 1)), (0, 10), step=0.2)
    >>> ends.q.shape, ends.success
    ((100, 1), True)
    """
    given = options(
        h,
        method,
        step,
        tolerance,
        first_step=first_step,
        min_step=min_step,
        max_step=max_step,
        max_steps=max_steps,
        atol=atol,
        keep=keep,
        measure_energy=measure_energy,
    )
    given["record"] = 0
    q, p = _starts(q0, h.shape, "q0"), _starts(p0, h.shape, "p0")
    if q.shape != p.shape:
        raise ValueError(f"q0 has {len(q)} starts, but p0 has {len(p)}")
    workers = (os.cpu_count() or 1) if threads is None else int(threads)
    if workers < 1:
        raise ValueError(f"threads is {threads}; it must be 1 or more")
    start, end = interval_of(span)
    times = (start[0], end[0])
    if step is not None and (end[0] - start[0]) * step < 0:
        raise ValueError(
            f"steps of {step} lead from {start[0]} away from {end[0]}; give a step without a sign"
        )
    flat = (q.ravel().tolist(), p.ravel().tolist())
    if progress:
        from tqdm.auto import tqdm

        with tqdm(total=len(q), unit="run") as bar:

            def show(done: int) -> None:
                bar.update(done - bar.n)

            found = _native.ensemble(h._recorded, *flat, times, given, workers, show)
            show(len(q))
    else:
        found = _native.ensemble(h._recorded, *flat, times, given, workers, None)
    ends = found["y"].reshape(len(q), 2, *h.shape)
    return Ensemble(
        t=found["t"],
        q=ends[:, 0],
        p=ends[:, 1],
        energy_defect=found["energy_defect"],
        energy_kept=found["kept"],
        steps=found["steps"],
        errors=found["errors"],
    )
