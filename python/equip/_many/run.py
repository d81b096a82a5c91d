"""`ensemble`: many runs of one system, over threads, or over processes and machines by an executor."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, Optional, Protocol, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._hamiltonian import Function, Hamiltonian, of_recording
from ._methods import Equip, Method, Reversible
from ._numbers import Floats, Shape, pairs
from ._solution import Solution
from ._solve import interval_of, options, solution


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
    #: Largest Lyapunov exponent, per unit of time, and MEGNO, (N,) each; NaN without `chaos=True`.
    lyapunov: Floats
    megno: Floats
    #: What went wrong, and what to change, by the number of the run.
    errors: dict[int, str]
    #: Numbers of the runs that an executor lost, (k,): `ensemble(..., resume=this)` makes them.
    lost: NDArray[np.int64]
    #: What `output` made of each run, by its number; None where it failed. Empty without `output`.
    outputs: tuple[Any, ...] = ()

    @property
    def outcome(self) -> NDArray[np.str_]:
        """How each run ended, (N,): "kept" with the energy kept on every step, "finished" without, "failed",
        or "lost" with its worker."""
        ends = np.where(self.energy_kept, "kept", np.where(np.isnan(self.t), "failed", "finished"))
        ends[self.lost] = "lost"
        return ends

    @property
    def success(self) -> bool:
        """Whether no run failed."""
        return not self.errors


def draw_starts(q0: Any, p0: Any, n: int, *, seed: int = 0, spread: float = 0.01) -> tuple[Floats, Floats]:
    """Starts of `n` members around (q0, p0): positions and momenta, (n, *shape) each.

    Every component x becomes x (1 + spread u), with u uniform in [-1, 1) and its own for each component;
    components that are zero stay so. Member number i depends on `seed` and i alone, so that the first n
    members of more are the same. The program's `equip ensemble` draws the same ones.

    Parameters
    ----------
    q0, p0
        One start, each of the shape of the Hamiltonian.
    seed
        A whole number from 0 to 2^64 - 1.
    spread
        How far a component is moved at most, in units of itself.

    Examples
    --------
    >>> q, p = draw_starts([1.0, 0.0], [0.0, 2.0], 100, seed=7)
    >>> q.shape, bool(abs(q[:, 0] - 1).max() <= 0.01), bool((q[:, 1] == 0).all())
    ((100, 2), True, True)
    """
    (q, _), (p, _) = pairs(q0, "q0"), pairs(p0, "p0")
    if q.shape != p.shape:
        raise ValueError(f"q0 has shape {q.shape}, but p0 has {p.shape}")
    if n != int(n) or n < 1:
        raise ValueError(f"n is {n}; it must be a whole number, 1 or more")
    if seed != int(seed) or not 0 <= seed < 2**64:
        raise ValueError(f"seed is {seed}; it must be a whole number from 0 to 2^64 - 1")
    if not 0 <= spread < np.inf:
        raise ValueError(f"spread is {spread}; it must be finite and not negative")
    flat = (q.ravel().tolist(), p.ravel().tolist())
    drawn = _native.draw_starts(*flat, int(n), int(seed), float(spread))
    return drawn[0].reshape(-1, *q.shape), drawn[1].reshape(-1, *q.shape)


class Executor(Protocol):
    """Of concurrent.futures, mpi4py.futures, Dask (`client.get_executor()`) and others."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Any:
        """A future of fn(*args), with `result()` and `cancel()`."""


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
    n: Optional[int] = None,
    seed: Optional[int] = None,
    spread: float = 0.01,
    output: Optional[Callable[[Solution], Any]] = None,
    method: Method = Equip(stages=8),
    step: Union[None, float, Reversible] = None,
    tolerance: Optional[float] = None,
    keep: Optional[Mapping[str, Function]] = None,
    measure_energy: bool = True,
    chaos: bool = False,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    max_steps: Optional[int] = None,
    atol: Any = None,
    threads: Optional[int] = None,
    executor: Optional[Executor] = None,
    chunk: int = 256,
    resume: Optional[Ensemble] = None,
    progress: bool = False,
) -> Ensemble:
    """Integrates from N starts over the same span. Parameters are those of `equip.solve`.

    Every bit is that of a run of its own, whatever the number of threads, processes and machines. Python runs
    meanwhile, and Ctrl-C ends all runs of this process within a tenth of a second or a step.

    Parameters
    ----------
    q0, p0
        Positions and momenta at the starts, (N, *h.shape); with `n`, of one start, h.shape.
    n, seed, spread
        Draws n starts around one, by `equip.draw_starts`: each from the seed and its own number alone,
        whatever threads, chunks and executors.
    output
        A function of each run that succeeds, as a `Solution` with all its steps; `Ensemble.outputs` has what
        it returns. It is called in threads, and travels with the chunks to an executor; each run is then
        made ready anew, and Ctrl-C waits for those that are under way.
    threads
        Threads of the machine; all by default, with an executor one for each chunk.
    executor
        Makes the runs elsewhere, `chunk` starts at a time: an executor of `concurrent.futures` with
        processes, `mpi4py.futures.MPIPoolExecutor`, Dask's `client.get_executor()`. H travels as its
        recording, so that it may be a lambda. If a worker dies, the runs that were not finished are `lost`,
        and all others are kept.
    resume
        An ensemble of the same starts: its rows are taken, and only its `lost` runs are made.

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
        chaos=chaos,
    )
    given["record"] = 0
    if n is not None:
        q0, p0 = draw_starts(q0, p0, n, seed=seed or 0, spread=spread)
    elif seed is not None:
        raise ValueError("seed draws starts around one: give their number n as well")
    q, p = _starts(q0, h.shape, "q0"), _starts(p0, h.shape, "p0")
    if q.shape != p.shape:
        raise ValueError(f"q0 has {len(q)} starts, but p0 has {len(p)}")
    workers = (os.cpu_count() or 1) if threads is None else int(threads)
    if workers < 1:
        raise ValueError(f"threads is {threads}; it must be 1 or more")
    start, end = interval_of(span)
    times = (start[0], end[0])
    if isinstance(step, (int, float)) and (end[0] - start[0]) * step < 0:
        raise ValueError(
            f"steps of {step} lead from {start[0]} away from {end[0]}; give a step without a sign"
        )
    if chunk < 1:
        raise ValueError(f"chunk is {chunk}; it must be 1 or more")
    if resume is not None and resume.q.shape != q.shape:
        raise ValueError(f"resume has {len(resume.q)} starts, but q0 has {len(q)}; give those it was made of")
    which = np.arange(len(q)) if resume is None else resume.lost
    q, p = q[which], p[which]
    with _bar(len(q), progress) as show:
        if executor is None:
            made, lost = _rows(h, q, p, times, given, workers, output, show), np.empty(0, dtype=np.int64)
        else:
            # Faults of the options are found here.
            _native.ensemble(h._recorded, [], [], times, given, 1, None)
            quantities = {name: of_recording(f, h.shape) for name, f in given["keep"]}
            if (sizes := given["reversible"]) is not None and sizes[1] is not None:
                given["reversible"] = (sizes[0], of_recording(sizes[1], h.shape), sizes[2])
            task = _Task(h, times, {**given, "keep": quantities}, threads or 1, output)
            made, lost = _elsewhere(executor, task, (q, p), chunk, show)
        if show is not None:
            show(len(q))
    if resume is None:
        return replace(made, lost=lost)
    return _filled(resume, made, which, lost)


def _row_of(sol: Solution) -> Ensemble:
    """The end of a run as the row of an ensemble."""
    certificate = sol.certificate
    energy, chaos = certificate.energy, (certificate.lyapunov, certificate.megno)
    lyapunov, megno = (np.array([np.nan if x is None else x]) for x in chaos)
    return Ensemble(
        t=sol.t[-1:],
        q=sol.q[-1:],
        p=sol.p[-1:],
        energy_defect=np.array([np.nan if energy is None else energy.max]),
        energy_kept=np.array([certificate.energy_kept_on_every_step]),
        steps=np.array([certificate.counts.steps]),
        lyapunov=lyapunov,
        megno=megno,
        errors={},
        lost=np.empty(0, dtype=np.int64),
    )


@contextmanager
def _bar(total: int, progress: bool) -> Iterator[Optional[Callable[[int], None]]]:
    if not progress:
        yield None
        return
    from tqdm.auto import tqdm

    with tqdm(total=total, unit="run") as bar:
        yield lambda done: bar.update(done - bar.n)


@dataclass(frozen=True)
class _Task:
    """What all chunks have in common, ready to be pickled."""

    h: Hamiltonian
    times: tuple[float, float]
    given: dict[str, Any]
    threads: int
    output: Optional[Callable[[Solution], Any]]


def _chunk(task: _Task, q: Floats, p: Floats) -> Ensemble:
    """The rows of these starts: a function of its arguments alone."""
    keep = [(name, quantity._recorded) for name, quantity in task.given["keep"].items()]
    given = {**task.given, "keep": keep}
    reversible = given["reversible"]
    if reversible is not None and reversible[1] is not None:
        given["reversible"] = (reversible[0], reversible[1]._recorded, reversible[2])
    return _rows(task.h, q, p, task.times, given, task.threads, task.output, None)


def _rows(
    h: Hamiltonian,
    q: Floats,
    p: Floats,
    times: tuple[float, float],
    given: dict[str, Any],
    threads: int,
    output: Optional[Callable[[Solution], Any]],
    show: Optional[Callable[[int], None]],
) -> Ensemble:
    """The rows of these starts, made in this process."""
    flat = (q.ravel().tolist(), p.ravel().tolist())
    if output is None:
        return _ensemble(_native.ensemble(h._recorded, *flat, times, given, threads, show), h.shape)
    _native.ensemble(h._recorded, [], [], times, given, 1, None)

    def one(i: int) -> tuple[Ensemble, Any]:
        zeros = [0.0] * h.degrees_of_freedom
        start = (q[i].ravel().tolist(), zeros), (p[i].ravel().tolist(), zeros)
        whole = {**given, "record": 1}
        interval = (*start, (times[0], 0.0), (times[1], 0.0))
        try:
            found = _native.solve(h._recorded, interval, whole, "f64", None)
        except (ValueError, _native.IntegrationError) as error:
            return _missing(1, h.shape, str(error)), None
        if found["fault"] is not None:
            return _missing(1, h.shape, found["fault"]), None
        sol = solution(h, found, whole, False)
        return _row_of(sol), output(sol)

    pool = ThreadPoolExecutor(threads)
    try:
        made = []
        for row in pool.map(one, range(len(q))):
            made.append(row)
            if show is not None:
                show(len(made))
    finally:
        pool.shutdown(cancel_futures=True)
    rows = _joined([row for row, _ in made], h.shape)
    return replace(rows, outputs=tuple(result for _, result in made))


def _ensemble(found: dict[str, Any], shape: Shape) -> Ensemble:
    ends = found["y"].reshape(-1, 2, *shape)
    return Ensemble(
        t=found["t"],
        q=ends[:, 0],
        p=ends[:, 1],
        energy_defect=found["energy_defect"],
        energy_kept=found["kept"],
        steps=found["steps"],
        lyapunov=found["lyapunov"],
        megno=found["megno"],
        errors=found["errors"],
        lost=np.empty(0, dtype=np.int64),
    )


def _elsewhere(
    executor: Executor,
    task: _Task,
    starts: tuple[Floats, Floats],
    chunk: int,
    show: Optional[Callable[[int], None]],
) -> tuple[Ensemble, NDArray[np.int64]]:
    """All chunks, one after the other, and the numbers of those that were lost."""
    q, p = starts
    futures: list[Any] = []
    parts: list[Ensemble] = []
    lost: list[int] = []
    try:
        for at in range(0, len(q), chunk):
            try:
                futures.append(executor.submit(_chunk, task, q[at : at + chunk], p[at : at + chunk]))
            except Exception as error:  # A pool that is broken already refuses more.
                futures.append(error)
        for number, future in enumerate(futures):
            rows = range(number * chunk, min(number * chunk + chunk, len(q)))
            try:
                if isinstance(future, Exception):
                    raise future
                parts.append(future.result())
            except Exception as error:
                message = (
                    f"the worker of this run ended early ({type(error).__name__}: {error}); call ensemble "
                    "again with resume= to make it"
                )
                nothing = () if task.output is None else (None,) * len(rows)
                parts.append(replace(_missing(len(rows), task.h.shape, message), outputs=nothing))
                lost.extend(rows)
            if show is not None:
                show(rows.stop)
    except BaseException:
        for future in futures:
            if not isinstance(future, Exception):
                future.cancel()
        raise
    return _joined(parts, task.h.shape), np.array(lost, dtype=np.int64)


def _missing(n: int, shape: Shape, message: str) -> Ensemble:
    """Rows that were not made."""
    states = np.full((2, n, *shape), np.nan)
    none = np.full(n, np.nan)
    return Ensemble(
        t=none,
        q=states[0],
        p=states[1],
        energy_defect=none,
        energy_kept=np.zeros(n, dtype=bool),
        steps=np.zeros(n, dtype=np.int64),
        lyapunov=none,
        megno=none,
        errors={i: message for i in range(n)},
        lost=np.empty(0, dtype=np.int64),
    )


def _joined(parts: Sequence[Ensemble], shape: Shape) -> Ensemble:
    parts = parts or [_missing(0, shape, "")]
    starts = np.cumsum([0] + [len(part.t) for part in parts])
    errors = {int(at) + i: text for at, part in zip(starts, parts) for i, text in part.errors.items()}
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS
    }
    outputs = tuple(output for part in parts for output in part.outputs)
    return Ensemble(**arrays, errors=errors, lost=np.empty(0, dtype=np.int64), outputs=outputs)


def _filled(before: Ensemble, made: Ensemble, which: NDArray[np.int64], lost: NDArray[np.int64]) -> Ensemble:
    """The rows of `before`, those of `which` from `made`."""
    arrays = {name: getattr(before, name).copy() for name in _ARRAYS}
    for name, array in arrays.items():
        array[which] = getattr(made, name)
    errors = {i: text for i, text in before.errors.items() if i not in set(which.tolist())}
    errors |= {int(which[i]): text for i, text in made.errors.items()}
    outputs = list(before.outputs)
    for i, output in zip(which.tolist(), made.outputs):
        outputs[i : i + 1] = [output]
    return Ensemble(**arrays, errors=errors, lost=which[lost], outputs=tuple(outputs))


_ARRAYS = ("t", "q", "p", "energy_defect", "energy_kept", "steps", "lyapunov", "megno")
